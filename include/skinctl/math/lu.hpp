// SPDX-License-Identifier: BSD-3-Clause
// LU factors of a small square matrix, symmetric or not, and solutions with them.
#pragma once

#include <cstddef>
#include <limits>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// `P a = L U` of a square matrix, with the largest element of each column as its pivot: for matrices such as
/// `M + h B + h C`, which is not symmetric. A symmetric positive definite matrix takes half the time: `Ldlt`.
/// No allocation, one division a row.
///
/// The solution is exact for a matrix within `N` units in the last place of the largest element (for all but
/// constructed matrices), so its error is that times the condition number. A pivot of at most `8 epsilon` of
/// the terms from which it was computed, whatever the units of rows and columns, is removed: that unknown is
/// 0, one equation is dropped, and `regular()` is false, as it is for every matrix with a NaN or an infinity.
/// Nothing is divided by zero.
template <std::size_t N, Real T = double>
class Lu {
  static_assert(N > 0, "Lu<N, T>: at least one row");

 public:
  /// @param a  `N * N` numbers, row by row.
  constexpr explicit Lu(const T* a) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      from_[i] = i;
      for (std::size_t j = 0; j < N; ++j) lu_[i][j] = a[i * N + j];
    }
    for (std::size_t j = 0; j < N; ++j) {
      std::size_t best = j;
      for (std::size_t i = j + 1; i < N; ++i)
        if (skinctl::detail::magnitude(lu_[i][j]) > skinctl::detail::magnitude(lu_[best][j])) best = i;
      if (best != j) exchange(best, j);
      T terms = skinctl::detail::magnitude(a[from_[j] * N + j]);  // the pivot's terms, in magnitude
      for (std::size_t k = 0; k < j; ++k)
        terms = terms + skinctl::detail::magnitude(T(lu_[j][k] * lu_[k][j]));
      const bool good =
          skinctl::detail::magnitude(lu_[j][j]) > terms * (T(8) * std::numeric_limits<T>::epsilon());
      regular_ = regular_ && good;
      inverse_[j] = good ? T(T(1) / lu_[j][j]) : T(0);
      for (std::size_t i = j + 1; i < N; ++i) {
        const T factor = lu_[i][j] * inverse_[j];
        lu_[i][j] = factor;
        for (std::size_t k = j + 1; k < N; ++k) lu_[i][k] = lu_[i][k] - factor * lu_[j][k];
      }
    }
  }

  /// Whether the matrix was regular: false if an unknown was removed.
  [[nodiscard]] constexpr bool regular() const noexcept { return regular_; }

  /// Solves `a x = b`; `x` may be `b`.
  constexpr void solve(const T* b, T* x) const noexcept {
    T y[N];
    for (std::size_t i = 0; i < N; ++i) {
      T s = b[from_[i]];
      for (std::size_t j = 0; j < i; ++j) s = s - lu_[i][j] * y[j];
      y[i] = s;
    }
    for (std::size_t i = N; i-- > 0;) {
      T s = y[i];
      for (std::size_t j = i + 1; j < N; ++j) s = s - lu_[i][j] * x[j];
      x[i] = s * inverse_[i];
    }
  }

 private:
  SKINCTL_INLINE constexpr void exchange(std::size_t p, std::size_t q) noexcept {
    for (std::size_t k = 0; k < N; ++k) {
      const T kept = lu_[p][k];
      lu_[p][k] = lu_[q][k];
      lu_[q][k] = kept;
    }
    const std::size_t row = from_[p];
    from_[p] = from_[q];
    from_[q] = row;
  }

  T lu_[N][N];           // U, and L below the diagonal
  T inverse_[N];         // of the diagonal of U
  std::size_t from_[N];  // row i of the factors was row from_[i]
  bool regular_ = true;
};

}  // namespace math
SKINCTL_END_NAMESPACE
