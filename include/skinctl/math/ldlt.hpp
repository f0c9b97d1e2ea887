// The factors of a small symmetric positive definite matrix, and solutions with them.
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
/// Without pivoting the factors of a positive definite matrix are backward stable: the solution is the exact
/// one of a matrix within about `4 N` units in the last place of the largest element, so it errs by that
/// times the condition. A pivot that is not above `8 epsilon` of its diagonal element is taken out: that
/// unknown is 0, the others solve their equations without it, and `positive_definite()` is false. So it is
/// for semi-definite and indefinite matrices, and wherever a NaN or an infinity is met; only then may the
/// solution be not finite (or if it overflows). Nothing is divided by zero.
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
      for (std::size_t i = 0; i < j; ++i) {
        scaled[i] = ld_[j][i] * inverse_[i];
        d = d - ld_[j][i] * scaled[i];
      }
      take_pivot(j, d, a[j * N + j]);
      for (std::size_t i = j + 1; i < N; ++i) {
        T s = a[i * N + j];
        for (std::size_t p = 0; p < j; ++p) s = s - ld_[i][p] * scaled[p];
        ld_[i][j] = s;
      }
    });
  }

  /// False if an unknown was taken out, in any lane.
  [[nodiscard]] SKINCTL_INLINE constexpr bool positive_definite() const noexcept {
    return positive_definite_;
  }
  /// Smallest element of D, as it came out, before any was taken out; NaN if one was.
  [[nodiscard]] SKINCTL_INLINE constexpr T least_pivot() const noexcept {
    T least = pivot_[0];
    for (std::size_t i = 1; i < N; ++i) least = select(!(pivot_[i] >= least), pivot_[i], least);
    return least;
  }

  /// Product of D: the determinant, unless an unknown was taken out. Next to a singular matrix it errs by the
  /// condition.
  [[nodiscard]] SKINCTL_INLINE constexpr T determinant() const noexcept {
    T product = pivot_[0];
    for (std::size_t i = 1; i < N; ++i) product = product * pivot_[i];
    return product;
  }

  /// `x` with `a x = b`; `x` may be `b`.
  SKINCTL_INLINE constexpr void solve(const T* b, T* x) const noexcept {
    T y[N];
    skinctl::detail::for_each_index<N>([&](auto k) SKINCTL_INLINE_LAMBDA {
      const std::size_t j = k;
      T r = b[j];
      for (std::size_t i = 0; i < j; ++i) r = r - ld_[j][i] * y[i];
      y[j] = r * inverse_[j];
    });
    skinctl::detail::for_each_index<N>([&](auto k) SKINCTL_INLINE_LAMBDA {
      const std::size_t j = N - 1 - k;
      T s(0);
      for (std::size_t i = j + 1; i < N; ++i) s = s + ld_[i][j] * x[i];
      x[j] = y[j] - s * inverse_[j];
    });
  }

 private:
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
