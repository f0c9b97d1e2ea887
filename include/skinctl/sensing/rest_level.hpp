// SPDX-License-Identifier: BSD-3-Clause
// The rest level of a cell: what it reads untouched. It follows drifts, stands still in a contact however
// long that lasts, and is the same at any rate of the sensor.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/sensing/detail/rest_step.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Times of a rest level: see `RestLevel`, whose kappa says what is near. The defaults are for capacitive
/// skins at room temperature.
struct RestSettings {
  Nanoseconds smooth = 100ms;       ///< time constant of the smoothed reading
  Nanoseconds follow = 20s;         ///< time constant of the rest level while the reading is near it
  Nanoseconds fall = 500ms;         ///< time constant of a rest level that was too high for `low_for`
  Nanoseconds low_for = 500ms;      ///< time of readings below the rest level that shows it to be wrong
  Nanoseconds quiet_for = 1s;       ///< time of readings near the rest level until a cell is frozen no more
  Nanoseconds fast_within = 600ms;  ///< longest rise to half of the threshold that speaks for a touch
  Nanoseconds release = 5s;         ///< time constant of the rest level of a frozen cell that drifts
  Nanoseconds weigh = 2s;           ///< time constant of the evidence
  Nanoseconds ramp = 6ms;           ///< longest time before a sample in which its change of reading happened
  Nanoseconds max_gap = 1s;         ///< longest time between two readings; longer ones count as it
};

/// Distances from the rest level of a cell that count as drift and as touch, in steps of its sensor.
struct RestLevels {
  float freeze = 1;  ///< kappa: largest distance from the rest level that is drift [steps]
  float touch = 80;  ///< distance from the rest level from which on it is a touch [steps]

  /// Throws `ConfigurationError` unless 0 < freeze <= touch <= 2^20 steps.
  void check() const {
    require(freeze > 0 && freeze <= touch, "RestLevels: freeze", double(freeze), "> 0 steps, <= touch");
    require(touch <= float(detail::max_steps), "RestLevels: touch", double(touch), "<= 2^20 steps");
  }
};

/// The `RestCell`s of 16 cells, field by field: 24 bytes a cell. A row of zeros has its rest levels at 0.
struct alignas(64) RestRow {
  static constexpr std::size_t cells = 16;
  float above[cells]{}, whole[cells]{}, fraction[cells]{}, frozen[cells]{}, below[cells]{}, evidence[cells]{};
};
/// The `RestLevels` of the cells of a row [steps].
struct alignas(64) RestLevelsRow {
  float freeze[RestRow::cells]{}, touch[RestRow::cells]{};
};

/// The rest level b of a cell, from its readings x, all in steps of its sensor:
///
///     m' = (x - m)/smooth,   r = m - b
///
/// | state     | when                                                               | b' =        |
/// |-----------|--------------------------------------------------------------------|-------------|
/// | following | abs(r) <= kappa                                                    | r / follow  |
/// | falling   | r < -kappa for `low_for` (until then b stands)                     | r / fall    |
/// | frozen    | from r > kappa until r < kappa/2 for `quiet_for` (time at r < -kappa counts twice) | 0 |
/// | released  | frozen, and L > 3.5, until L < 1.5                                 | r / release |
///
///     L = -3 + 3t/(t + 32 s) + (r >= touch/2 within fast_within of freezing ? -2 : 2.2) + sum of evidence
///
/// A touch so recognised is over when r falls below touch/2, and t begins anew. t is the time since freezing,
/// up to 64 s, and the evidence (sensing/evidence.hpp) smoothed over `weigh`. So a cell is frozen by a
/// contact, also one far below the threshold of a touch, and without evidence it stays so: `is_unexplained`
/// names it after 60 s.
///
/// **Rates.** x is linear between samples, or held and then linear over the last `ramp`; a step of any
/// duration is exact for the smoothing and, between changes of state, for b. Changes of state count within a
/// step.
///
/// **Numbers.** `whole`, in steps, is what `corrected` takes off: sums of corrected readings stay whole. The
/// rest of b is kept apart, below 0.75 steps: in float, at 1 kHz, b follows down to |r| = 6e-4 steps, after
/// any time. A reading that is NaN, infinite or beyond 2^20 steps changes nothing; nor does a step of 0 or
/// less. Evidence that is not finite or beyond +-100 counts as none.
///
/// Two faces of one rule: `take` for a cell at its own times, `scan` for rows of 16 cells at a common rate.
class RestLevel {
 public:
  /// The memory of a cell that is followed by `take`. `start` gives the first.
  template <Real T = float>
  struct Memory {
    RestCell<T> cell;
    T last = T(0);  ///< the last reading [steps]
    friend bool operator==(const Memory& a, const Memory& b) noexcept {
      return a.last == b.last && a.cell.above == b.cell.above && a.cell.whole == b.cell.whole &&
             a.cell.fraction == b.cell.fraction && a.cell.frozen == b.cell.frozen &&
             a.cell.below == b.cell.below && a.cell.evidence == b.cell.evidence;
    }
  };
  template <Real T>
  using Step = detail::RestStep<T>;

