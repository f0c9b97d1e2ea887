// SPDX-License-Identifier: BSD-3-Clause
// The scan of all cells, frame by frame: statistics of their readings, 16 cells a row, without a branch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "skinctl/core/lane.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The statistics of 16 cells. Forces in steps of the sensor, proximities in 0 to 1, times in seconds.
struct alignas(64) HealthRow {
  static constexpr std::size_t cells = 16;
  using Row = std::array<float, cells>;
  static constexpr Row nothing = [] {
    Row row{};
    for (float& x : row) x = std::numeric_limits<float>::quiet_NaN();
    return row;
  }();
  Row force = nothing, last = nothing,
      change{};  ///< the newest reading, NaN: none; that of the frame before; their difference
  Row proximity{}, last_proximity{};
  Row gap{};                        ///< time since the last sample
  Row first{}, second{}, capped{};  ///< leaky means of squared differences, in sigma^2: see `frame_scan`
  Row top{};                        ///< time for which a force sensor has been at its top
  Row jumps{}, pending{};           ///< leaky count of jumps without witness; time left for its witness
  Row still{}, still_proximity{};   ///< time since the force moved, since the proximity moved
  Row seen{};                       ///< time for which the proximity has been above 0.1; -10 at a jump
  Row hold{}, mask{};               ///< time left for the mask; the mask, 0 to 1
  Row trust{};                      ///< share of its push that counts; fades within 0.1 s without a witness
};
/// Constants of the cells of a row.
struct alignas(64) HealthLimitsRow {
  HealthRow::Row per_sigma{};  ///< 1 over the standard deviation of the force [1/step]
  HealthRow::Row jump{};       ///< smallest jump of the force within 6 ms [steps]
  HealthRow::Row proximity{};  ///< six standard deviations of the proximity
  HealthRow::Row moves{};      ///< smallest movement of the force that no noise makes [steps]
};
/// The factors of a frame of length `dt` [s].
struct HealthStep {
  float dt = 0, leak = 1, rise = 0, fall = 0;  ///< leak: of the jumps' count; rise, fall: of the masks
  float saturated = 0.2f;
  float per_gap = 1 / 0.006f;  ///< factor of a gap by which a cell may move more than in 6 ms [1/s]
  /// Longest time between samples that follow each other [s]: a row of seven lost ones, less than a
  /// keep-alive.
  float follows = 0.03f;
};

/// A bit for each of 16 cells.
struct HealthBits {
  std::uint32_t jumped = 0;   ///< cells that jumped in this frame
  std::uint32_t expired = 0;  ///< cells whose time for a witness of the last jump is over
  std::uint32_t look = 0;     ///< cells worth a look: one of these, or a mask, noise, a sensor at its top
};

/// The lowest bits as a mask of lanes.
template <std::size_t W = native_lanes<float>>
[[nodiscard]] SKINCTL_INLINE LaneMask<float, W> lanes_of(std::uint32_t bits) noexcept {
  if constexpr (W == 1) {
    return LaneMask<float, W>((bits & 1u) != 0);
  } else {
    typename LaneMask<float, W>::Bits lane{};
    for (std::size_t k = 0; k < W; ++k) lane[k] = 1 << k;
    return LaneMask<float, W>((lane & static_cast<std::int32_t>(bits)) != 0);
  }
}

