// SPDX-License-Identifier: BSD-3-Clause
// The description of a robot: one value from which resolver, guard, limits and laws derive their settings.
#pragma once

#include <array>
#include <string>
#include <tuple>

#include "skinctl/core/command.hpp"
#include "skinctl/core/joint_subset.hpp"
#include "skinctl/dynamics/mass_ratio.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/robot/detail/whose_limits.hpp"
#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A part of a description: the robot's own controller compensates gravity, as a UR's does under direct
/// torque. A law that compensates it too is refused.
struct RobotHoldsGravity {
  using RobotPart = RobotHoldsGravity;
};
/// A part of the description of a robot by torque: its own controller compensates the joints' friction. A law
/// that compensates it too is refused.
struct RobotCompensatesFriction {
  using RobotPart = RobotCompensatesFriction;
};
/// A part of the description of a robot by torque: the joints' friction is left uncompensated on purpose. The
/// robot then stops short of its goals by friction over stiffness.
struct FrictionUncompensated {
  using RobotPart = FrictionUncompensated;
};

namespace detail {
/// Throws `ConfigurationError` where masses that are assumed are not enough for the interface `Ix`, or a
/// joint by position or velocity has no inertia, of its model nor virtual.
template <Interface Ix, RobotModel M, std::size_t N, Real T>
SKINCTL_COLD void check_masses(const M& model, const JointTorque<N, T>& virtual_inertia,
                               LinkMask joints = joints_between(0, N)) {
  if (!has_assumed_masses(model)) return;
  if constexpr (takes_torque(Ix)) {
    require_masses(model, takes_position(Ix) ? "a robot by impedance" : "a robot by torque");
  } else {
    std::array<double, M::joints> about{};  // what turns with each joint, at least
    [&]<std::size_t... L>(std::index_sequence<L...>) {
      const auto weigh = [&]<std::size_t K>() {
        using T0 = typename ScalarOf<M>::type;
        constexpr std::size_t at = M::joints - 1 - K;
        const LinkInertia in = inertia_of(numbers_of<at, T0>(model));
        about[at] += M::kinds[at] == JointKind::prismatic
                         ? in.mass
                         : in.zz + in.mass * (in.c[0] * in.c[0] + in.c[1] * in.c[1]);
        if (M::parents[at] >= 0) about[std::size_t(M::parents[at])] += about[at];
      };
      (weigh.template operator()<L>(), ...);
    }(std::make_index_sequence<M::joints>{});
    for (std::size_t i = 0, k = 0; i < M::joints; ++i) {
      if (((joints >> i) & 1) == 0) continue;
      if (!(about[i] > 0 || virtual_inertia[k] > T(0)))
        refuse("skinctl: joint " + std::to_string(i) +
               ": virtual inertia 0, allowed: > 0 kg m^2, as its file gives "
               "no mass; or UrdfOptions::total_mass estimates the masses");
      ++k;
    }
  }
}

// Kinds of parts of a description.
struct PassivityPart {};        // monitors energy or contacts inside the resolver
struct ToolShapePart {};        // inertia and friction at the tool
struct IntegratorPart {};       // integration of the virtual robot
struct HistoryPart {};          // number of commands under way
struct StiffestContactPart {};  // what a scene may meet

/// Whether `P` is a valid part, an argument after the configuration in `by_position` and the like.
template <class P>
concept RobotPart = requires { typename P::RobotPart; };
/// A part of which a robot may have several.
template <class P>
concept RepeatedPart = requires { requires P::repeats; };
template <class Part, class... Parts>
inline constexpr bool is_one_of = (std::is_same_v<Part, Parts> || ...);
template <class Part, class... Parts>
inline constexpr bool is_once = (std::size_t(std::is_same_v<Part, Parts>) + ...) == 1 || RepeatedPart<Part>;
/// A part of a description for a virtual robot, which runs ahead of the real one.
template <class P>
concept PartOfVirtualRobot = requires { requires P::of_virtual_robot; };
// As variables, so that an error is one line.
template <class... Parts>
inline constexpr bool are_parts = (RobotPart<Parts> && ...);
template <class... Parts>
inline constexpr bool are_once = (is_once<Parts, Parts...> && ...);
template <Interface Ix, class... Parts>
inline constexpr bool fit_interface = Ix != Interface::torque || !(PartOfVirtualRobot<Parts> || ...);
}  // namespace detail

