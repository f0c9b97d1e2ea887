// SPDX-License-Identifier: BSD-3-Clause
// Evidence for a drift and against a touch, from what else is known of a cell, for its rest level.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "skinctl/sensing/rest_level.hpp"

SKINCTL_BEGIN_NAMESPACE

// Each source says how much likelier (natural logarithm) a drift is than a touch, within bounds: a source
// that is fooled for an hour, as proximity by a glove that it does not see, must not win by persistence. The
// sum of the sources goes to `RestLevel::take` and `scan`, which smooth it. All are written for a number or a
// lane; an argument that is NaN gives 0: no evidence.

/// Evidence for a drift of a cell that reads a proximity in [0, 1]: 3.9 with nothing near (below 0.05), -3.9
/// with something (above 0.5), else 0.
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S proximity_evidence(const S& proximity) noexcept {
  return select(proximity < S(0.05), S(3.9), select(proximity > S(0.5), S(-3.9), S(0)));
}

/// Evidence for a drift of a cell of a large patch, which reads r above its rest level: 3 where r is within
/// 30 % of the patch's median r and that is above 3 steps; -1 where the patch has moved and the cell with it
/// has not; -0.4 where the patch stands still. For patches of at least `patch_median_cells` cells that no one
/// object covers: of a single finger, a grasp is what the median shows.
///
/// @param r, median  [steps]; the median as `patch_median` gives it.
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S median_evidence(const S& r, const S& median) noexcept {
  using std::abs;
  const S off = abs(r - median);
  const S said = select(abs(median) > S(3), select(off <= S(0.3) * median, S(3), S(-1)), S(-0.4));
  return select(off >= S(0), said, S(0));
}
/// Least number of cells of a patch whose median is evidence.
inline constexpr std::size_t patch_median_cells = 60;
/// The median of the readings above rest levels [steps] over `count` cells from the `first` on, of rows of
/// 16; over at most 255 of them, evenly drawn. NaN, so no evidence, for fewer than `patch_median_cells`. A
/// microsecond or two: as the evidence is smoothed over 2 s, ten times a second is enough.
[[nodiscard]] inline float patch_median(const RestRow* rows, std::size_t first, std::size_t count) noexcept {
  if (count < patch_median_cells) return std::numeric_limits<float>::quiet_NaN();
  std::array<float, 255> r{};
  const std::size_t taken = count < r.size() ? count : r.size();
  for (std::size_t n = 0; n < taken; ++n) {
    const std::size_t i = first + n * count / taken;
    r[n] = rows[i / RestRow::cells].above[i % RestRow::cells];
  }
  const auto middle = r.begin() + static_cast<std::ptrdiff_t>(taken / 2);
  std::nth_element(r.begin(), middle, r.begin() + static_cast<std::ptrdiff_t>(taken));
  return *middle;
}

SKINCTL_END_NAMESPACE
