// What a resolver has to be told: the robot's delay, the virtual robot's shape, its limits.
#pragma once

#include <optional>

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/resolver/integrator.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Everything about a resolver that does not change while it runs. Plain numbers: a resolver checks them when
/// it is built from them.
template <std::size_t N, Real T = double>
struct ResolverConfiguration {
  JointLimits<N, T> limits;
  /// Time between two cycles as planned [ns].
  Nanoseconds period;
  /// T_d: from sending a command until the robot begins to move, plus the age of a measurement when it is
  /// stamped [ns].
  Nanoseconds delay = 0;
  /// tau: time constant of the robot's own control loop [s].
  T lag = T(0);
  /// r_tol: how far a robot that follows may be from where its commands bring it [rad]. At least three times
  /// the encoder's standard deviation plus the top speed times the uncertainty of the delay.
  JointPosition<N, T> dead_band = JointPosition<N, T>::constant(T(0.01));
  /// w [1/s], at most 0.3/T with T = delay + lag + period: the default.
  std::optional<T> observer = {};
  /// Sends where the virtual robot will be after this time [s] at its present velocity (velocities alike):
  /// makes up for the robot's delay, at the price of passing on every change of torque at once. 0 to T;
  /// `delay + lag + period / 2` makes up for all of it; `period / 2` for that a robot holds a position until
  /// the next one comes.
  T lead = T(0);
  /// Velocity interface only: rate at which the virtual robot's position drifts to the real one's without
  /// moving it [1/s], at most w. Default: 1, or w if that is less.
  std::optional<T> drift = {};
  /// e_max in units of v_max T: the virtual robot's greatest lead over the real one. Less than `1 + v_max/(2
  /// a T)` lowers the top speed, see `Resolver::top_speed`.
  T leash = T(2);
  /// Friction and inertia of the virtual robot besides its model's.
  VirtualShape<N, T> shape = {};
  /// Longest sub-step [ns]; up to `max_substeps` of equal length make an interval.
  Nanoseconds substep = 2_ms;
  /// Longest interval that is integrated at once [ns]; what is longer is dropped. Default: five periods. The
  /// velocity interface keeps room for this time at the present speed before every position limit.
  std::optional<Nanoseconds> longest_interval = {};
  /// Age of the last good measurement from which on the virtual robot brakes [ns]. Default: 5 T.
  std::optional<Nanoseconds> stale_after = {};
  /// A blocked robot that is still pushed the same way tries again after this time [s].
  T retry = T(1);
};

/// Most sub-steps of one interval.
inline constexpr unsigned max_substeps = 16;

/// A part of time that a cycle integrates: `(from, to]` in equal sub-steps.
struct Interval {
  Nanoseconds from = 0;
  Nanoseconds to = 0;
  unsigned substeps = 0;
  Status status;

  /// Where sub-step `j` begins; `at(substeps)` is the end.
  [[nodiscard]] constexpr Nanoseconds at(unsigned j) const noexcept {
    return substeps == 0 ? to
                         : from + (to - from) / substeps * j +
                               (to - from) % substeps * static_cast<Nanoseconds>(j) / substeps;
  }
};

namespace detail {

/// What has to be integrated at `now` after `last`; no sub-steps yet.
[[nodiscard]] SKINCTL_INLINE Interval interval_since(bool started, Nanoseconds last, Nanoseconds now,
                                                     Nanoseconds longest) noexcept {
  if (!started) return {0, 0, 0, Reason::interval_empty};
  if (now == last) return {last, last, 0, Reason::interval_empty};
  if (now < last || !is_plausible(now)) return {last, last, 0, Reason::time_backwards};
  if (now - last > longest) return {now - longest, now, 0, Reason::interval_too_long};
  return {last, now, 0, {}};
}

/// The configuration, checked and completed.
template <std::size_t N, Real T>
struct ResolverParameters {
  JointLimits<N, T> limits;
  VirtualShape<N, T> shape;
  JointPosition<N, T> dead_band;
  JointPosition<N, T> leash;  ///< e_max
  Nanoseconds period, delay, substep, longest_interval, stale_after;
  Nanoseconds fresh_for;  ///< age up to which a measurement's difference is acted on
  T lag, total_delay, per_delay, L1, L2, lead, drift, retry, catch_up;
  bool has_coulomb = false;