/// The findings of a frame about the forces of a lane of cells.
template <class L>
struct ForceChange {
  using Mask = LaneMask<float, L::lanes>;
  L d{0.0f};      ///< change since the last sample [steps]; 0 without a new one
  Mask jumped{};  ///< jump within one sample, no part of a fast movement
  Mask noisy{};   ///< noise beyond that of a sound cell
};
/// The statistics of the forces in lanes from `i` on, and what they show.
///
/// Differences `d` of samples and their differences `dd` are averaged over 0.2 s: `first = <d^2>`,
/// `second = <dd^2>`, `capped = <min(dd^2, 256)>`, where the force turns, in units of sigma^2. White noise
/// gives 2, 6, 5.3; a jump does not turn, and what trembles turns seldom. Across a silence, `dd` is twice the
/// smaller of both differences: a cell that was let go and then sends keep-alives does not turn with them.
template <class L>
[[nodiscard]] SKINCTL_INLINE ForceChange<L> force_change(HealthRow& r, const HealthLimitsRow& c,
                                                         std::size_t i,
                                                         const LaneMask<float, L::lanes>& fresh, const L& gap,
                                                         const L& slow, const L& follows) noexcept {
  const auto get = [i](const HealthRow::Row& row) SKINCTL_INLINE_LAMBDA { return L::load(row.data() + i); };
  const L zero(0.0f), share = min(gap * L(5.0f), L(1.0f));
  const L force = get(r.force), before = get(r.change), per = get(c.per_sigma), jump = get(c.jump);
  ForceChange<L> out;
  out.d = select(fresh, force - get(r.last), zero);
  const L d = out.d, a = d * per, both = min(abs(d), abs(before));
  const L b = select(gap > follows, both + both, abs(d - before)) * per, aa = a * a, bb = b * b;
  const L first = get(r.first), second = get(r.second), capped = get(r.capped);
  const L turns = select(a * before < zero, min(bb, L(256.0f)), zero);
  const L now_first = select(fresh, first + share * (aa - first), first);
  const L now_second = select(fresh, second + share * (bb - second), second);
  const L now_capped = select(fresh, capped + share * (turns - capped), capped);
  out.noisy = (now_capped > L(40.0f)) & (now_second > L(1.5f) * now_first);
  out.jumped = abs(d) > jump * slow;
  if (any(out.jumped | (before > jump))) [[unlikely]] {
    // What goes on as fast as before is a fast movement, and no jump; an edge that takes two samples is one.
    const auto goes_on = (before * d > zero) & (abs(before) > jump);
    out.jumped = out.jumped & (before * d < L(0.25f) * d * d) & !goes_on;
  }
  now_first.store(r.first.data() + i), now_second.store(r.second.data() + i);
  now_capped.store(r.capped.data() + i), select(fresh, d, before).store(r.change.data() + i);
  force.store(r.last.data() + i);
  return out;
}

/// Moves 16 cells on by one frame.
///
/// A force has moved if it changes by 6 sigma, a proximity if by 6 sigma and less than 0.3 in 6 ms. One that
/// jumps by 0.1 in 6 ms has not seen anything for 10 s, or until it sees nothing. Samples that are farther
/// apart than 6 ms may differ the more.
///
/// @param spoke, at_top  a bit for each cell: a sample has come since the last frame; a force sensor is at
///               its top.
SKINCTL_INLINE HealthBits frame_scan(HealthRow& r, const HealthLimitsRow& c, const HealthStep& k,
                                     std::uint32_t spoke, std::uint32_t at_top) noexcept {
  using L = Lane<float>;
  HealthBits bits;
  for (std::size_t i = 0; i < HealthRow::cells; i += L::lanes) {
    const auto get = [i](const HealthRow::Row& row) SKINCTL_INLINE_LAMBDA { return L::load(row.data() + i); };
    const L dt(k.dt), zero(0.0f), one(1.0f);
    const auto fresh = lanes_of(spoke >> i);
    const L gap = get(r.gap) + dt, slow = max(gap * L(k.per_gap), one);
    const ForceChange<L> now = force_change(r, c, i, fresh, gap, slow, L(k.follows));

    const L p = get(r.proximity), dp = select(fresh, abs(p - get(r.last_proximity)), zero);
    const auto p_moved = (dp > get(c.proximity)) & (dp <= L(0.3f) * slow);
    const L seen =
        select(fresh & (p < L(0.1f)), zero, select(dp > L(0.1f) * slow, L(-10.0f), get(r.seen) + dt));
    const L top = select(lanes_of(at_top >> i), get(r.top) + dt, zero);
    const L was = get(r.pending), pending = max(was - dt, zero);
    const L hold = max(get(r.hold) - dt, zero);
    const L mask = get(r.mask) + select(hold > zero, L(k.rise), L(-k.fall));
    const auto moved = abs(now.d * get(c.per_sigma)) > L(6.0f);
    const auto expired = (was > zero) & !(pending > zero);
    const auto look = now.jumped | expired | now.noisy | (top >= L(k.saturated)) | (hold > zero);

    p.store(r.last_proximity.data() + i), seen.store(r.seen.data() + i);
    select(fresh, zero, gap).store(r.gap.data() + i);
    select(moved, zero, get(r.still) + dt).store(r.still.data() + i);
    select(p_moved, zero, get(r.still_proximity) + dt).store(r.still_proximity.data() + i);
    top.store(r.top.data() + i), pending.store(r.pending.data() + i);
    (get(r.jumps) * L(k.leak)).store(r.jumps.data() + i);
    hold.store(r.hold.data() + i), max(min(mask, one), zero).store(r.mask.data() + i);
    max(get(r.trust) - dt * L(10.0f), zero).store(r.trust.data() + i);

    if (any(look))
      for (std::size_t lane = 0; lane < L::lanes; ++lane) {
        const std::uint32_t bit = 1u << (i + lane);
        bits.jumped |= now.jumped[lane] ? bit : 0u;
        bits.expired |= expired[lane] ? bit : 0u, bits.look |= look[lane] ? bit : 0u;
      }
  }
  return bits;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
