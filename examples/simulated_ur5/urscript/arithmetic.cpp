// Functions of numbers, lists and bits.
#include <cmath>

#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

template <double (*F)(double)>
Outcome of_number(Call& c) {
  const auto x = c[0].number();
  return x ? c.give(F(*x)) : c.fail("runtime_error_type:number");
}
template <double (*F)(double)>
Outcome to_whole(Call& c) {
  const auto x = c[0].number();
  if (!x || !(std::abs(*x) < 9e15)) return c.fail("runtime_error_type:number");
  return c.give(static_cast<std::int64_t>(F(*x)));
}
template <double (*F)(double, double)>
Outcome of_two(Call& c) {
  const auto x = c[0].number(), y = c[1].number();
  return x && y ? c.give(F(*x, *y)) : c.fail("runtime_error_type:number");
}

double to_radians(double d) {
  return d * pi / 180;
}
double to_degrees(double r) {
  return r * 180 / pi;
}

Outcome norm_of(Call& c) {
  if (const auto x = c[0].number()) return c.give(std::abs(*x));
  const auto list = c[0].numbers();
  if (!list) return c.fail("runtime_error_type:norm");
  double sum = 0;
  for (const double x : *list) sum += x * x;
  return c.give(std::sqrt(sum));
}

Outcome length(Call& c) {
  if (const auto* s = c[0].as<std::string>()) return c.give(static_cast<std::int64_t>(s->size()));
  if (c[0].as<Pose6>()) return c.give(6);
  const auto* list = c[0].as<List>();
  return list ? c.give(static_cast<std::int64_t>(list->items.size())) : c.fail("runtime_error_type:list");
}

Outcome make_list(Call& c) {
  const double n = c.number(0, 0);
  if (!(n >= 0 && n <= 1000)) return c.fail("runtime_error_list_too_large");
  auto list = list_of(std::vector<Value>(static_cast<std::size_t>(n), c[1]));
  return list ? c.give(std::move(*list)) : c.fail("runtime_error_list_too_large");
}

Outcome integer_to_bits(Call& c) {
  const auto word = static_cast<std::uint32_t>(static_cast<std::int64_t>(c.number(0, 0)));
  std::vector<Value> bits;
  for (int i = 0; i < 32; ++i) bits.emplace_back((word >> i & 1u) != 0);
  return c.give(*list_of(std::move(bits)));
}
Outcome bits_to_integer(Call& c) {
  const auto* bits = c[0].as<List>();
  if (!bits) return c.fail("runtime_error_type:list");
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(32, bits->items.size()); ++i)
    word |= std::uint32_t{bits->items[i].truth()} << i;
  return c.give(static_cast<std::int64_t>(static_cast<std::int32_t>(word)));
}

constexpr Builtin arithmetic_table[] = {
    {"sqrt", "f", of_number<std::sqrt>},
    {"sin", "f", of_number<std::sin>},
    {"cos", "f", of_number<std::cos>},
    {"tan", "f", of_number<std::tan>},
    {"asin", "f", of_number<std::asin>},
    {"acos", "f", of_number<std::acos>},
    {"atan", "f", of_number<std::atan>},
    {"atan2", "x y", of_two<std::atan2>},
    {"pow", "base exponent", of_two<std::pow>},
    {"log", "b f", [](Call& c) { return c.give(std::log(c.number(1, 1)) / std::log(c.number(0, 10))); }},
    {"floor", "f", to_whole<std::floor>},
    {"ceil", "f", to_whole<std::ceil>},
    {"round", "f", to_whole<std::round>},
    {"d2r", "d", of_number<to_radians>},
    {"r2d", "r", of_number<to_degrees>},
    {"norm", "a", norm_of},
    {"length", "v", length},
    {"size", "v", length},
    {"get_list_length", "v", length},
    {"make_list", "length initial_value capacity", make_list},
    {"integer_to_binary_list", "x", integer_to_bits},
    {"binary_list_to_integer", "l", bits_to_integer},
};

}  // namespace

std::span<const Builtin> arithmetic_functions() {
  return arithmetic_table;
}

}  // namespace simulated_ur5::urscript
