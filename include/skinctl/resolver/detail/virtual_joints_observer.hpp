// The observer of a virtual robot's joints: does the real robot follow?
#pragma once

#include "skinctl/core/measurement.hpp"
#include "skinctl/resolver/detail/parameters.hpp"
#include "skinctl/resolver/memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The part of `VirtualJoints` that compares the measured position with the expected one: the correction, and the
/// mode.
template <Interface I, std::size_t N, Real T, std::size_t History>
class VirtualJointsObserver {
  static_assert(has_servo<I>, "a joint that takes torques has no virtual state");

 public:
  using Servo = ServoOf<I, N, T, History>;
  using Memory = VirtualJointsMemory<N, T, History, typename Servo::Memory>;
  using Position = JointPosition<N, T>;
  using Velocity = JointVelocity<N, T>;
  using Torque = JointTorque<N, T>;
  using Row = detail::Row<N, T>;
  /// A cycle's measurement as correction for its sub-steps.
  struct Correction {
    Velocity rate;                 ///< L1 rho (+ drift r)
    JointAcceleration<N, T> pull;  ///< L2 rho
    bool off = false;              ///< rho is not zero
    bool gap = false;              ///< the robot stands beside its commands
    bool lags = false;  ///< whether it follows later than declared: the correction holds the virtual one back
    struct Speed {
      Velocity least, most;
    };
    struct Free {};
    [[no_unique_address]] std::conditional_t<takes_velocity(I), Speed, Free> speed;  ///< of the command
  };

  SKINCTL_COLD explicit VirtualJointsObserver(const RobotConfiguration<N, T>& c) : p_(c), servo_(c) {
    require(p_.delay / p_.period + 2 <= static_cast<std::int64_t>(History), "delay / period",
            milliseconds(p_.delay) / milliseconds(p_.period), "<= History - 2: commands under way");
  }
  [[nodiscard]] SKINCTL_INLINE const ResolverParameters<N, T>& parameters() const noexcept { return p_; }
  [[nodiscard]] SKINCTL_INLINE const Servo& servo() const noexcept { return servo_; }
  /// Lets a blocked robot follow again if it may; `net` is the torque of its laws at rest, less gravity.
  SKINCTL_COLD void try_to_leave(Memory& m, const Correction& c, const Torque& net) const noexcept {
    bool here = true, moved_on = false;
    T push(0), scale(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T e = m.q.value[i] - m.measured.q[i];
      T& slack = m.watch[i].slack;
      const T near = p_.dead_band[i] + slack;
      here &= e <= near && -e <= near;
      // What lets it go where it was pushed to is no obstacle.
      if (T(m.pushed[i]) * (m.measured.q[i] - m.back[i]) > T(0.1) * p_.dead_band[i]) moved_on = true;
      push = push + T(m.pushed[i]) * net[i];
      scale = scale + p_.limits.torque()[i];
    }
    const bool released = moved_on || !(push > T(1e-4) * scale);
    if (here && !c.off && m.mode_for >= p_.total_delay && (released || m.mode_for >= p_.retry)) {
      m.mode = ResolverMode::following;
      m.mode_for = T(0);
      // Friction that holds a joint gives way to more; an obstacle is met again.
      for (std::size_t i = 0; i < N; ++i) {
        if (m.pushed[i] == 0 || !(push > T(1e-4) * scale)) continue;
        T& slack = m.watch[i].slack;
        const T more = slack + T(0.5) * p_.dead_band[i], most = max_slack(i);
        slack = more < most ? more : most;
        m.watched = true;
      }
    } else if (!here && m.mode_for >= p_.retry) {
      for (std::size_t i = 0; i < N; ++i) m.back[i] = m.off_for[i] > T(0) ? m.measured.q[i] : m.back[i];
      m.mode_for = T(0);
    }
  }

