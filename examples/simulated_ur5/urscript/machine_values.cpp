// The machine's items and fields, and what is asked of it from outside.
#include <cmath>

#include "examples/simulated_ur5/urscript/machine.hpp"

namespace simulated_ur5::urscript {
namespace {

std::optional<std::size_t> place_in(std::size_t size, const Value& index) {
  const auto i = index.number();
  if (!i || !(*i >= 0) || *i >= static_cast<double>(size) || *i != std::floor(*i)) return std::nullopt;
  return static_cast<std::size_t>(*i);
}

}  // namespace

bool Machine::index(Thread& t) {
  const Value i = take(t), from = take(t);
  if (const auto* p = from.as<Pose6>()) {
    const auto at = place_in(p->size(), i);
    if (at) t.stack.emplace_back((*p)[*at]);
    return at.has_value();
  }
  const auto* list = from.as<List>();
  const auto at = list ? place_in(list->items.size(), i) : std::nullopt;
  if (at) t.stack.push_back(list->items[*at]);
  return at.has_value();
}

bool Machine::store_item(Thread& t, Value& where) {
  const Value v = take(t), i = take(t);
  if (auto* p = where.as<Pose6>()) {
    const auto at = place_in(p->size(), i);
    const auto n = v.number();
    if (at && n) (*p)[*at] = *n;
    return at && n;
  }
  auto* list = where.as<List>();
  const auto at = list ? place_in(list->items.size(), i) : std::nullopt;
  if (!at) return false;
  auto items = list->items;
  items[*at] = v;
  auto changed = list_of(std::move(items));
  if (changed) where = std::move(*changed);
  return changed.has_value();
}

bool Machine::make_struct(Thread& t, const CallSite& site) {
  Struct s;
  const std::size_t first = t.stack.size() - site.names.size();
  for (std::size_t i = 0; i < site.names.size(); ++i) {
    s.weight += t.stack[first + i].weight();
    s.depth = std::max(s.depth, 1 + t.stack[first + i].depth());
    s.fields.emplace_back(site.names[i], std::move(t.stack[first + i]));
  }
  t.stack.resize(first);
  t.stack.emplace_back(Value(s));
  return s.weight <= heaviest_value && s.depth <= deepest_value;
}

bool Machine::store_field(Thread& t, Value& where, const std::string& field) {
  Value v = take(t);
  auto* s = where.as<Struct>();
  if (!s) return false;
  for (auto& [key, value] : s->fields) {
    if (key != field) continue;
    s->weight = s->weight - value.weight() + v.weight();
    s->depth = std::max(s->depth, 1 + v.depth());
    value = std::move(v);
    return s->weight <= heaviest_value && s->depth <= deepest_value;
  }
  return false;
}

std::shared_ptr<Socket> Machine::reads_from(std::size_t count, const Sockets& sockets) const {
  for (const Thread& t : threads_) {
    if (t.done || !t.waits) continue;
    const Instruction& i = code_.instructions[static_cast<std::size_t>(t.at)];
    if (i.op != Op::call) continue;
    const CallSite& site = code_.calls[static_cast<std::size_t>(i.a)];
    if (site.name != "socket_read_binary_integer" || site.names.size() > t.stack.size()) continue;
    const Value* given = t.stack.data() + (t.stack.size() - site.names.size());
    std::string name = "socket_0";
    double wanted = 0;
    for (std::size_t k = 0; k < site.names.size(); ++k) {
      if (site.target[k] == 0) wanted = given[k].number().value_or(0);
      if (site.target[k] == 1)
        if (const auto* text = given[k].as<std::string>()) name = *text;
    }
    const auto socket = sockets.find(name);
    if (socket && !socket->peer_gone && wanted == static_cast<double>(count)) return socket;
  }
  return nullptr;
}

std::string Machine::variable(std::string_view name) const {
  for (std::size_t i = 0; i < code_.globals.size(); ++i)
    if (code_.globals[i] == name) return globals_[i].text();
  return {};
}

}  // namespace simulated_ur5::urscript
