// Evidence for a drift and against a touch, from what else is known of a cell, for its rest level.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "skinctl/sensing/rest_level.hpp"

SKINCTL_BEGIN_NAMESPACE

// Each source says how much likelier (natural logarithm) a drift is than a touch, within bounds: a source that
// is fooled for an hour, as proximity by a glove that it does not see, must not win by persistence. The sum of
// the sources goes to `RestLevel::take` and `scan`, which smooth it. All are written for a number or a lane; an
// argument that is NaN gives 0: no evidence.

/// Of a cell that reads a proximity in [0, 1]: 3.9 with nothing near (below 0.05), -3.9 with something
/// (above 0.5), else 0.
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S proximity_evidence(const S& proximity) noexcept {
  return select(proximity < S(0.05), S(3.9), select(proximity > S(0.5), S(-3.9), S(0)));
}

/// Of a cell's temperature: 2.5 where r is within 30 % of what the change of temperature explains, -0.5 where
/// it is not, -0.3 where the temperature has changed by 0.5 K at most.
///
/// @param r           the cell's reading above its rest level [steps].
/// @param dT          change of its temperature since its rest level moved last [K]: see `reference_moves`.
/// @param per_kelvin  drift of the cell's reading with temperature [steps/K]; 0: not known, no evidence.
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S temperature_evidence(const S& r, const S& dT, const S& per_kelvin) noexcept {
  using std::abs;
  const S explained = per_kelvin * dT, off = abs(r - explained);
  const auto changed = abs(dT) > S(0.5);
  const S said = select(changed, select(off <= S(0.3) * abs(explained), S(2.5), S(-0.5)), S(-0.3));
  return select(detail::both(abs(per_kelvin) > S(0), off >= S(0)), said, S(0));
}
/// Share of `T - reference` by which the temperature that belongs to a cell's rest level moves in a step: as
/// the rest level does.
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S reference_moves(const RestCell<S>& cell,
                                               const RestLevel::Step<RealOf<S>>& k) noexcept {
  return select(cell.frozen != S(0), select(cell.below < S(0), S(k.release), S(0)), S(k.follow));
}

/// Of a large patch: 3 where r is within 30 % of the patch's median r and that is above 3 steps; -1 where the
/// patch has moved and the cell with it has not; -0.4 where the patch stands still. For patches of at least
/// `patch_median_cells` cells that no one object covers: of a single finger, a grasp is what the median shows.
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
/// The median of r [steps] over `count` cells from the `first` on, of rows of 16; over at most 255 of them,
/// evenly drawn. NaN, so no evidence, for fewer than `patch_median_cells`. A microsecond or two: as the evidence
/// is smoothed over 2 s, ten times a second is enough.
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

/// Of joint torques that are measured apart from the skin (motors, a wrist sensor), with a deviation `sigma`
/// [N m]: the log of the likelihood of `measured` without the cell's push, over that with it; within +-4.
///
/// @param measured   torque of contacts about a joint [N m], less what the other cells explain: what is left
///                   for this cell.
/// @param predicted  torque about the same joint that r would mean as a push on this cell [N m].
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S torque_evidence(const S& measured, const S& predicted,
                                               const S& sigma = S(1.5)) noexcept {
  using std::max;
  using std::min;
  const S left = measured - predicted;
  const S said = (left * left - measured * measured) / (S(2) * sigma * sigma);
  return select(said == said, max(S(-4), min(S(4), said)), S(0));
}

SKINCTL_END_NAMESPACE
