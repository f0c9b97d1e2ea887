// SPDX-License-Identifier: BSD-3-Clause
// One step of the rest level, for one cell or for a lane of cells.
#pragma once

#include "skinctl/core/lane.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// All that a rest level remembers of a cell: six numbers, in the sensor's steps and seconds. `RestCell{}`
/// has its rest level at 0 and is not frozen.
template <Scalar S = float>
struct RestCell {
  S above{0};     ///< r: smoothed reading minus rest level [steps]
  S whole{0};     ///< the rest level in whole steps, which is taken off readings
  S fraction{0};  ///< rest level beyond `whole` [steps], within +-0.75
  S frozen{0};    ///< time since it froze, up to 64 s; negative after a fast rise; 0: not frozen
  S below{0};     ///< time continuously below the level that the state waits for, t <= 2 s; -1 - t in release
  S evidence{0};  ///< sum of the evidence for a drift, smoothed
};

namespace detail {

/// The factors of a step of one duration, the same for all cells; all but `pieces` for one of its pieces.
template <Real T>
struct RestStep {
  int pieces = 1;  ///< number of equal pieces of a step, so that changes of state are in their places
  T per_piece = T(1);
  T dt = T(0), per_dt = T(0);                    ///< length [s], 1 over it [1/s]; 0 s: nothing changes
  T begin = T(0), end = T(0);                    ///< share of (reading - m), at both ends, by which m moves
  T begin_mean = T(0), end_mean = T(0);          ///< factor of the mean of m over the step
  T follow = T(0), fall = T(0), release = T(0);  ///< share of r by which the rest level moves, state by state
  T smooth = T(0);                               ///< share by which the evidence moves
  T low_for = T(0), quiet_for = T(0), fast_within = T(0);  ///< see `RestSettings` [s]
};

template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S unit_range(const S& x) noexcept {
  using std::max;
  using std::min;
  return max(S(0), min(S(1), x));
}
template <class M>
[[nodiscard]] SKINCTL_INLINE M both(M a, M b) noexcept {
  return a & b;
}
[[nodiscard]] SKINCTL_INLINE bool both(bool a, bool b) noexcept {
  return a && b;
}
template <class M>
[[nodiscard]] SKINCTL_INLINE M either(M a, M b) noexcept {
  return a | b;
}
[[nodiscard]] SKINCTL_INLINE bool either(bool a, bool b) noexcept {
  return a || b;
}
template <class M>
[[nodiscard]] SKINCTL_INLINE bool holds(M a) noexcept {
  return all(a);
}
[[nodiscard]] SKINCTL_INLINE bool holds(bool a) noexcept {
  return a;
}

/// Nearest whole number, |x| < 2^22 (float).
template <Scalar S>
[[nodiscard]] SKINCTL_INLINE S nearest_whole(const S& x) noexcept {
  constexpr auto magic = sizeof(skinctl::RealOf<S>) == 4 ? 12582912.0 : 6755399441055744.0;
  const S shifted = x + S(magic);
  return shifted - S(magic);
}

/// Sets r and the rest level of a cell, whole steps apart. `whole` moves at 3/4 of a step, so that noise
/// about a half does not move it to and fro.
template <Scalar S>
SKINCTL_INLINE void carry_over(RestCell<S>& cell, const S& above, const S& fraction) noexcept {
  using std::abs;
  const S carry = select(abs(fraction) > S(0.75), nearest_whole(fraction), S(0));
  cell.above = above;
  cell.whole = cell.whole + carry;
  cell.fraction = fraction - carry;
}

/// Largest magnitude of a valid reading [steps].
inline constexpr double max_steps = 1048576;
/// Largest magnitude of a valid sum of evidence.
inline constexpr double max_evidence = 100;
/// Longest time since freezing that is counted [s].
inline constexpr double longest_frozen = 64;

/// Moves a cell on by one step, over which its reading goes linearly from `x0` to `x1`. States change within
/// the step: it is shared between them as r, taken as linear, crosses their levels.
///
/// @param seen   sum of the evidence for a drift, over the step.
/// @param kappa  level at which it freezes; `touch` the threshold of a touch [steps].
template <Scalar S>
SKINCTL_INLINE void rest_step(RestCell<S>& cell, const S& x0, const S& x1, const S& seen, const S& kappa,
                              const S& touch, const RestStep<skinctl::RealOf<S>>& k) noexcept {
  using std::abs;
  using std::copysign;
  using std::max;
  using std::min;
  using T = skinctl::RealOf<S>;
  const S zero(0), dt(k.dt);
  const auto heard = abs(x1) <= S(max_steps);  // not for NaN

  // The smoothed reading, and its mean, relative to b at the beginning.
  const S r0 = cell.above, m0 = cell.fraction + r0;
  const S d0 = (x0 - cell.whole) - m0, d1 = (x1 - cell.whole) - m0;
  const S r = r0 + (S(k.begin) * d0 + S(k.end) * d1);
  const S mean = r0 + (S(k.begin_mean) * d0 + S(k.end_mean) * d1);

  const S said = select(abs(seen) <= S(max_evidence), seen, zero);
  const S evidence = cell.evidence + S(k.smooth) * (said - cell.evidence);

  // Nearly always, nearly all cells are calm: as below, to the bit, with all its branches known.
  const auto calm = both(both(both(cell.frozen == zero, cell.below == zero), max(r0, r) <= kappa),
                         both(both(min(r0, r) >= -kappa, abs(mean) <= kappa), heard));
  if (holds(calm)) [[likely]] {
    const S move = S(k.follow) * mean;
    carry_over(cell, S(r - move), S(cell.fraction + move));
    cell.evidence = evidence;
    return;
  }

  // Shares of the step in which r is below or above the levels.
  const S high = max(r0, r), low = min(r0, r), per = S(1) / (high - low + S(T(1e-30)));
  const S half = S(T(0.5)) * kappa, fast_level = S(T(0.5)) * touch;
  const S is_above = unit_range<S>((high - kappa) * per), is_low = unit_range<S>((-kappa - low) * per);
  const S is_quiet = unit_range<S>((half - low) * per), is_high = unit_range<S>((high - fast_level) * per);
  const S inside = S(1) - is_above - is_low;

  // For how long it has been low (following) or quiet (frozen; being low counts twice).
  const auto was = cell.frozen != zero;
  const auto was_released = cell.below < zero;
  const S level = select(was, half, S(-kappa));
  const S began = select(r0 < level, select(was_released, S(T(-1) - cell.below), cell.below), zero);
  const S counted = began + dt * select(was, S(is_quiet + is_low), is_low);
  S below = select(r < level, min(counted, S(2)), zero);

  // Frozen: since when, and whether by a fast rise.
  const S past = (counted - S(k.quiet_for)) * S(k.per_dt);
  const S over = unit_range<S>(select(is_low > S(T(0.5)), S(T(0.5) * past), past));
  const auto ends = both(both(was, r < half), counted >= S(k.quiet_for));
  const auto starts = both(!was, r > kappa);
  const auto frozen = both(either(was, starts), !ends);
  // A fast one that falls below half the threshold has ended; what is left of it is judged anew.
  const auto ended = both(both(was, cell.frozen < zero), r < fast_level);
  const S since = select(either(!was, ended), max(select(was, S(S(1) - is_high), is_above) * dt, S(T(1e-6))),
                         min(abs(cell.frozen) + dt, S(longest_frozen)));
  const auto fast = both(
      either(both(was, cell.frozen < zero), both(r >= fast_level, since - is_high * dt <= S(k.fast_within))),
      !ended);
  below = select(ends, select(r < -kappa, S(min(is_low, over) * dt), zero), below);

  // Released while the likelihood of a drift is high: from 3.5 until 1.5. 3t/(t + 32 s) is ln(1 + t/10 s) to
  // 0.07, up to 2.
  const S q = S(1) / (since + S(32));
  const S drift = select(fast, S(T(-2)), S(T(2.2))) - S(96) * q + evidence;
  const S change = (evidence - cell.evidence) + S(96) * q * q * dt;
  const S wanted = select(was_released, S(T(1.5)), S(T(3.5)));
  const S share = unit_range<S>((max(drift, S(drift - change)) - wanted) / (abs(change) + S(T(1e-30))));
  const auto released = both(both(was, frozen), drift > wanted);

  // The rest level moves.
  const S follows = select(was, select(ends, min(over, inside), zero), inside);
  const S falls = select(was, zero, max(zero, min(is_low, S((counted - S(k.low_for)) * S(k.per_dt)))));
  const S gives = select(both(was, frozen), share, zero);
  const S move = S(k.follow) * follows * max(S(-kappa), min(kappa, mean)) +
                 S(k.fall) * falls * min(S(-kappa), mean) + S(k.release) * gives * mean;
  RestCell<S> next = cell;
  carry_over(next, S(r - move), S(cell.fraction + move));

  cell.above = select(heard, next.above, cell.above);
  cell.whole = select(heard, next.whole, cell.whole);
  cell.fraction = select(heard, next.fraction, cell.fraction);
  cell.frozen = select(heard, select(frozen, select(fast, S(-since), since), zero), cell.frozen);
  cell.below = select(heard, select(released, S(T(-1) - below), below), cell.below);
  cell.evidence = select(heard, evidence, cell.evidence);
}

/// Moves a cell on by a step in its pieces.
template <Scalar S>
SKINCTL_INLINE void rest_steps(RestCell<S>& cell, const S& from, const S& x1, const S& seen, const S& kappa,
                               const S& touch, const RestStep<skinctl::RealOf<S>>& k) noexcept {
  using std::abs;
  const S x0 = select(abs(from) <= S(max_steps), from, x1);
  if (k.pieces == 1) [[likely]]
    return rest_step<S>(cell, x0, x1, seen, kappa, touch, k);
  const S slope = S(k.per_piece) * (x1 - x0);
  S x = x0;
  for (int i = 1; i <= k.pieces; ++i) {
    const S next = i == k.pieces ? x1 : S(x + slope);
    rest_step<S>(cell, x, next, seen, kappa, touch, k);
    x = next;
  }
}

}  // namespace detail

SKINCTL_END_NAMESPACE
