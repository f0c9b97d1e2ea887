// What the tests of trajectories and laws share: 50 digits, seeded numbers, printing as code.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <limits>
#include <random>

namespace skinctl::testing {

using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

/// Numbers between -1 and 1, the same in every run.
class Seeded {
 public:
  explicit Seeded(unsigned seed) : bits_(seed) {}
  double operator()() { return static_cast<double>(bits_()) / 2147483648.0 - 1.0; }
  /// Between `low` and `high`.
  double between(double low, double high) { return low + 0.5 * (1 + (*this)()) * (high - low); }
  /// A joint vector with elements up to `size`.
  template <class V>
  V vector(double size) {
    V v;
    for (auto& x : v) x = static_cast<typename V::scalar>(size * (*this)());
    return v;
  }

 private:
  std::mt19937 bits_;
};

template <class T>
T epsilon() {
  return std::numeric_limits<T>::epsilon();
}
template <class T>
T magnitude(const T& x) {
  return x < T(0) ? T(-x) : x;
}

}  // namespace skinctl::testing
