// SPDX-License-Identifier: BSD-3-Clause
// LDL' factors of a small symmetric positive definite matrix, and solutions with them.
#pragma once

#include <cstddef>
#include <limits>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/lane.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// `a = L D L'` of a symmetric `N` x `N` matrix: mass matrices, damping, normal equations. No square root,
/// one division a row, no allocation; straight-line code up to 16 rows. With lanes, as many matrices as
/// lanes at once.
///
/// Without pivoting the factors of a positive definite matrix are backward stable: the solution is exact for
/// a matrix within about `4 N` units in the last place of the largest element, so its error is that times the
/// condition number. A pivot of at most `8 epsilon` of its diagonal element is removed: that unknown is 0,
/// the others solve their equations without it, and `positive_definite()` is false. This happens for
/// semi-definite and indefinite matrices, and after any NaN or infinity; only then, or on overflow, may the
/// solution be not finite. Nothing is divided by zero.
template <std::size_t N, Scalar T = double>
class Ldlt {
  static_assert(N > 0, "Ldlt<N, T>: at least one row");

 public:
  /// @param a  `N * N` numbers, row by row; only the lower triangle is read.
  SKINCTL_INLINE constexpr explicit Ldlt(const T* a) noexcept {
    skinctl::detail::for_each_index<N>([&](auto k) SKINCTL_INLINE_LAMBDA {
      const std::size_t j = k;
      T d = a[j * N + j];
      T scaled[N];
      below(k, [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
        scaled[i] = ld_[j][i] * inverse_[i];
        d = d - ld_[j][i] * scaled[i];
      });
      take_pivot(j, d, a[j * N + j]);
      above(k, [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
        T s = a[i * N + j];
        below(k, [&](std::size_t p) SKINCTL_INLINE_LAMBDA { s = s - ld_[i][p] * scaled[p]; });
        ld_[i][j] = s;
      });
    });
  }

  /// Whether the matrix was positive definite: false if an unknown was removed, in any lane.
  [[nodiscard]] SKINCTL_INLINE constexpr bool positive_definite() const noexcept {
    return positive_definite_;
  }
  /// Smallest element of D before any was removed; NaN if one was NaN.
  [[nodiscard]] SKINCTL_INLINE constexpr T min_pivot() const noexcept {
    T least = pivot_[0];
    for (std::size_t i = 1; i < N; ++i) least = select(!(pivot_[i] >= least), pivot_[i], least);
    return least;
  }

  /// Product of D: the determinant, unless an unknown was removed. Near a singular matrix its error grows
  /// with the condition number.
  [[nodiscard]] SKINCTL_INLINE constexpr T determinant() const noexcept {
    T product = pivot_[0];
    for (std::size_t i = 1; i < N; ++i) product = product * pivot_[i];
    return product;
  }

  /// Solves `a x = b`; `x` may be `b`.
  /// @tparam B  numbers, or rows of them: several right sides at once.
  template <class B>
  SKINCTL_INLINE constexpr void solve(const B* b, B* x) const noexcept {
    B y[N];
    skinctl::detail::for_each_index<N>([&](auto k) SKINCTL_INLINE_LAMBDA {
      const std::size_t j = k;
      B r = b[j];
      below(k, [&](std::size_t i) SKINCTL_INLINE_LAMBDA { r = r - ld_[j][i] * y[i]; });
      y[j] = r * inverse_[j];
    });
    skinctl::detail::for_each_index<N>([&](auto k) SKINCTL_INLINE_LAMBDA {
      const std::size_t j = N - 1 - k;
      B s = T(0);
      below(k, [&](std::size_t i) SKINCTL_INLINE_LAMBDA { s = s + ld_[j + 1 + i][j] * x[j + 1 + i]; });
      x[j] = y[j] - s * inverse_[j];
    });
  }

 private:
  static constexpr std::size_t few = 8;
  /// `f` of the indices below `k`, and of those above it: straight-line code for a few unknowns.
  template <class K, class F>
  static SKINCTL_INLINE constexpr void below(K k, F&& f) noexcept {
    if constexpr (std::is_same_v<K, std::size_t>) {
      for (std::size_t i = 0; i < k; ++i) f(i);
    } else if constexpr (K::value > few) {
      for (std::size_t i = 0; i < K::value; ++i) f(i);
    } else {
      skinctl::detail::call_with(std::make_index_sequence<K::value>{}, f);
    }
  }
  template <class K, class F>
  static SKINCTL_INLINE constexpr void above(K k, F&& f) noexcept {
    if constexpr (std::is_same_v<K, std::size_t>) {
      for (std::size_t i = k + 1; i < N; ++i) f(i);
    } else if constexpr (N - 1 - K::value > few) {
      for (std::size_t i = K::value + 1; i < N; ++i) f(i);
    } else {
      skinctl::detail::call_with<K::value + 1>(std::make_index_sequence<N - 1 - K::value>{}, f);
    }
  }
  static SKINCTL_INLINE constexpr bool all_of(const auto& good) noexcept {
    if constexpr (is_lane<T>)
      return all(good);
    else
      return good;
  }
  SKINCTL_INLINE constexpr void take_pivot(std::size_t j, const T& d, const T& diagonal) noexcept {
    const T least = diagonal * (T(8) * T(std::numeric_limits<RealOf<T>>::epsilon()));
    pivot_[j] = d;
    const auto good = d > least;
    positive_definite_ = positive_definite_ & all_of(good);
    inverse_[j] = T(1) / select(good, d, T(std::numeric_limits<RealOf<T>>::infinity()));
  }

  T ld_[N][N];  // L D, below the diagonal
  T pivot_[N];  // D
  T inverse_[N];
  bool positive_definite_ = true;
};

}  // namespace math
SKINCTL_END_NAMESPACE
