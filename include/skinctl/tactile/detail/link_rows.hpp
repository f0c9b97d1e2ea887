// Wrenches of links while they are summed.
#pragma once

#include "skinctl/tactile/detail/cell_table.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The wrenches of a `LinkWrenches` `W` as rows of eight: whole registers. A register that is loaded as it was stored
/// comes at once; one whose pieces were stored apart waits until all of them have left for the cache.
template <class W>
struct LinkRows {
  using T = typename W::scalar;
  alignas(64) T row[W::count == 0 ? 1 : W::count][row_size] = {};

  /// `wrench of the link += factor sums`, for a row of sums of unit wrenches; `cell` is any of theirs.
  SKINCTL_INLINE void add(std::size_t slot, const T& factor, const auto* sums,
                          const CellUnit& cell) noexcept {
    for (std::size_t r = 0; r < row_used<T>; ++r)
      row[slot][r] = row[slot][r] + factor * ExactSums::at<T>(sums, r, cell);
  }
  SKINCTL_INLINE void add_to(W& wrenches, const T& factor) const noexcept {
    for (std::size_t k = 0; k < W::count; ++k)
      for (std::size_t r = 0; r < 6; ++r) wrenches.data[k][r] = wrenches.data[k][r] + factor * row[k][r];
  }
  SKINCTL_INLINE void write(W& wrenches) const noexcept {
    for (std::size_t k = 0; k < W::count; ++k)
      for (std::size_t r = 0; r < 6; ++r) wrenches.data[k][r] = row[k][r];
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
