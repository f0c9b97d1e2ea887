// SPDX-License-Identifier: BSD-3-Clause
// Does a robot follow as declared? Its lag and gap, estimated all the time from commands and measurements.
#pragma once

#include <cmath>
#include <limits>

#include "skinctl/resolver/memory.hpp"
#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The lag and gap of a robot, compared with its description.
template <std::size_t N, Real T = double>
struct Following {
  T lag = T(0);                       ///< lag beyond the declared delay and lag together [s]
  T lag_deviation = T(0);             ///< standard deviation of `lag` [s]; infinite without motion
  JointPosition<N, T> gap;            ///< measured minus commanded position of a robot at rest [rad]
  JointPosition<N, T> gap_deviation;  ///< standard deviation of `gap` [rad]
  T observed = T(0);                  ///< total time of the cycles that count [s]
};

/// Estimates lag and gap of a robot by position or velocity while it works: the line `r = gap - lag u`
/// through the residuals r of the resolver and the measured velocities u of the joints, by least squares with
/// a forgetting time. Of a lag of first order that is exact, of a delay d at the frequency w it is
/// `sin(w d)/w`. It reports, and proposes a configuration; it does not steer.
///
/// Only a robot that follows counts: cycles in which a joint is beside its commands by more than the dead
/// band and does not move with them are left out, and so are those up to ten total delays before, in which it
/// may have met an obstacle already. A lag of which the robot shows nothing (it does not move) is not known:
/// `lag_deviation` says so.
///
/// ```
/// const FollowingMonitor monitor(arm.configuration());
/// ...                                            // in the loop, after the cycle
/// monitor.step(watched, memory.robot.group());
/// ```
template <std::size_t N, Real T = double>
class FollowingMonitor {
  /// Sums over time of one joint, weighted with the length of the cycle.
  struct Sums {
    T r = T(0), u = T(0), rr = T(0), ru = T(0), uu = T(0);
    SKINCTL_INLINE void add(const Sums& b) noexcept {
      r = r + b.r, u = u + b.u, rr = rr + b.rr, ru = ru + b.ru, uu = uu + b.uu;
    }
    SKINCTL_INLINE void scale(const T& s) noexcept {
      r = s * r, u = s * u, rr = s * rr, ru = s * ru, uu = s * uu;
    }
  };
  struct Part {
    T time = T(0);
    Sums joint[N];
    SKINCTL_INLINE void add(const Part& b) noexcept {
      time = time + b.time;
      for (std::size_t i = 0; i < N; ++i) joint[i].add(b.joint[i]);
    }
  };

 public:
  /// Default time constant of forgetting, in which an arm makes several motions.
  static constexpr Nanoseconds default_forgetting = 30s;
  /// Deviation of a lag that is good enough to declare it: a sub-step.
  static constexpr Nanoseconds default_certainty = 2ms;

  /// Trivially copyable.
  struct Memory {
    Part part[3];  ///< sums that count, and the two newest parts, which may still be refused
    JointPosition<N, T> expected, measured, residual;
    Nanoseconds time{};
    T settling = T(0);     ///< time since the first cycle [s], up to 5 total delays
    bool follows = false;  ///< whether the robot followed in the last cycle
  };

  /// Throws `ConfigurationError` for a forgetting time out of its range.
  ///
  /// @param forgets  time constant of forgetting, 1 s to 1 h.
  SKINCTL_COLD explicit FollowingMonitor(const RobotConfiguration<N, T>& robot,
                                         Nanoseconds forgets = default_forgetting)
      : band_(robot.dead_band),
        part_(T(detail::settled_delays) * seconds<T>(robot.total_delay())),
        correlated_(seconds<T>(robot.total_delay())),
        forgets_(seconds<T>(forgets)),
        longest_(robot.longest()) {
    require(forgets >= 1s && forgets <= 3600s, "forgetting time", seconds<double>(forgets), "1 to 3600 s");
  }