 protected:
  /// Takes the measurement, and compares it with where the joints are due.
  ///
  /// @param pushed  joint torque of the contacts felt [N m].
  template <class Check>
  SKINCTL_INLINE Status measure(Memory& m, const State<N, T>& measured, Nanoseconds now, const Check& check,
                                const Torque& pushed) const noexcept {
    const State<N, T> taken{measured.time, Position(Row(measured.q) - m.gap), measured.dq};
    Status status = take_measurement(m.measured, taken, now, check);
    [[maybe_unused]] const Row before = m.under_way.reached;
    [[maybe_unused]] const bool taken_now = !status.any();
    const Position& expected = servo_.due(m.under_way, m.measured.time, pushed);
    if constexpr (takes_position(I)) (Row(m.told) * p_.forgets + magnitude(expected - before)).store(m.told);
    Row residual = Row(m.measured.q) - expected;
    if constexpr (Servo::gives_way) {
      // Laws, leads and modes compare with a robot that nothing pushes.
      const Row deflection = m.under_way.deflection;
      if (taken_now) (Row(m.measured.q) - deflection).store(m.measured.q);
      residual = Row(m.measured.q) - (Row(expected) - deflection);
    }
    if constexpr (takes_velocity(I)) residual = residual - m.offset.value;
    residual.store(m.residual);
    if (now - m.measured.time > p_.stale_after) status |= Reason::state_stale;
    return status;
  }
  SKINCTL_INLINE Correction correct(Memory& m, Nanoseconds now, const T& dt) const noexcept {
    const bool fresh = now - m.measured.time <= p_.fresh_for;
    if constexpr (takes_position(I))
      if (fresh && m.settles_for > T(0)) [[unlikely]]
        settle(m, dt);
    // An old measurement does not show the present position of the robot: its residual is not used again.
    const Row r = fresh ? Row(m.residual) : Row(T(0)), dead_band = p_.dead_band;
    const Row rho = r - clamp(r, -dead_band, dead_band);
    const auto off = rho != Row(T(0));
    if (fresh) select(off, Row(m.off_for) + dt, T(0)).store(m.off_for);
    Correction c{Velocity(p_.L1 * rho), JointAcceleration<N, T>(p_.L2 * rho), any(off), false, false, {}};
    if (c.off || m.watched) [[unlikely]]
      watch(m, c, Position(r), Position(rho), dt);
    if constexpr (takes_position(I)) {
      if (fresh) {
        const Row slow = m.slow_residual;
        (slow + T(dt / (p_.settle + dt)) * (r - slow)).store(m.slow_residual);
      }
    }
    if constexpr (takes_velocity(I)) {
      c.rate = Velocity(Row(c.rate) + p_.drift * r);
      // What a robot lags behind beyond its declared delay is still to come.
      const Position late(clamp(r, -dead_band, dead_band));
      for (std::size_t i = 0; i < N; ++i) {
        // Position of the real robot when it has carried out all commands sent up to now.
        const T arrives = m.measured.q[i] + (m.sent.value[i] - m.under_way.reached[i]), more = late[i];
        const T brake = p_.limits.acceleration()[i] * braking_share<T>;
        const T reaction = seconds<T>(p_.longest_interval);
        const T above = p_.limits.upper()[i] - arrives, below = arrives - p_.limits.lower()[i];
        c.speed.most[i] = speed_to_stop(more < T(0) ? T(above + more) : above, reaction, brake);
        c.speed.least[i] = -speed_to_stop(more > T(0) ? T(below - more) : below, reaction, brake);
      }
    }
    return c;
  }
  /// The gap of a robot whose commands have not moved yet.
  /// No obstacle is in the way of commands that stand still from the beginning: what the robot stands beside them is its
  /// gap. A dead band that held it would be missing for lag later.
  SKINCTL_COLD void settle(Memory& m, const T& dt) const noexcept {
    const T still = T(1e-3);  // [rad/s]
    bool rests = m.mode == ResolverMode::following && all(magnitude(Row(m.rate)) <= Row(still)) &&
                 all(magnitude(Row(m.residual)) <= Row(p_.dead_band));
    // What a push deflects, and is told a little wrong, is no gap.
    if constexpr (Servo::gives_way)
      rests = rests && all(magnitude(Row(m.under_way.deflection)) <= T(0.1) * Row(p_.dead_band));
    m.settles_for = rests ? T(m.settles_for - dt) : T(0);
    if (!rests) return;
    const Row most = p_.largest_gap, before = m.gap;
    const Row gap = clamp(before + T(dt / (p_.settle + dt)) * Row(m.residual), -most, most),
              taken = gap - before;
    gap.store(m.gap);
    (Row(m.measured.q) - taken).store(m.measured.q);
    (Row(m.residual) - taken).store(m.residual);
  }
  /// Judges the residuals `r` that are outside of the dead band, by `rho`, and bounds the correction.
  /// Three robots have a residual that stays. One that is blocked stands still, and its residual shrinks as the
  /// virtual robot comes back. One that lags moves with the commands, against the correction. One that stands beside
  /// its commands by a gap (a servo that droops, an encoder with an offset) is carried along by the correction, and
  /// would be followed for ever: therefore a correction moves the virtual robot by half of the residual at most,
  /// plus that by which it has shrunk.
  SKINCTL_COLD void watch(Memory& m, Correction& c, const Position& r, Position rho,
                          const T& dt) const noexcept {
    spare_slack(m, c, r, rho, dt);
    m.watched = false;
    for (std::size_t i = 0; i < N; ++i) {
      auto& w = m.watch[i];
      if (rho[i] == T(0)) {
        // A lag that hides a gap for some cycles does not end its observation.
        const T near = r[i] < T(0) ? T(-r[i]) : r[i];
        if (near < T(0.5) * p_.dead_band[i]) w.size = T(0);
        m.watched = m.watched || w.size > T(0) || w.slack > T(0);
        continue;
      }
      m.watched = true;
      const T side = rho[i] < T(0) ? T(-1) : T(1), far = side * r[i];
      const auto begin = [&] {
        w.size = far;
        w.side = side;
        w.robot = m.measured.q[i];
        w.told = m.under_way.reached[i];
        w.joint = m.q.value[i];
      };
      if (w.size == T(0) || w.side != side) {
        // Beyond any lead at once; or beside commands that have hardly moved while it came to be there.
        const T came = r[i] - m.slow_residual[i];
        c.gap = c.gap || far > p_.max_lead[i] ||
                (takes_position(I) && m.told[i] < T(0.5) * (came < T(0) ? T(-came) : came));
        begin();
      }
      const T moved = side * (m.measured.q[i] - w.robot);
      if (far > w.size) w.size = far;
      // No obstacle lets it move with its commands: friction of a servo that gives way holds it back.
      const T most = max_slack(i), shown = far - p_.dead_band[i];
      if (moved <= T(-0.1) * w.size && shown > w.slack && most > w.slack) {
        const T next = shown + T(0.25) * p_.dead_band[i];
        w.slack = next < most ? next : most;
        begin();
        m.off_for[i] = T(0);
        c.lags = true;
      }
      // It lags, and moves with commands that go against the correction: a good way, or all of it for a while.
      const T told = side * (m.under_way.reached[i] - w.told);
      if (moved <= T(-0.5) * w.size ||
          (m.off_for[i] >= T(4) * p_.total_delay && told <= T(-0.05) * w.size && moved <= T(0.5) * told)) {
        begin();
        m.off_for[i] = T(0);
        c.lags = true;
      }
      if constexpr (takes_position(I)) {
        c.gap = c.gap || (moved >= T(0.4) * w.size && far > T(0.7) * w.size);
        const T way = side * (m.q.value[i] - w.joint);
        if (way < T(0)) w.joint = m.q.value[i];
        const T left = T(0.5) * w.size + (w.size - far) - (way < T(0) ? T(0) : way);
        const T fastest = speed_to_stop(left, dt, T(T(0.5) * p_.limits.acceleration()[i])),
                rate = side * c.rate[i];
        if (rate > fastest) {
          c.pull[i] = c.pull[i] * (fastest / rate);
          c.rate[i] = side * fastest;
        }
        w.most = fastest;
      }
    }
  }
  /// Leaves out what friction explains: the dead band is wider by the slack that joints have shown.
  /// Slack is forgotten within minutes, so that an elastic obstacle does not count for ever.
  SKINCTL_COLD void spare_slack(Memory& m, Correction& c, const Position& r, Position& rho,
                                const T& dt) const noexcept {
    constexpr double kept = 60;  // [s]
    bool any_slack = false;
    for (std::size_t i = 0; i < N; ++i) {
      auto& w = m.watch[i];
      if (w.slack == T(0)) continue;
      any_slack = true;
      w.slack = w.slack > T(1e-6) ? T(w.slack - T(dt / T(kept)) * w.slack) : T(0);
      const T most = p_.dead_band[i] + w.slack;
      rho[i] = r[i] > most ? T(r[i] - most) : (r[i] < -most ? T(r[i] + most) : T(0));
      if (rho[i] == T(0)) m.off_for[i] = T(0);
    }
    if (!any_slack) return;
    c.rate = Velocity(p_.L1 * Row(rho));
    c.pull = JointAcceleration<N, T>(p_.L2 * Row(rho));
    c.off = any(Row(rho) != Row(T(0)));
  }
  SKINCTL_INLINE void choose_mode(Memory& m, const Correction& c, bool stale) const noexcept {
    const auto enter = [&](ResolverMode mode) {
      if (m.mode == mode) return;
      m.mode = mode;
      m.mode_for = T(0);
    };
    const bool stuck = c.off && any(Row(m.off_for) >= Row(T(5) * p_.total_delay));
    if (c.gap) {
      enter(ResolverMode::displaced);
    } else if (m.mode == ResolverMode::displaced) {
      return;
    } else if (stale) {
      enter(ResolverMode::braking);
    } else if (m.mode != ResolverMode::blocked && stuck) {
      enter(ResolverMode::blocked);
      for (std::size_t i = 0; i < N; ++i) m.back[i] = m.off_for[i] > T(0) ? m.measured.q[i] : m.q.value[i];
      if constexpr (takes_position(I)) m.v = m.v * T(0);
      for (std::size_t i = 0; i < N; ++i) m.pushed[i] = c.pull[i] < T(0) ? 1 : (c.pull[i] > T(0) ? -1 : 0);
    } else if (m.mode != ResolverMode::blocked) {
      enter(m.stop ? ResolverMode::braking : ResolverMode::following);
    }
  }
  /// Dead band and slack together stay within two thirds of the max lead.
  [[nodiscard]] T max_slack(std::size_t i) const noexcept {
    const T room = T(2) / T(3) * p_.max_lead[i] - p_.dead_band[i];
    return room > T(0) ? room : T(0);
  }

  ResolverParameters<N, T> p_;
  Servo servo_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
