// Cholesky's factor of a small symmetric matrix, for K_d.
#pragma once

#include <cmath>
#include <cstddef>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Lower factor L of `a = L L'`, row by row, with the inverse of its diagonal on the diagonal. Returns the
/// smallest pivot; not positive: the matrix is not positive definite and the factor is unusable (but finite).
template <std::size_t N, Real T>
SKINCTL_INLINE T cholesky(const T* a, T* factor) noexcept {
  using std::sqrt;
  T smallest(0);
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      T sum = a[i * N + j];
      for (std::size_t k = 0; k < j; ++k) sum = sum - factor[i * N + k] * factor[j * N + k];
      if (j < i) {
        factor[i * N + j] = sum * factor[j * N + j];
      } else {
        if (i == 0 || !(sum >= smallest)) smallest = sum;
        factor[i * N + i] = sum > T(0) ? T(T(1) / sqrt(sum)) : T(0);
      }
    }
  return smallest;
}

/// `x` with `L L' x = b`.
template <std::size_t N, Real T>
SKINCTL_INLINE void solve(const T* factor, const T* b, T* x) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    T sum = b[i];
    for (std::size_t k = 0; k < i; ++k) sum = sum - factor[i * N + k] * x[k];
    x[i] = sum * factor[i * N + i];
  }
  for (std::size_t i = N; i-- > 0;) {
    T sum = x[i];
    for (std::size_t k = i + 1; k < N; ++k) sum = sum - factor[k * N + i] * x[k];
    x[i] = sum * factor[i * N + i];
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