  /// Throws `ConfigurationError` for a time outside (0 s, 1 h], `max_gap` outside [50 ms, 10 s], `low_for` or
  /// `quiet_for` above 2 s, and unless `smooth <= fall <= release <= follow`.
  SKINCTL_COLD explicit RestLevel(const RestSettings& settings = {}) : s_(settings) {
    const auto time = [](Nanoseconds t, const char* name) {
      require(t > 0ns && t <= 1h, name, milliseconds(t), "> 0 ms, <= 1 h");
    };
    time(s_.smooth, "RestLevel: smooth"), time(s_.follow, "RestLevel: follow");
    time(s_.fall, "RestLevel: fall"), time(s_.low_for, "RestLevel: low_for");
    time(s_.quiet_for, "RestLevel: quiet_for"), time(s_.fast_within, "RestLevel: fast_within");
    time(s_.release, "RestLevel: release"), time(s_.weigh, "RestLevel: weigh"),
        time(s_.ramp, "RestLevel: ramp");
    require(s_.max_gap >= 50ms && s_.max_gap <= 10s, "RestLevel: max_gap", milliseconds(s_.max_gap),
            "50 ms to 10 s [ms]");
    require(s_.low_for <= 2s, "RestLevel: low_for", milliseconds(s_.low_for), "<= 2000 ms");
    require(s_.quiet_for <= 2s, "RestLevel: quiet_for", milliseconds(s_.quiet_for), "<= 2000 ms");
    require(s_.smooth <= s_.fall && s_.fall <= s_.release && s_.release <= s_.follow, "RestLevel: smooth",
            milliseconds(s_.smooth), "smooth <= fall <= release <= follow [ms]");
  }
  [[nodiscard]] const RestSettings& settings() const noexcept { return s_; }

  /// The level kappa [steps] of a cell whose single readings have the standard deviation `sigma` [steps] and
  /// come every `period`: four deviations of the smoothed reading, at least a step. Sensors that report at
  /// several rates take the slowest one's.
  [[nodiscard]] double freeze_level(double sigma, Nanoseconds period) const {
    require(sigma >= 0 && sigma <= 1e4, "RestLevel: sigma", sigma, "0 to 1e4 steps");
    require(period > 0ns && period <= s_.max_gap, "RestLevel: period", milliseconds(period),
            "> 0 ms, <= max_gap");
    // Independent readings, linear in between, behind a first-order filter.
    const Smoothed m = smoothed(seconds<double>(period));
    const double a = m.begin, b = m.end, e = 1 - a - b;
    const double kappa = 4 * sigma * std::sqrt((a * a + b * b + 2 * e * a * b) / (1 - e * e));
    return kappa > 1 ? kappa : 1;
  }
  /// The memory of a cell with the rest level `rest` [steps], as measured while it was untouched. Not finite:
  /// 0.
  template <Real T = float>
  [[nodiscard]] Memory<T> start(const T& rest) const noexcept {
    Memory<T> memory;
    const T b = detail::magnitude(rest) <= T(detail::max_steps) ? rest : T(0);
    memory.cell.whole = detail::nearest_whole(b);
    memory.cell.fraction = b - memory.cell.whole;
    memory.last = b;
    return memory;
  }

  /// Takes the reading `x` [steps] that came `dt` after the last one, of a sensor that sends changes: the old
  /// reading is held up to `ramp` before the new one. (A sensor that sends every period: `ramp` >= period.)
  ///
  /// @param evidence  sum of the sources during the time since the last reading, so of what was known then;
  ///                  positive says drift.
  template <Real T>
  void take(Memory<T>& memory, const T& x, Nanoseconds dt, const T& evidence,
            const RestLevels& levels) const noexcept {
    if (!(dt > 0ns) || !(detail::magnitude(x) <= T(detail::max_steps))) return;
    const Nanoseconds whole = dt < s_.max_gap ? dt : s_.max_gap,
                      held = whole > s_.ramp ? whole - s_.ramp : 0ns;
    move(memory.cell, memory.last, memory.last, held, evidence, levels);
    move(memory.cell, memory.last, x, whole - held, evidence, levels);
    memory.last = x;
  }

