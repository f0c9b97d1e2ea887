// SPDX-License-Identifier: BSD-3-Clause
// A product of a matrix with itself, and the determinant of a symmetric matrix that changes.
#pragma once

#include <cstddef>

#include "skinctl/core/config.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Element (i, j) of `J'J` (by joints) or of `J J'`, from joints' columns in the rows of `r` and `s`; with
/// those of dJ in `r`, half of its rate.
template <bool ByJoints, std::size_t Joints, std::size_t Rows, class T>
[[nodiscard]] SKINCTL_INLINE T row_product(const T (&r)[Joints][Rows], const T (&s)[Joints][Rows],
                                           std::size_t i, std::size_t j) noexcept {
  T sum(0);
  if constexpr (ByJoints) {
    for (std::size_t k = 0; k < Rows; ++k) sum = sum + r[i][k] * s[j][k];
  } else {
    for (std::size_t k = 0; k < Joints; ++k) sum = sum + r[k][i] * s[k][j];
  }
  return sum;
}

/// Determinant of a symmetric positive semi-definite matrix and its time derivative.
template <Real T>
struct Determinant {
  T value;
  T rate;
};
/// Determinant and rate by elimination with the largest diagonal element first, values and rates together: at
/// a singular matrix only the last pivot vanishes, and neither value nor rate is divided by it.
template <std::size_t N, Real T>
[[nodiscard]] Determinant<T> determinant(T (&a)[N][N], T (&da)[N][N]) noexcept {
  Determinant<T> det{T(1), T(0)};
  bool taken[N] = {};
  for (std::size_t step = 0; step < N; ++step) {
    std::size_t k = N;
    for (std::size_t i = 0; i < N; ++i)
      if (!taken[i] && (k == N || a[i][i] > a[k][k])) k = i;
    taken[k] = true;
    const T pivot = a[k][k];
    det.rate = det.rate * pivot + det.value * da[k][k];
    det.value = det.value * pivot;
    if (!(pivot > T(0))) return {T(pivot == pivot ? T(0) : pivot), T(pivot == pivot ? T(0) : pivot)};
    const T inverse = T(1) / pivot;
    for (std::size_t i = 0; i < N; ++i) {
      if (taken[i]) continue;
      const T f = a[i][k] * inverse;
      const T df = (da[i][k] - f * da[k][k]) * inverse;
      for (std::size_t j = 0; j < N; ++j) {
        if (taken[j]) continue;
        da[i][j] = da[i][j] - df * a[k][j] - f * da[k][j];
        a[i][j] = a[i][j] - f * a[k][j];
      }
    }
  }
  return det;
}

}  // namespace detail

SKINCTL_END_NAMESPACE
