// Errors of a result against 50 digits, in units in the last place.
#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>

namespace skinctl::testing {

using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

/// The distance of the numbers of type `T` around `exact`.
template <class T>
[[nodiscard]] T unit_in_last_place(const Exact& exact) {
  int exponent = 0;
  std::frexp(static_cast<T>(exact), &exponent);
  const int lowest = std::numeric_limits<T>::min_exponent - std::numeric_limits<T>::digits;
  return std::ldexp(T(1), std::max(exponent - std::numeric_limits<T>::digits, lowest));
}

/// |got - exact| in units in the last place, after `free` was subtracted; infinite if `got` is not a number.
template <class T>
[[nodiscard]] double error_in_ulp(T got, const Exact& exact, double free = 0) {
  if (!(got - got == T(0))) return std::numeric_limits<double>::infinity();
  const Exact error = std::max(Exact(0), Exact(abs(Exact(got) - exact) - Exact(free)));
  return static_cast<double>(error / Exact(unit_in_last_place<T>(exact)));
}

/// |got - exact|; infinite if `got` is not a number.
template <class T>
[[nodiscard]] double absolute_error(T got, const Exact& exact) {
  if (!(got - got == T(0))) return std::numeric_limits<double>::infinity();
  return static_cast<double>(abs(Exact(got) - exact));
}

}  // namespace skinctl::testing
