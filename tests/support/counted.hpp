// A number that counts what is done with it.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

namespace skinctl::testing {

/// A double whose every operation counts: what an algorithm costs, whatever compiler and machine.
struct Counted {
  static inline std::size_t operations = 0;
  double value = 0;

  constexpr Counted() = default;
  constexpr explicit(false) Counted(double x) : value(x) {}
  constexpr explicit operator double() const { return value; }
  constexpr explicit operator float() const { return static_cast<float>(value); }

  friend Counted operator+(Counted a, Counted b) { return ++operations, a.value + b.value; }
  friend Counted operator-(Counted a, Counted b) { return ++operations, a.value - b.value; }
  friend Counted operator*(Counted a, Counted b) { return ++operations, a.value * b.value; }
  friend Counted operator/(Counted a, Counted b) { return ++operations, a.value / b.value; }
  friend Counted operator-(Counted a) { return ++operations, -a.value; }
  friend bool operator==(Counted a, Counted b) { return a.value == b.value; }
  friend auto operator<=>(Counted a, Counted b) { return a.value <=> b.value; }
  friend Counted sin(Counted a) { return ++operations, std::sin(a.value); }
  friend Counted cos(Counted a) { return ++operations, std::cos(a.value); }
  friend Counted sqrt(Counted a) { return ++operations, std::sqrt(a.value); }
};

}  // namespace skinctl::testing

template <>
class std::numeric_limits<skinctl::testing::Counted> : public std::numeric_limits<double> {};
