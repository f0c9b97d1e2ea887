// How far apart two results may be: `CHECK(difference(a, b) <= allowed<T>(magnitude))`.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "skinctl/core/real.hpp"

namespace skinctl::testing {

/// `operations` rounding errors of `T` at numbers of `magnitude`: the largest number that enters the
/// computation, not its result, which may have cancelled. At magnitude 0 only the smallest normal number is
/// allowed.
template <Real T>
[[nodiscard]] T allowed(const T& magnitude, int operations = 64) {
  using std::abs;
  const T size = abs(magnitude);
  const T error = T(operations) * std::numeric_limits<T>::epsilon() * size;
  return std::max(error, std::numeric_limits<T>::min());
}

/// The largest difference of any component; infinite as soon as one is not a number, so that no check lets it
/// pass.
template <Real T>
[[nodiscard]] T difference(const T& a, const T& b) {
  using std::abs;
  if (a == b) return T(0);
  const T distance = abs(T(a - b));
  return distance == distance ? distance : std::numeric_limits<T>::infinity();
}

namespace detail {
template <Real T>
T larger(const T& a, const T& b) {
  return a < b ? b : a;
}
}  // namespace detail

/// Arrays and joint vectors of equal length.
template <class V>
  requires(!Real<V> && requires(const V& v) { std::begin(v) == std::end(v); })
[[nodiscard]] auto difference(const V& a, const V& b) {
  auto largest = difference(*std::begin(a), *std::begin(b));
  auto other = std::begin(b);
  for (const auto& value : a) largest = detail::larger(largest, difference(value, *other++));
  return largest;
}

/// Triples.
template <class V>
  requires requires(const V& v) {
    requires Real<decltype(V::x)> && Real<decltype(V::y)> && Real<decltype(V::z)>;
  }
[[nodiscard]] auto difference(const V& a, const V& b) {
  return detail::larger(difference(a.x, b.x), detail::larger(difference(a.y, b.y), difference(a.z, b.z)));
}

/// Eigen's matrices of equal size, not empty.
template <class A, class B>
  requires requires(const A& a, const B& b) { a.coeff(0, 0), a.rows(), a.cols(), b.coeff(0, 0); }
[[nodiscard]] typename A::Scalar difference(const A& a, const B& b) {
  typename A::Scalar largest(0);
  for (decltype(a.rows()) i = 0; i < a.rows(); ++i)
    for (decltype(a.cols()) j = 0; j < a.cols(); ++j)
      largest = detail::larger(largest, difference<typename A::Scalar>(a.coeff(i, j), b.coeff(i, j)));
  return largest;
}

}  // namespace skinctl::testing
