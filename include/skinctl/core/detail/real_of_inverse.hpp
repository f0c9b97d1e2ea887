// The real part of an inverse: a rational function of a symmetric matrix, without its eigenvalues.
#pragma once

#include <cstddef>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `z = Re (r + i a)^-1`, which has the eigenvectors of `r` and for each eigenvalue rho of it `rho / (rho^2 +
/// a^2)`.
///
/// @param r  symmetric, positive semi-definite; singular ones too.
/// @param a  > 0. With it the elimination needs no pivots and divides by nothing smaller than a.
template <std::size_t K, Real T>
void real_of_inverse(const T (&r)[K][K], const T& a, T (&z)[K][K]) noexcept {
  struct Complex {
    T re = T(0), im = T(0);
    Complex times(const Complex& b) const noexcept { return {re * b.re - im * b.im, re * b.im + im * b.re}; }
    Complex less(const Complex& b) const noexcept { return {re - b.re, im - b.im}; }
  };
  Complex l[K][K], inverse[K];
  for (std::size_t j = 0; j < K; ++j) {
    Complex scaled[K];
    Complex d{r[j][j], a};
    for (std::size_t p = 0; p < j; ++p) {
      scaled[p] = l[j][p];  // still times D
      l[j][p] = l[j][p].times(inverse[p]);
      d = d.less(scaled[p].times(l[j][p]));
    }
    const T size = d.re * d.re + d.im * d.im;
    inverse[j] = {d.re / size, -d.im / size};
    for (std::size_t i = j + 1; i < K; ++i) {
      Complex s{r[i][j], T(0)};
      for (std::size_t p = 0; p < j; ++p) s = s.less(l[i][p].times(l[j][p]));
      l[i][j] = s;
    }
  }
  for (std::size_t c = 0; c < K; ++c) {
    Complex x[K];
    x[c].re = T(1);
    for (std::size_t i = c; i < K; ++i)
      for (std::size_t p = c; p < i; ++p) x[i] = x[i].less(l[i][p].times(x[p]));
    for (std::size_t i = K; i-- > 0;) {
      x[i] = x[i].times(inverse[i]);
      for (std::size_t p = i + 1; p < K; ++p) x[i] = x[i].less(l[p][i].times(x[p]));
      z[i][c] = x[i].re;
    }
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
