// Matrices that small solvers are tried on.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "skinctl/testing/random.hpp"
#include "tests/math/exact_error.hpp"

namespace skinctl::testing {

template <class T>
inline constexpr T nan_of = std::numeric_limits<T>::quiet_NaN();
template <class T>
inline constexpr T infinity_of = std::numeric_limits<T>::infinity();

/// `A A' + shift 1` with elements of `A` within +-1, its rows and columns scaled by up to `spread` either
/// way.
template <std::size_t N, class T>
void fill_definite(Random& random, double shift, double spread, T (&m)[N * N]) {
  double a[N][N], scale[N];
  for (auto& row : a)
    for (double& x : row) x = uniform(random, -1.0, 1.0);
  for (double& s : scale) s = std::exp2(std::round(uniform(random, -1.0, 1.0) * std::log2(spread)));
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = i == j ? shift : 0;
      for (std::size_t k = 0; k < N; ++k) sum += a[i][k] * a[j][k];
      m[i * N + j] = m[j * N + i] = static_cast<T>(sum * scale[i] * scale[j]);
    }
}

/// `1 / (i + j + 1)`: the condition grows as e^(3.5 N).
template <std::size_t N, class T>
void fill_hilbert(T (&m)[N * N]) {
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) m[i * N + j] = T(1) / T(static_cast<double>(i + j + 1));
}

template <class T>
[[nodiscard]] double size_of(const T& x) {
  return std::abs(static_cast<double>(x));
}

/// `max_i |a x - b|_i / (sum_j |a_ij x_j| + |b_i|)` in 50 digits, over epsilon: how far the equations are
/// from those that `x` solves, row by row.
template <std::size_t N, class T>
[[nodiscard]] double backward_error(const T (&a)[N * N], const T (&x)[N], const T (&b)[N]) {
  double worst = 0;
  for (std::size_t i = 0; i < N; ++i) {
    Digits50 rest = -Digits50(b[i]), size = abs(Digits50(b[i]));
    for (std::size_t j = 0; j < N; ++j) {
      const Digits50 term = Digits50(a[i * N + j]) * Digits50(x[j]);
      rest += term;
      size += abs(term);
    }
    if (!(size == size) || !(rest == rest)) return std::numeric_limits<double>::infinity();
    if (size > 0) worst = std::max(worst, static_cast<double>(Digits50(abs(rest) / size)));
  }
  return worst / static_cast<double>(std::numeric_limits<T>::epsilon());
}

/// The same over the whole right side: `max|a x - b| / (max_i sum_j |a_ij| * max|x|)`, over epsilon. What
/// pivoting by size promises, also where the rows differ by orders of magnitude.
template <std::size_t N, class T>
[[nodiscard]] double backward_error_by_norm(const T (&a)[N * N], const T (&x)[N], const T (&b)[N]) {
  Digits50 worst = 0, size = 0, reach = 0;
  for (std::size_t i = 0; i < N; ++i) {
    Digits50 rest = -Digits50(b[i]), row = 0;
    for (std::size_t j = 0; j < N; ++j) {
      rest += Digits50(a[i * N + j]) * Digits50(x[j]);
      row += abs(Digits50(a[i * N + j]));
    }
    if (!(rest == rest)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, Digits50(abs(rest)));
    size = std::max(size, row);
    reach = std::max(reach, Digits50(abs(Digits50(x[i]))));
  }
  if (worst == 0) return 0;
  return static_cast<double>(Digits50(worst / (size * reach))) /
         static_cast<double>(std::numeric_limits<T>::epsilon());
}

}  // namespace skinctl::testing