/// The description of a robot: a model, the interface of its joints, a configuration, and optional parts: an
/// energy tank, a passivity observer, the stiffest contact (`passivity/`), a tool shape, an integrator
/// (`resolver/`), compensation of gravity and friction. Made by `by_position`, `by_velocity`, `by_impedance`
/// or `by_torque`; immutable.
template <Interface Ix, RobotModel M, Real T, class... Parts>
class RobotDescription {
 public:
  static constexpr Interface interface = Ix;
  static constexpr std::size_t joints = M::joints;
  using scalar = T;
  using model_type = M;
  using Configuration = RobotConfiguration<joints, T>;
  template <class Part>
  static constexpr bool has = detail::is_one_of<Part, Parts...>;
  static constexpr bool robot_holds_gravity = has<RobotHoldsGravity>;
  static constexpr bool robot_compensates_friction = has<RobotCompensatesFriction>;
  static constexpr bool friction_uncompensated = has<FrictionUncompensated>;
  static_assert(Ix == Interface::torque || !robot_holds_gravity,
                "RobotHoldsGravity: only by torque; a virtual robot has no controller of its own");
  static_assert(Ix == Interface::torque || !(robot_compensates_friction || friction_uncompensated),
                "friction: by position or velocity the robot's own control compensates it, say nothing");
  static_assert(!(robot_compensates_friction && friction_uncompensated),
                "friction: either the robot compensates it or nobody");

  /// Throws `ConfigurationError` for a number out of its range.
  RobotDescription(const M& model, const Configuration& configuration, const Parts&... parts)
      : model_(model), configuration_(configuration), parts_(parts...) {
    check(configuration, Ix != Interface::torque);
    detail::check_masses<Ix>(model, configuration.virtual_inertia);
    detail::check_limits(model, configuration.limits);
  }

  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] const Configuration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return configuration_.limits; }
  [[nodiscard]] Nanoseconds period() const noexcept { return configuration_.period; }
  /// The longest time between two evaluations of a law in cycles on time: a sub-step, or a period for a robot
  /// by torque.
  [[nodiscard]] Nanoseconds dt() const noexcept {
    return Ix == Interface::torque ? period() : planned_substep(period(), configuration_.substep);
  }
  /// The longest time between two evaluations of a law in the latest cycles that the description allows.
  [[nodiscard]] Nanoseconds longest_dt() const noexcept {
    const Nanoseconds late = configuration_.longest() / max_substeps;
    return Ix != Interface::torque && late > dt() ? late : dt();
  }
  /// D: the mean time from a state that a law reads until its torque acts. By torque the declared delay and
  /// lag, and 1.5 periods: one until the next state, half of the next, for which the torque is held. A
  /// virtual robot answers within a sub-step, so there it is `longest_dt()`.
  [[nodiscard]] Nanoseconds loop_delay() const noexcept {
    if constexpr (Ix != Interface::torque) return longest_dt();
    return configuration_.delay + configuration_.lag + 3 * period() / 2;
  }
  [[nodiscard]] VirtualDynamics<joints, T> virtual_dynamics() const noexcept {
    return configuration_.virtual_dynamics();
  }
  [[nodiscard]] const std::tuple<Parts...>& parts() const noexcept { return parts_; }

 private:
  [[no_unique_address]] M model_;
  Configuration configuration_;
  [[no_unique_address]] std::tuple<Parts...> parts_;
};

/// A description of a robot whose joints all have one interface.
template <class R>
concept DescribedRobot = requires(const R& robot) {
  robot.virtual_dynamics();
  robot.dt();
  { R::interface } -> std::convertible_to<Interface>;
};

namespace detail {
/// A part in a tuple; nothing in place of one that does not fit, after the error about it.
template <Interface Ix, class P>
auto if_it_fits(const P& given_part) {
  if constexpr (RobotPart<P> && fit_interface<Ix, P>) {
    return std::tuple<P>(given_part);
  } else {
    return std::tuple<>();
  }
}
/// Makes a description. Its callers assert that the parts fit: said there, an error names the user's line at
/// once.
template <Interface Ix, class T, class M, class... Parts>
auto describe_robot(const M& model, const RobotConfiguration<M::joints, T>& c, const Parts&... parts) {
  if constexpr (!are_once<Parts...>) {
    return RobotDescription<Ix, M, T>(model, c);
  } else if constexpr (are_parts<Parts...> && fit_interface<Ix, Parts...>) {
    return RobotDescription<Ix, M, T, Parts...>(model, c, parts...);
  } else {
    return std::apply([&](const auto&... fit) { return describe_robot<Ix, T>(model, c, fit...); },
                      std::tuple_cat(if_it_fits<Ix>(parts)...));
  }
}
}  // namespace detail

