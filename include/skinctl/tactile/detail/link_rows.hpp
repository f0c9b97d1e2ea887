// Wrenches of links while they are summed.
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/tactile/detail/cell_table.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The wrenches of a `LinkWrenches` `W` as rows of eight: whole registers. A register that is loaded as it was stored
/// comes at once; one whose pieces were stored apart waits until all of them have left for the cache.
template <class W>
struct LinkRows {
  using T = typename W::scalar;
  using Six = Row<6, T>;
  static constexpr std::size_t rows = W::count == 0 ? 1 : W::count;
  alignas(64) T row[rows][row_size];

  /// All 0, register by register: GCC zeroes an array with an instruction that starts slowly, and behind which loads wait.
  SKINCTL_INLINE LinkRows() noexcept {
    if constexpr (row_lanes<T> == 1 || rows > 8) {
      for (auto& one : row)
        for (T& x : one) x = T(0);
    } else {
      unrolled<rows * row_size / row_lanes<T>>([&](std::size_t k) SKINCTL_INLINE_LAMBDA {
        using Part = typename LaneTypes<T, row_lanes<T>>::Anywhere;
        const std::size_t at = k * row_lanes<T>;
        *reinterpret_cast<Part*>(row[at / row_size] + at % row_size) = Part{};
      });
    }
  }

  /// `wrench of the link += factor sums`, for a row of sums of unit wrenches; `cell` is any of theirs.
  SKINCTL_INLINE void add(std::size_t slot, const T& factor, const auto* sums,
                          const CellUnit& cell) noexcept {
    for (std::size_t r = 0; r < row_used<T>; ++r)
      row[slot][r] = row[slot][r] + factor * ExactSums::at<T>(sums, r, cell);
  }
  // By rows: GCC would put numbers of two links into one register, from stores of two.
  SKINCTL_INLINE void add_to(W& wrenches, const T& factor) const noexcept {
    for (std::size_t k = 0; k < W::count; ++k)
      (Six(wrenches.data[k]) + Six(factor) * Six(row[k])).store(wrenches.data[k]);
  }
  SKINCTL_INLINE void write(W& wrenches) const noexcept {
    for (std::size_t k = 0; k < W::count; ++k) Six(row[k]).store(wrenches.data[k]);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