  /// A step for `scan`, computed once for all rows: nothing for `dt` <= 0, at most `max_gap`. One longer than
  /// 10 ms is done in pieces.
  template <Real T = float>
  [[nodiscard]] Step<T> step(Nanoseconds dt) const noexcept {
    Step<T> k;
    k.low_for = seconds<T>(s_.low_for), k.quiet_for = seconds<T>(s_.quiet_for);
    k.fast_within = seconds<T>(s_.fast_within);
    if (!(dt > 0ns)) return k;
    const Nanoseconds whole = dt < s_.max_gap ? dt : s_.max_gap;
    k.pieces = static_cast<int>((whole + longest_piece - 1ns) / longest_piece);
    k.per_piece = T(1) / static_cast<T>(k.pieces);
    const double t = seconds<double>(whole) / k.pieces;
    k.dt = T(t), k.per_dt = T(1 / t);
    const Smoothed m = smoothed(t);
    k.begin = T(m.begin), k.end = T(m.end), k.begin_mean = T(m.begin_mean), k.end_mean = T(m.end_mean);
    const auto share = [t](Nanoseconds tau) { return T(-std::expm1(-t / seconds<double>(tau))); };
    k.follow = share(s_.follow), k.fall = share(s_.fall), k.release = share(s_.release);
    k.smooth = share(s_.weigh);
    return k;
  }
  /// Moves 16 cells on by one step, over which their readings go linearly from `x0` to `x1` [steps]. A lane
  /// whose `x1` is NaN does not change: cells that were not heard. Its only branch: whether all cells of a
  /// register are calm.
  ///
  /// @param evidence  sums of evidence, one a cell.
  SKINCTL_INLINE static void scan(RestRow& row, const float* x0, const float* x1, const float* evidence,
                                  const RestLevelsRow& levels, const Step<float>& k) noexcept {
    if (!(k.dt > 0)) return;
    using L = Lane<float>;
    for (std::size_t i = 0; i < RestRow::cells; i += L::lanes) {
      RestCell<L> cell{L::load(row.above + i),  L::load(row.whole + i), L::load(row.fraction + i),
                       L::load(row.frozen + i), L::load(row.below + i), L::load(row.evidence + i)};
      detail::rest_steps<L>(cell, L::load(x0 + i), L::load(x1 + i), L::load(evidence + i),
                            L::load(levels.freeze + i), L::load(levels.touch + i), k);
      cell.above.store(row.above + i), cell.whole.store(row.whole + i), cell.fraction.store(row.fraction + i);
      cell.frozen.store(row.frozen + i), cell.below.store(row.below + i),
          cell.evidence.store(row.evidence + i);
    }
  }

  /// The cell in lane `i` of a row; `put` writes it back.
  [[nodiscard]] static RestCell<> cell(const RestRow& row, std::size_t i) noexcept {
    SKINCTL_EXPECTS(i < RestRow::cells, "a lane of the row");
    return {row.above[i], row.whole[i], row.fraction[i], row.frozen[i], row.below[i], row.evidence[i]};
  }
  static void put(RestRow& row, std::size_t i, const RestCell<>& c) noexcept {
    SKINCTL_EXPECTS(i < RestRow::cells, "a lane of the row");
    row.above[i] = c.above, row.whole[i] = c.whole, row.fraction[i] = c.fraction;
    row.frozen[i] = c.frozen, row.below[i] = c.below, row.evidence[i] = c.evidence;
  }

 private:
  /// Shares of the readings at the beginning and end of a step by which m moves, and its mean over the step.
  struct Smoothed {
    double begin, end, begin_mean, end_mean;
  };
  /// Exact for a reading linear in time: u = t/smooth, E = exp(-u), g = (1 - E)/u; m moves by (g - E) d0 +
  /// (1 - g) d1. Series where these cancel.
  [[nodiscard]] Smoothed smoothed(double t) const noexcept {
    const double u = t / seconds<double>(s_.smooth);
    if (u < 1e-3)
      return {u * (1.0 / 2 - u * (1.0 / 3 - u / 8)), u * (1.0 / 2 - u * (1.0 / 6 - u / 24)),
              u * (1.0 / 3 - u / 8), u * (1.0 / 6 - u / 24)};
    const double E = std::exp(-u), g = -std::expm1(-u) / u;
    return {g - E, 1 - g, 0.5 - (g - E) / u, 0.5 - (1 - g) / u};
  }
  template <Real T>
  void move(RestCell<T>& cell, const T& x0, const T& x1, Nanoseconds dt, const T& evidence,
            const RestLevels& levels) const noexcept {
    if (dt > 0ns)
      detail::rest_steps<T>(cell, x0, x1, evidence, T(levels.freeze), T(levels.touch), step<T>(dt));
  }

  static constexpr Nanoseconds longest_piece = 10ms;
  RestSettings s_;
};

/// A reading less its rest level, both in steps; 0 below it.
template <Real T>
[[nodiscard]] SKINCTL_INLINE constexpr T corrected(const T& reading, const RestCell<T>& cell) noexcept {
  const T r = reading - cell.whole;
  return r > T(0) ? r : T(0);
}
/// Whether a cell has been frozen for 60 s or more, is not being released, and nothing says that it is
/// touched: a drift that nobody could tell from a contact, or a contact that nobody else sees. To be named in
/// a report.
template <Real T>
[[nodiscard]] constexpr bool is_unexplained(const RestCell<T>& cell) noexcept {
  return (cell.frozen >= T(60) || cell.frozen <= T(-60)) && !(cell.below < T(0)) && cell.evidence > T(-1);
}

SKINCTL_END_NAMESPACE
