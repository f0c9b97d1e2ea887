// SPDX-License-Identifier: BSD-3-Clause
// Seeded random numbers, and the extreme arguments for tests of laws; a failing case prints itself as code.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "skinctl/core/eigen_expression.hpp"
#include "skinctl/core/real.hpp"
#include "skinctl/core/triple.hpp"

namespace skinctl::testing {

/// A random generator with the same sequence on every machine.
using Random = std::mt19937_64;
[[nodiscard]] inline Random seeded(std::uint64_t seed) {
  return Random(seed);
}

/// Random numbers between -1 and 1, from 32 random bits: short to write where the distribution does not
/// matter.
class Seeded {
 public:
  explicit Seeded(unsigned seed) : bits_(seed) {}
  double operator()() { return static_cast<double>(bits_()) / 2147483648.0 - 1.0; }
  /// A random number between `low` and `high`.
  double between(double low, double high) { return low + 0.5 * (1 + (*this)()) * (high - low); }
  /// A joint vector with random elements between -`size` and `size`.
  template <class V>
  V vector(double size) {
    V v;
    for (auto& x : v) x = static_cast<typename V::scalar>(size * (*this)());
    return v;
  }

 private:
  std::mt19937 bits_;
};

/// A random number between `low` and `high`, with every digit of `T` random; std's distributions differ
/// between libraries.
template <Real T>
[[nodiscard]] T uniform(Random& random, const T& low, const T& high) {
  T unit(0);
  T weight(1);
  for (int digits = 0; digits < std::numeric_limits<T>::digits; digits += 53) {
    weight = weight * T(0x1p-53);
    unit = unit + weight * T(random() >> 11);
  }
  return low + (high - low) * unit;
}

/// A random number between -1 and 1, with every digit of `T` random.
template <Real T>
[[nodiscard]] T uniform(Random& random) {
  std::uniform_real_distribution<double> draw(-1.0, 1.0);
  T value(0);
  T weight(1);
  for (int digits = 0; digits < std::numeric_limits<T>::digits; digits += 50) {
    value = value + weight * T(draw(random));
    weight = weight * T(0x1p-50);
  }
  return value;
}

template <Real T>
[[nodiscard]] T epsilon() {
  return std::numeric_limits<T>::epsilon();
}

template <Real T>
[[nodiscard]] T magnitude(const T& x) {
  return x < T(0) ? T(-x) : x;
}

/// pi to the digits of `T`.
template <Real T>
[[nodiscard]] T pi() {
  using std::acos;
  return acos(T(-1));
}

/// Extreme arguments: 0, 1e-8, 1, 1e6 and pi.
template <Real T>
[[nodiscard]] std::array<T, 5> extremes() {
  return {T(0), T(1) / T(100000000), T(1), T(1000000), pi<T>()};
}

/// A random number, mostly between -reach and reach; one in four is an extreme of either sign, whatever the
/// reach.
template <Real T>
[[nodiscard]] T random_or_extreme(Random& random, const T& reach) {
  const auto choice = random();
  if (choice % 4 != 0) return uniform(random, T(-reach), reach);
  const T value = extremes<T>()[(choice / 4) % 5];
  return (choice / 32) % 2 == 0 ? value : T(-value);
}

template <std::size_t N, Real T>
[[nodiscard]] std::array<T, N> random_array(Random& random, const T& reach) {
  std::array<T, N> values{};
  for (auto& value : values) value = uniform(random, T(-reach), reach);
  return values;
}

/// `value` as C++ source, to the last digit: paste it into a test.
template <Real T>
[[nodiscard]] std::string as_code(const T& value) {
  const std::string type = std::same_as<T, float> ? "float" : std::same_as<T, double> ? "double" : "Digits50";
  if (!(value == value)) return "std::numeric_limits<" + type + ">::quiet_NaN()";
  if (value > std::numeric_limits<T>::max()) return "std::numeric_limits<" + type + ">::infinity()";
  if (value < std::numeric_limits<T>::lowest()) return "-std::numeric_limits<" + type + ">::infinity()";
  std::ostringstream text;
  text.precision(std::numeric_limits<T>::max_digits10);
  text << value;
  std::string digits = text.str();
  if constexpr (!std::floating_point<T>) return type + "(\"" + digits + "\")";
  if (digits.find_first_of(".e") == std::string::npos) digits += ".0";
  return std::same_as<T, float> ? digits + "f" : digits;
}

/// Arrays and joint vectors as C++ source: `{1.0, 2.0}`.
template <class V>
  requires(!Real<V> && requires(const V& v) { std::begin(v) == std::end(v); })
[[nodiscard]] std::string as_code(const V& values) {
  std::string text = "{";
  for (const auto& value : values) text += (text.size() > 1 ? ", " : "") + as_code(value);
  return text + "}";
}

/// Triples as C++ source: `{1.0, 2.0, 3.0}`.
template <class T>
[[nodiscard]] std::string as_code(const Xyz<T>& v) {
  return "{" + as_code(v.x) + ", " + as_code(v.y) + ", " + as_code(v.z) + "}";
}

/// Eigen's matrices as C++ source, row by row: `{{1.0, 2.0}, {3.0, 4.0}}`, which their constructors take.
template <EigenExpression M>
[[nodiscard]] std::string as_code(const M& matrix) {
  std::string text = "{";
  for (decltype(matrix.rows()) i = 0; i < matrix.rows(); ++i) {
    text += i == 0 ? "{" : ", {";
    for (decltype(matrix.cols()) j = 0; j < matrix.cols(); ++j)
      text += (j == 0 ? "" : ", ") + as_code(matrix.coeff(i, j));
    text += "}";
  }
  return text + "}";
}

}  // namespace skinctl::testing