  [[nodiscard]] T planned_step() const noexcept {
    const auto steps = (period + substep - 1) / substep;
    return seconds<T>(period) / T(steps < max_substeps ? static_cast<int>(steps) : int(max_substeps));
  }

  SKINCTL_COLD explicit ResolverParameters(const ResolverConfiguration<N, T>& c)
      : limits(c.limits),
        shape(c.shape),
        dead_band(c.dead_band),
        period(c.period),
        delay(c.delay),
        substep(c.substep),
        lag(c.lag),
        lead(c.lead),
        retry(c.retry) {
    const auto number = [](const auto& x) { return static_cast<double>(x); };
    require(period >= 100_us && period <= 1_s, "period [ns]", number(period), "1e5 to 1e9 ns");
    require(delay >= 0 && delay <= 1_s, "delay [ns]", number(delay), "0 to 1e9 ns");
    require(lag >= T(0) && lag <= T(1), "lag", number(lag), "0 to 1 s");
    require(substep >= 10_us && substep <= 20_ms, "sub-step [ns]", number(substep), "1e4 to 2e7 ns");
    total_delay = seconds<T>(delay) + lag + seconds<T>(period);
    per_delay = T(1) / total_delay;
    fresh_for = nanoseconds(number(total_delay)) + period / 2;
    const T most = T(0.3) / total_delay;
    const T w = c.observer.value_or(most);
    require(w > T(0) && w <= most * (T(1) + tolerance<T>), "observer w", number(w),
            "> 0, <= 0.3/(delay + lag + period) 1/s");
    L1 = T(2) * w;
    L2 = w * w;
    catch_up = T(0.25) / seconds<T>(period);
    require(lead >= T(0) && lead <= total_delay, "lead", number(lead), ">= 0, <= delay + lag + period s");
    drift = c.drift.value_or(w < T(1) ? w : T(1));
    require(drift >= T(0) && drift <= w, "drift", number(drift), ">= 0, <= w 1/s");
    require(c.leash >= T(1.2) && c.leash <= T(100), "leash", number(c.leash), "1.2 to 100 v_max T");
    require(retry > T(0) && retry <= T(3600), "retry", number(retry), "> 0, <= 3600 s");
    longest_interval = c.longest_interval.value_or(5 * period);
    require(longest_interval >= period && longest_interval <= 1_s + 10 * period, "longest interval [ns]",
            number(longest_interval), ">= period, <= 1 s + 10 periods");
    stale_after = c.stale_after.value_or(nanoseconds(5 * number(total_delay)));
    require(stale_after >= period && stale_after <= 10_s, "stale after [ns]", number(stale_after),
            ">= period, <= 1e10 ns");
    require(shape.decay >= T(0) && shape.decay <= T(1e4), "decay", number(shape.decay), "0 to 1e4 1/s");
    for (std::size_t i = 0; i < N; ++i) {
      require(dead_band[i] > T(0) && dead_band[i] <= T(1), "dead band", number(dead_band[i]),
              "> 0, <= 1 rad");
      require(shape.viscous[i] >= T(0) && shape.viscous[i] <= T(1e6), "viscous friction",
              number(shape.viscous[i]), "0 to 1e6 N m s/rad");
      require(shape.coulomb[i] >= T(0) && shape.coulomb[i] <= T(1e6), "Coulomb friction",
              number(shape.coulomb[i]), "0 to 1e6 N m");
      require(shape.inertia[i] >= T(0) && shape.inertia[i] <= T(1e6), "added inertia",
              number(shape.inertia[i]), "0 to 1e6 kg m^2");
      has_coulomb = has_coulomb || shape.coulomb[i] > T(0);
      leash[i] = c.leash * limits.velocity()[i] * total_delay;
      require(leash[i] > dead_band[i], "dead band", number(dead_band[i]),
              "below the leash (leash v_max T): a blocked robot must be noticed");
    }
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
