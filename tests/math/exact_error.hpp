// Errors of a result against 50 digits, in units in the last place.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/digits50.hpp"

namespace skinctl::testing {

/// The distance of the numbers of type `T` around `exact`.
template <class T>
[[nodiscard]] T unit_in_last_place(const Digits50& exact) {
  int exponent = 0;
  std::frexp(static_cast<T>(exact), &exponent);
  const int lowest = std::numeric_limits<T>::min_exponent - std::numeric_limits<T>::digits;
  return std::ldexp(T(1), std::max(exponent - std::numeric_limits<T>::digits, lowest));
}

/// |got - exact| in units in the last place, after `free` was subtracted; infinite if `got` is not a number.
template <class T>
[[nodiscard]] double error_in_ulp(T got, const Digits50& exact, double free = 0) {
  if (!(got - got == T(0))) return std::numeric_limits<double>::infinity();
  const Digits50 error = std::max(Digits50(0), Digits50(abs(Digits50(got) - exact) - Digits50(free)));
  return static_cast<double>(error / Digits50(unit_in_last_place<T>(exact)));
}

/// |got - exact|; infinite if `got` is not a number.
template <class T>
[[nodiscard]] double absolute_error(T got, const Digits50& exact) {
  if (!(got - got == T(0))) return std::numeric_limits<double>::infinity();
  return static_cast<double>(abs(Digits50(got) - exact));
}

}  // namespace skinctl::testing