  /// Takes the cycle that has just run; `robot` is the group's memory in that of the resolver.
  template <std::size_t History, class UnderWay>
  SKINCTL_INLINE void step(Memory& m,
                           const VirtualJointsMemory<N, T, History, UnderWay>& robot) const noexcept {
    const Nanoseconds passed = robot.measured.time - m.time;
    if (passed <= 0ns) return;  // nothing new was measured
    const JointPosition<N, T> expected = robot.measured.q - robot.residual;
    const T per_dt = T(1) / seconds<T>(passed), dt = seconds<T>(passed);
    bool follows = !robot.brakes && m.settling >= part_;
    if (m.settling < part_) m.settling = m.settling + dt;
    Part now;
    for (std::size_t i = 0; i < N; ++i) {
      const T u = per_dt * (robot.measured.q[i] - m.measured[i]),
              r = T(0.5) * (robot.residual[i] + m.residual[i]) + robot.gap[i];
      const T off = robot.residual[i] < T(0) ? T(-robot.residual[i]) : robot.residual[i];
      const T told = per_dt * (expected[i] - m.expected[i]);
      follows = follows && (off <= band_[i] || told * u > T(follows_from) * told * told);
      now.joint[i] = {dt * r, dt * u, dt * r * r, dt * r * u, dt * u * u};
    }
    if (!follows) {
      m.part[1] = m.part[2] = {};
    } else if (m.follows && passed <= longest_) {
      now.time = dt;
      m.part[2].add(now);
      if (m.part[2].time >= part_) close(m);
    }
    m.expected = expected;
    m.measured = robot.measured.q;
    m.residual = robot.residual;
    m.time = robot.measured.time;
    m.follows = follows;
  }

  /// The estimates from the cycles so far; deviations are infinite where too little is known.
  [[nodiscard]] SKINCTL_COLD Following<N, T> estimate(const Memory& m) const noexcept {
    using std::sqrt;
    const Part& all = m.part[0];
    const T inf = std::numeric_limits<T>::infinity();
    Following<N, T> out;
    out.observed = all.time;
    out.lag_deviation = inf;
    out.gap_deviation = JointPosition<N, T>::constant(inf);
    // Residuals within T of each other are one. No time, or too little for gaps and lag, is not known.
    const T freedom = T(N) * all.time / correlated_ - T(N + 1);
    if (!(freedom > T(0))) return out;
    const T per = T(1) / all.time;
    T uu(0), ru(0), rr(0);
    for (const Sums& s : all.joint) {
      uu = uu + (s.uu - per * s.u * s.u);
      ru = ru + (s.ru - per * s.r * s.u);
      rr = rr + (s.rr - per * s.r * s.r);
    }
    const bool moves = uu > T(moving) * T(N) * all.time;
    const T lag = moves ? T(-ru / uu) : T(0), left = rr + lag * ru;
    const T variance = (left > T(0) ? left : T(0)) * (T(1) / correlated_) / freedom;
    if (moves) {
      out.lag = lag;
      out.lag_deviation = sqrt(variance * correlated_ / uu);
    }
    for (std::size_t i = 0; i < N; ++i) {
      const T mean = per * all.joint[i].u;
      out.gap[i] = per * all.joint[i].r + lag * mean;
      const T by_lag = moves ? T(mean * mean * correlated_ / uu) : T(0);
      out.gap_deviation[i] = sqrt(variance * (correlated_ * per + by_lag));
    }
    return out;
  }

  /// The configuration with the lag that was found, if its deviation is at most `certain`; otherwise `now`. A
  /// negative lag is taken off the delay.
  [[nodiscard]] SKINCTL_COLD RobotConfiguration<N, T> proposed(
      const RobotConfiguration<N, T>& now, const Memory& m, Nanoseconds certain = default_certainty) const {
    const auto found = estimate(m);
    RobotConfiguration<N, T> out = now;
    if (!(found.lag_deviation <= seconds<T>(certain))) return out;
    Nanoseconds lag = now.lag + nanoseconds(static_cast<double>(found.lag));
    if (lag < 0ns) {
      out.delay = now.delay + lag > 0ns ? now.delay + lag : 0ns;
      lag = 0ns;
    }
    out.lag = lag;
    return out;
  }

 private:
  /// Share of the commanded speed from which on a joint outside of its dead band counts as following: one
  /// that lags has all of it after a while, one that is held has none but noise.
  static constexpr double follows_from = 0.25;
  /// Mean squared speed above the noise of encoders [rad^2/s^2]: 0.03 rad/s, 0.1 mrad in a cycle of 3 ms.
  static constexpr double moving = 1e-3;

  SKINCTL_COLD void close(Memory& m) const noexcept {
    Part& all = m.part[0];
    const T rest = forgets_ / (forgets_ + m.part[1].time);
    all.time = rest * all.time;
    for (Sums& s : all.joint) s.scale(rest);
    all.add(m.part[1]);
    m.part[1] = m.part[2];
    m.part[2] = {};
  }

  JointPosition<N, T> band_;
  T part_, correlated_, forgets_;
  Nanoseconds longest_;
};
template <std::size_t N, Real T, class... More>
FollowingMonitor(const RobotConfiguration<N, T>&, More...) -> FollowingMonitor<N, T>;

SKINCTL_END_NAMESPACE
