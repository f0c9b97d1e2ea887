#include "examples/simulated_ur5/urscript/value.hpp"

#include <algorithm>
#include <cmath>

#include "skinctl/io/formatted.hpp"

namespace simulated_ur5::urscript {
namespace {

std::string text_of(double d) {
  if (std::isnan(d)) return "nan";
  if (std::isinf(d)) return d > 0 ? "inf" : "-inf";
  return skinctl::formatted("%.6g", d);
}

template <class Items, class Write>
std::string joined(const char* open, const Items& items, const char* close, Write&& write) {
  std::string out = open;
  for (const auto& item : items) {
    if (out.size() > longest_string) break;
    if (&item != &*items.begin()) out += ", ";
    out += write(item);
  }
  return out + close;
}

double arithmetic(Operation op, double a, double b) {
  switch (op) {
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::divide:
      return a / b;
    default:
      return std::fmod(a, b);
  }
}

/// Whole numbers stay whole but for division, and as long as they fit.
Value whole(Operation op, std::int64_t a, std::int64_t b) {
  constexpr double most = 9007199254740992.0;
  const double exact = arithmetic(op, static_cast<double>(a), static_cast<double>(b));
  if (op == Operation::divide || !(std::abs(exact) < most)) return exact;
  return static_cast<std::int64_t>(exact);
}

}  // namespace

std::optional<double> Value::number() const {
  if (const auto* d = as<double>()) return *d;
  if (const auto* i = as<std::int64_t>()) return static_cast<double>(*i);
  if (const auto* b = as<bool>()) return *b ? 1.0 : 0.0;
  return std::nullopt;
}

std::optional<std::vector<double>> Value::numbers() const {
  if (const auto* p = as<Pose6>()) return std::vector<double>(p->begin(), p->end());
  const auto* list = as<List>();
  if (!list) return std::nullopt;
  std::vector<double> out;
  for (const Value& item : list->items) {
    const auto n = item.number();
    if (!n) return std::nullopt;
    out.push_back(*n);
  }
  return out;
}

std::optional<Pose6> Value::six() const {
  const auto all = numbers();
  if (!all || all->size() != 6) return std::nullopt;
  Pose6 out{};
  std::copy(all->begin(), all->end(), out.begin());
  return out;
}

bool Value::truth() const {
  const auto n = number();
  return n && *n != 0;
}

std::string Value::text() const {
  if (empty()) return "None";
  if (const auto* b = as<bool>()) return *b ? "True" : "False";
  if (const auto* i = as<std::int64_t>()) return std::to_string(*i);
  if (const auto* d = as<double>()) return text_of(*d);
  if (const auto* s = as<std::string>()) return *s;
  if (const auto* p = as<Pose6>()) return joined("p[", *p, "]", text_of);
  if (const auto* t = as<ThreadNumber>()) return std::to_string(t->number);
  if (const auto* l = as<List>()) return joined("[", l->items, "]", [](const Value& v) { return v.text(); });
  return joined("struct(", as<Struct>()->fields, ")",
                [](const auto& field) { return field.first + "=" + field.second.text(); });
}

std::uint32_t Value::weight() const {
  if (const auto* s = as<std::string>()) return 1 + static_cast<std::uint32_t>(s->size() / 32);
  if (const auto* l = as<List>()) return l->weight;
  if (const auto* s = as<Struct>()) return s->weight;
  return 1;
}
std::uint32_t Value::depth() const {
  if (const auto* l = as<List>()) return l->depth;
  if (const auto* s = as<Struct>()) return s->depth;
  return 0;
}

bool operator==(const Value& a, const Value& b) {
  if (const auto x = a.number(), y = b.number(); x && y) return *x == *y;
  if (const auto *x = a.as<std::string>(), *y = b.as<std::string>(); x && y) return *x == *y;
  if (const auto *x = a.as<ThreadNumber>(), *y = b.as<ThreadNumber>(); x && y) return *x == *y;
  const auto x = a.numbers(), y = b.numbers();
  return x && y && *x == *y;
}

std::optional<Value> list_of(std::vector<Value> items) {
  List list;
  for (const Value& item : items) {
    list.weight += item.weight();
    list.depth = std::max(list.depth, 1 + item.depth());
    if (list.weight > heaviest_value || list.depth > deepest_value) return std::nullopt;
  }
  list.items = std::move(items);
  return Value(std::move(list));
}

Value list_of(const std::vector<double>& numbers) {
  List list;
  list.items.assign(numbers.begin(), numbers.end());
  list.weight += static_cast<std::uint32_t>(numbers.size());
  return list;
}

std::optional<Value> combine(Operation op, const Value& a, const Value& b) {
  if (op == Operation::equal) return a == b;
  if (op == Operation::unequal) return !(a == b);
  const auto x = a.number(), y = b.number();
  if (op == Operation::less || op == Operation::less_equal) {
    if (!x || !y) return std::nullopt;
    return op == Operation::less ? *x < *y : *x <= *y;
  }
  if (x && y) {
    const auto *i = a.as<std::int64_t>(), *k = b.as<std::int64_t>();
    if ((op == Operation::divide || op == Operation::modulo) && *y == 0) return std::nullopt;
    return i && k ? whole(op, *i, *k) : Value(arithmetic(op, *x, *y));
  }
  // Item by item; a number goes with each.
  const auto left = a.numbers(), right = b.numbers();
  if ((!x && !left) || (!y && !right) || (left && right && left->size() != right->size()))
    return std::nullopt;
  if (op == Operation::modulo || (op == Operation::divide && y && *y == 0)) return std::nullopt;
  if (left && right && (op == Operation::multiply || op == Operation::divide)) return std::nullopt;
  std::vector<double> out(left ? left->size() : right->size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = arithmetic(op, x ? *x : (*left)[i], y ? *y : (*right)[i]);
  const bool pose = a.as<Pose6>() || b.as<Pose6>();
  if (!pose || out.size() != 6) return list_of(out);
  Pose6 p{};
  std::copy(out.begin(), out.end(), p.begin());
  return Value(p);
}

}  // namespace simulated_ur5::urscript
