// The joints of a virtual robot: observer of the real ones, limits, commands.
#pragma once

#include "skinctl/core/measurement.hpp"
#include "skinctl/resolver/detail/parameters.hpp"
#include "skinctl/resolver/interval.hpp"
#include "skinctl/resolver/memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// How long the gap of commands that have not moved yet is learnt [s].
inline constexpr double settling_time = 2;

/// The resolver's treatment of joints that take positions or velocities, without the laws: the observer with
/// the declared delay and lag, limits and max lead, the modes, the command. It has no model, so that it
/// serves a part of a robot's joints while the others take torques.
template <Interface I, std::size_t N, Real T, std::size_t History>
class VirtualJoints {
  static_assert(I != Interface::torque, "a joint that takes torques has no virtual state");

 public:
  using Memory = VirtualJointsMemory<N, T, History>;
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
    bool lags = false;  ///< it follows later than declared: the correction holds the virtual one back
    struct Speed {
      Velocity least, most;
    };
    struct Free {};
    [[no_unique_address]] std::conditional_t<I == Interface::velocity, Speed, Free>
        speed;  ///< of the command
  };
  /// The begin of a cycle.
  struct Begun {
    Correction correction;
    Velocity before;  ///< the rate of the joints at its begin [rad/s]
    T dt;             ///< its interval [s]
    Status status;
  };

  SKINCTL_COLD explicit VirtualJoints(const RobotConfiguration<N, T>& c) : p_(c), servo_(p_.delay, p_.lag) {
    require(p_.delay / p_.period + 2 <= static_cast<std::int64_t>(History), "delay / period",
            milliseconds(p_.delay) / milliseconds(p_.period), "<= History - 2: commands under way");
  }
  [[nodiscard]] SKINCTL_INLINE const ResolverParameters<N, T>& parameters() const noexcept { return p_; }
  [[nodiscard]] SKINCTL_INLINE const JointServo<N, T, History>& servo() const noexcept { return servo_; }

  [[nodiscard]] SKINCTL_COLD Memory start(const State<N, T>& measured) const noexcept;
  /// The same from the position that the robot was told; a gap to the measured one is agreed to.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<N, T>& measured, const Position& told) const noexcept;

  /// Begins a cycle: takes the measurement and computes the correction for the sub-steps.
  template <class Check = AnyState>
  SKINCTL_INLINE Begun begin(Memory& m, const State<N, T>& measured, const Interval& interval,
                             const Check& check = {}) const noexcept;
  /// One sub-step towards the velocity `v1` (ignored where the mode is another than `following`).
  SKINCTL_INLINE Status move(Memory& m, const Correction& c, const Velocity& v1, const T& h) const noexcept;
  /// Lets a blocked robot follow again if it may; `net` is the torque of its laws at rest, less gravity.
  SKINCTL_COLD void try_to_leave(Memory& m, const Correction& c, const Torque& net) const noexcept;
  /// Ends a cycle: computes `command`, which is sent.
  SKINCTL_INLINE Status end(Memory& m, const Begun& begun, const Torque& torque) const noexcept;

  /// The user agrees to go on. A displaced robot follows again from where it stands: the residual becomes the
  /// gap, if it is at most `largest_gap`; otherwise it stays displaced.
  SKINCTL_COLD void resume(Memory& m) const noexcept;

  /// See `Resolver::stops_or_corrects`.
  [[nodiscard]] static SKINCTL_INLINE bool stops_or_corrects(const Memory& m) noexcept {
    bool any = m.mode != ResolverMode::following || m.rate != m.v;
    for (const T& t : m.off_for) any = any || t > T(0);
    return any;
  }

  /// `command` was sent instead of the last one.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<N, T>& command) const noexcept;

 private:
  template <class Check>
  SKINCTL_INLINE Status measure(Memory& m, const State<N, T>& measured, Nanoseconds now,
                                const Check& check) const noexcept;
  /// The gap of a robot whose commands have not moved yet.
  SKINCTL_COLD void settle(Memory& m, const T& dt) const noexcept;
  SKINCTL_INLINE Correction correct(Memory& m, Nanoseconds now, const T& dt) const noexcept;
  /// A clock that leapt, or was set.
  SKINCTL_COLD void set_clock(Memory& m, const Interval& interval) const noexcept;
  /// Judges the residuals `r` that are outside of the dead band, by `rho`, and bounds the correction.
  SKINCTL_COLD void watch(Memory& m, Correction& c, const Position& r, Position rho,
                          const T& dt) const noexcept;
  /// Dead band and slack together stay within two thirds of the max lead.
  [[nodiscard]] T most_slack(std::size_t i) const noexcept {
    const T room = T(2) / T(3) * p_.max_lead[i] - p_.dead_band[i];
    return room > T(0) ? room : T(0);
  }
  /// Leaves out what friction explains: the dead band is wider by the slack that joints have shown.
  SKINCTL_COLD void spare_slack(Memory& m, Correction& c, const Position& r, Position& rho,
                                const T& dt) const noexcept;
  SKINCTL_INLINE void choose_mode(Memory& m, const Correction& c, bool stale) const noexcept;
  SKINCTL_INLINE Status shift(Memory& m, const Correction& c, const Velocity& rate, bool off,
                              const Velocity& v1, const T& h) const noexcept;
  SKINCTL_COLD Velocity way_back(const Memory& m, const T& h) const noexcept;
  SKINCTL_NOINLINE Status follow(Memory& m, const Velocity& before, const T& dt) const noexcept;
  /// How far a position command may be from the last one.
  SKINCTL_INLINE bool is_near(const Row& moved) const noexcept {
    return all(magnitude(moved) <= p_.cycle * Row(p_.limits.velocity()));
  }
  SKINCTL_INLINE Status publish(Memory& m, const Correction& c, const Velocity& before, const Torque& torque,
                                const T& dt) const noexcept;

  ResolverParameters<N, T> p_;
  JointServo<N, T, History> servo_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE

#include "skinctl/resolver/detail/virtual_joints_loop.hpp"
#include "skinctl/resolver/detail/virtual_joints_observer.hpp"