/// A robot that takes positions. `by_position<float>(...)` computes in float.
template <Real T = double, RobotModel M, class... Parts>
[[nodiscard]] auto by_position(const M& model, const RobotConfiguration<M::joints, T>& configuration,
                               const Parts&... parts) {
  static_assert(detail::are_parts<Parts...>,
                "behind the configuration stand parts of a description: EnergyTank, PassivityObserver, "
                "StiffestContact, ToolShape, an integrator, RobotHoldsGravity, ...");
  static_assert(detail::are_once<Parts...>,
                "a part of a robot's description is given twice: one EnergyTank, one ToolShape, ...");
  return detail::describe_robot<Interface::position, T>(model, configuration, parts...);
}
/// A robot that takes velocities.
template <Real T = double, RobotModel M, class... Parts>
[[nodiscard]] auto by_velocity(const M& model, const RobotConfiguration<M::joints, T>& configuration,
                               const Parts&... parts) {
  static_assert(detail::are_parts<Parts...>,
                "behind the configuration stand parts of a description: EnergyTank, PassivityObserver, "
                "StiffestContact, ToolShape, an integrator, RobotHoldsGravity, ...");
  static_assert(detail::are_once<Parts...>,
                "a part of a robot's description is given twice: one EnergyTank, one ToolShape, ...");
  return detail::describe_robot<Interface::velocity, T>(model, configuration, parts...);
}
/// A robot that takes torques. It has no virtual robot: of the virtual dynamics the viscous friction is used,
/// added to its own friction, and the inertia, that of its motors.
template <Real T = double, RobotModel M, class... Parts>
[[nodiscard]] auto by_torque(const M& model, const RobotConfiguration<M::joints, T>& configuration,
                             const Parts&... parts) {
  static_assert(detail::are_parts<Parts...>,
                "behind the configuration stand parts of a description: EnergyTank, PassivityObserver, "
                "StiffestContact, ToolShape, an integrator, RobotHoldsGravity, ...");
  static_assert(detail::are_once<Parts...>,
                "a part of a robot's description is given twice: one EnergyTank, one ToolShape, ...");
  static_assert(detail::fit_interface<Interface::torque, Parts...>,
                "by torque no virtual robot runs ahead: leave PassivityObserver, StiffestContact out");
  return detail::describe_robot<Interface::torque, T>(model, configuration, parts...);
}
/// A description for the interface `Ix`, for code that has it as a parameter: see `by_position`,
/// `by_velocity` and `by_torque`.
template <Interface Ix, Real T = double, RobotModel M, class... Parts>
[[nodiscard]] auto robot_by(const M& model, const RobotConfiguration<M::joints, T>& configuration,
                            const Parts&... parts) {
  static_assert(detail::are_parts<Parts...>,
                "behind the configuration stand parts of a description: EnergyTank, PassivityObserver, "
                "StiffestContact, ToolShape, an integrator, RobotHoldsGravity, ...");
  static_assert(detail::are_once<Parts...>,
                "a part of a robot's description is given twice: one EnergyTank, one ToolShape, ...");
  static_assert(detail::fit_interface<Ix, Parts...>,
                "by torque no virtual robot runs ahead: leave PassivityObserver, StiffestContact out");
  return detail::describe_robot<Ix, T>(model, configuration, parts...);
}

/// The settings that laws share with their robot; `Cycle` compares them.
template <std::size_t N, Real T>
struct LawTerms {
  Nanoseconds dt;                          ///< longest time between two evaluations, in late cycles too
  VirtualDynamics<N, T> virtual_dynamics;  ///< dynamics of the virtual robot, or of the robot by torque
  Nanoseconds loop_delay = dt;             ///< D: mean time from a state that a law reads until it acts
  T mass_ratio = T(1);    ///< largest factor by which the robot of another configuration is lighter
  T gravity_rate = T(0);  ///< rate of the gravity by which configurations differ, see `gravity_rate` [1/s^2]
};
/// The numbers of joints with a limit of jerk that the laws of a scene are checked against; 0 without one.
template <std::size_t N, Real T>
struct JerkTerms {
  std::array<T, N> rise{};      ///< times from rest to the acceleration limit A at the jerk J, A/J [s]
  std::array<T, N> friction{};  ///< largest rates at which viscous friction slows joints [1/s]
};
/// The `JerkTerms` of joints with the limits `acceleration` (0 for joints without a limit of jerk) and
/// `jerk`. A joint with the viscous friction b, which the integrator takes at the end of a sub-step of `h`
/// seconds, is slowed at the rate `b / (M_ii + b h)`. Throws `ConfigurationError` for a jerk that is not
/// above 0.
template <RobotModel M, Real T>
[[nodiscard]] SKINCTL_COLD JerkTerms<M::joints, T> jerk_terms(
    const M& model, const VirtualDynamics<M::joints, T>& dynamics,
    const JointAcceleration<M::joints, T>& acceleration, const JointJerk<M::joints, T>& jerk, const T& h) {
  JerkTerms<M::joints, T> out;
  const auto inertia = inertia_range(model, dynamics.inertia).least;
  for (std::size_t i = 0; i < M::joints; ++i) {
    if (acceleration[i] == T(0)) continue;
    require(jerk[i] > T(0), "jerk", static_cast<double>(jerk[i]), "> 0 rad/s^3");
    out.rise[i] = acceleration[i] / jerk[i];
    if (const T b = dynamics.viscous[i]; b > T(0)) out.friction[i] = b / (inertia[i] + b * h);
  }
  return out;
}

SKINCTL_END_NAMESPACE
