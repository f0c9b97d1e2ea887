// SPDX-License-Identifier: BSD-3-Clause
// The real part of an inverse: a rational function of a symmetric matrix, without its eigenvalues.
#pragma once

#include "skinctl/core/detail/row.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `z = Re (r + i a)^-1`, which has the eigenvectors of `r` and for each eigenvalue rho of it `rho / (rho^2 +
/// a^2)`: by sweeps, row by row in lanes.
///
/// @param r  rows of a symmetric, positive semi-definite matrix; singular ones too. Overwritten.
/// @param a  > 0. With it the elimination needs no pivots and divides by nothing smaller than a.
template <std::size_t K, Real T>
SKINCTL_INLINE void real_of_inverse(Row<K, T> (&r)[K], const T& a, Row<K, T> (&z)[K]) noexcept {
  using R = Row<K, T>;
  const auto at = [](auto k, const T& x, const R& row) SKINCTL_INLINE_LAMBDA {  // `row` with x at k
    return select(R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return T(i == k ? 1 : 0); }) > R(T(0)), R(x),
                  row);
  };
  R im[K];
  unrolled<K>([&](auto k) SKINCTL_INLINE_LAMBDA { im[k] = at(k, a, R(T(0))); });
  // A sweep of every row turns the matrix into its negative inverse, and keeps it symmetric.
  unrolled<K>([&](auto k) SKINCTL_INLINE_LAMBDA {
    T re_k[K], im_k[K];
    r[k].store(re_k), im[k].store(im_k);
    const T size = re_k[k] * re_k[k] + im_k[k] * im_k[k], per_size = T(1) / size;
    const T p = re_k[k] * per_size, q = -im_k[k] * per_size;
    const R x = at(k, T(-p), p * r[k] - q * im[k]), y = at(k, T(-q), q * r[k] + p * im[k]);
    unrolled<K>([&](auto i) SKINCTL_INLINE_LAMBDA {
      if constexpr (i != k) {
        r[i] = at(k, T(0), r[i]) - re_k[i] * x + im_k[i] * y;
        im[i] = at(k, T(0), im[i]) - re_k[i] * y - im_k[i] * x;
      }
    });
    r[k] = x, im[k] = y;
  });
  unrolled<K>([&](auto k) SKINCTL_INLINE_LAMBDA { z[k] = -r[k]; });
}
/// `real_of_inverse` for matrices of bare numbers.
template <std::size_t K, Real T>
void real_of_inverse(const T (&r)[K][K], const T& a, T (&z)[K][K]) noexcept {
  Row<K, T> rows[K], out[K];
  for (std::size_t k = 0; k < K; ++k) rows[k] = Row<K, T>(r[k]);
  real_of_inverse(rows, a, out);
  for (std::size_t k = 0; k < K; ++k) out[k].store(z[k]);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
