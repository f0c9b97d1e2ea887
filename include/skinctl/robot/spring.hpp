// SPDX-License-Identifier: BSD-3-Clause
// Joints that a joint-impedance controller holds: their servo gives way to what pushes them.
#pragma once

#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The servo of joints that are held by springs: `DelayLag` plus the deflection d by contacts,
/// `spring_lag * dd/dt = pushed / stiffness - d`. A push of 40 N m deflects 500 N m/rad by 80 mrad; one that
/// is told wrong by 20 % leaves a difference of 16 mrad, which belongs into the dead band.
///
/// Quasi-static: of the swing of the links on their springs no more than that time constant is predicted.
/// Without one a push that grows by p [N m/s] shows a difference of `p * damping / stiffness^2` meanwhile;
/// with it a push that comes at once shows a quarter of its deflection. A force that no sensor feels, as of a
/// payload that the robot was not told of, deflects unseen: it is a gap.
template <std::size_t N, Real T, std::size_t Capacity>
class Spring {
  using Commands = DelayLag<N, T, Capacity>;

 public:
  using Pushed = JointTorque<N, T>;
  static constexpr bool gives_way = true;
  /// Trivially copyable.
  struct Memory {
    typename Commands::Memory commands;
    JointPosition<N, T> deflection;  ///< deflection by contacts at the time of the last `due` [rad], [m]
    JointPosition<N, T> reached;     ///< position of the declared robot at the last `due` [rad], [m]
  };

  /// Throws `ConfigurationError` without a stiffness.
  SKINCTL_COLD explicit Spring(const RobotConfiguration<N, T>& c)
      : commands_(c.delay, seconds<T>(c.lag)),
        lag_(seconds<T>(c.spring_lag.value_or(c.lag))),
        max_torque_(c.limits.torque()) {
    if (!c.stiffness)
      refuse("skinctl: stiffness: left out, allowed: > 0, <= 1e6 N m/rad of each joint by impedance");
    for (std::size_t i = 0; i < N; ++i) compliance_[i] = T(1) / (*c.stiffness)[i];
  }

  /// Begins with a robot at `q` that has moved steadily at `dq`, untouched.
  [[nodiscard]] SKINCTL_INLINE Memory start(Nanoseconds time, const JointPosition<N, T>& q,
                                            const JointVelocity<N, T>& dq) const noexcept {
    return {commands_.start(time, q, dq), {}, q};
  }
  SKINCTL_INLINE void send(Memory& m, Nanoseconds time, const JointPosition<N, T>& value,
                           const JointVelocity<N, T>& slope) const noexcept {
    commands_.send(m.commands, time, value, slope);
  }
  SKINCTL_INLINE void correct(Memory& m, const JointPosition<N, T>& value,
                              const JointVelocity<N, T>& slope) const noexcept {
    commands_.correct(m.commands, value, slope);
  }
  SKINCTL_COLD void restart(Memory& m, Nanoseconds time) const noexcept {
    commands_.restart(m.commands, time);
  }

  /// Calls `f(position)` as `DelayLag` does: positions without the deflection by contacts.
  template <class F>
  SKINCTL_INLINE void each_under_way(const Memory& m, F&& f) const noexcept {
    commands_.each_under_way(m.commands, f);
  }

  /// Position of the declared robot at `until`; a time before that of the last call changes nothing.
  ///
  /// @param pushed  joint torque of the contacts felt [N m]: within the limits of torque, and not NaN, or it
  ///                counts as cut to them, or as the last one.
  SKINCTL_INLINE const JointPosition<N, T>& due(Memory& m, Nanoseconds until,
                                                const Pushed& pushed) const noexcept {
    using std::exp;
    const T dt = seconds<T>(until - m.commands.now);
    const auto& without = commands_.due(m.commands, until);
    if (dt > T(0)) {
      // Below a ten-thousandth of the step a lag cannot be told from none.
      const T decay = lag_ * T(1e4) > dt ? T(exp(-dt / lag_)) : T(0);
      for (std::size_t i = 0; i < N; ++i) {
        if (!(pushed[i] == pushed[i])) continue;
        const T most = max_torque_[i],
                torque = pushed[i] < -most ? -most : (pushed[i] > most ? most : pushed[i]);
        const T to = compliance_[i] * torque;
        m.deflection[i] = to + decay * (m.deflection[i] - to);
      }
    }
    for (std::size_t i = 0; i < N; ++i) m.reached[i] = without[i] + m.deflection[i];
    return m.reached;
  }

 private:
  Commands commands_;
  T lag_;  ///< time constant of the deflection [s]
  JointTorque<N, T> max_torque_;
  T compliance_[N];  ///< compliance of the springs [rad/(N m)]
};

namespace detail {
template <std::size_t N, Real T, std::size_t Capacity>
struct ServoBy<Interface::impedance, N, T, Capacity> {
  using type = Spring<N, T, Capacity>;
};
}  // namespace detail

/// A robot that a joint-impedance controller holds, as a KUKA iiwa by FRI or a Franka FR3: it takes
/// positions, about which its springs hold, and a torque beside them, and bears its own weight. Its
/// configuration names the stiffness of the springs, as set on the robot; it keeps that while it runs.
///
/// - Laws read the virtual state, as by position: the felt mass stands in series with the springs, so that a
///   push `F` moves the arm as configured, and deflects it by `J^T F / stiffness` beside.
/// - The torque of a command is what the links take for the motion that was sent before it, `M ddq + C dq`:
///   without it the springs would bend for each acceleration. It holds no weight and answers no contact;
///   joints by torque in other groups are taken to move steadily. The guard keeps it within the limits of
///   torque and of its rate, and lets it fade while it brakes.
/// - A robot whose damping d acts on its speed, not on the difference of speeds, lags by d over stiffness:
///   declare it.
/// - Position limits hold for the commands: springs let the robot be pushed beyond them.
/// - It starts untouched, or where its controller was told to be, with whatever leans on it as a gap.
template <Real T = double, RobotModel M, class... Parts>
[[nodiscard]] auto by_impedance(const M& model, const RobotConfiguration<M::joints, T>& configuration,
                                const Parts&... parts) {
  static_assert(detail::are_parts<Parts...>, "behind the configuration stand parts of a description");
  static_assert(detail::are_once<Parts...>,
                "a part of a robot's description is given twice: one EnergyTank, one ToolShape, ...");
  return detail::describe_robot<Interface::impedance, T>(model, configuration, parts...);
}
/// A group of the joints `Set`, which take positions with springs about them, as `by_impedance`.
template <LinkMask Set, Real T = double>
[[nodiscard]] JointGroup<Interface::impedance, Set, T> impedance_joints(
    const detail::GroupConfiguration<Set, T>& c) {
  return {c};
}

SKINCTL_END_NAMESPACE
