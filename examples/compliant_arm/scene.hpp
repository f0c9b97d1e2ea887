// The scene of a compliant arm: it gives way at the tool, and comes back. By position with a sensor in its
// wrist, or by joint impedance with the torques that its controller finds.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "examples/compliant_arm/run.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/passivity/stiffest_contact.hpp"
#include "skinctl/robot/spring.hpp"
#include "skinctl/tactile/robot_observer.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

namespace compliant_arm {

template <std::size_t N>
using Model = skinctl::CalibratedModel<skinctl::Chain<N>>;

/// The arm as its controller takes commands.
template <std::size_t N>
struct Limits {
  skinctl::JointLimits<N> joints;
  skinctl::JointJerk<N> jerk;
  skinctl::JointPosition<N> start;  ///< where the arm stands
};

/// A stiff arm by position: six joints, and what its wrist feels.
struct Stiff {
  static constexpr std::size_t joints = 6;
  skinctl::Nanoseconds period;
  skinctl::RobotConfiguration<6> configuration(const Model<6>&, const Settings& s, const Limits<6>& limits,
                                               double heavier = 1) const {
    using namespace skinctl;
    return {.limits = limits.joints,
            .period = period,
            .delay = nanoseconds(s.delay),
            .lag = nanoseconds(s.lag),
            .virtual_damping = 4 / heavier,
            .viscous_friction = (1 / heavier) * JointTorque<6>::constant(1),
            .virtual_inertia = JointTorque<6>::constant(0.3)};
  }
  template <class... Parts>
  auto robot(const Model<6>& model, const Settings& s, const Limits<6>& limits, double heavier,
             const Parts&... parts) const {
    return skinctl::by_position(model, configuration(model, s, limits, heavier), parts...);
  }
  /// The sensor is on the flange, and its controller takes off what the flange carries.
  auto touch(const Model<6>& model, const Settings& s, double heavier = 1) const {
    using namespace skinctl;
    WristSensorSettings<5> wrist;
    wrist.force = EventGate<>::dead_band(s.threshold);
    wrist.moment = EventGate<>::dead_band(0.1 * s.threshold);
    wrist.gain = 1 / heavier;
    return wrist_sensor<5>(model, wrist);
  }
};

/// An arm on springs: seven joints, and what its controller finds at them.
struct Springs {
  static constexpr std::size_t joints = 7;
  skinctl::Nanoseconds period;
  skinctl::RobotConfiguration<7> configuration(const Model<7>& model, const Settings& s,
                                               const Limits<7>& limits, double heavier = 1) const {
    using namespace skinctl;
    const auto mass = mass_matrix(model, limits.start);
    double slowest = 0;  // of the springs' deflections: damping over stiffness
    for (std::size_t i = 0; i < 7; ++i)
      slowest = std::max(slowest, 2 * s.damping_ratio * std::sqrt(mass(i, i) / s.stiffness));
    return {.limits = limits.joints,
            .period = period,
            .delay = nanoseconds(s.delay),
            .lag = nanoseconds(s.lag),
            .stiffness = JointTorque<7>::constant(s.stiffness),
            .spring_lag = nanoseconds(slowest),
            .virtual_damping = 4 / heavier,
            .viscous_friction = (1 / heavier) * JointTorque<7>::constant(1),
            .virtual_inertia = JointTorque<7>{1, 1, 1, 1, 0.5, 0.5, 0.5},
            .dead_band = JointPosition<7>::constant(0.05)};
  }
  template <class... Parts>
  auto robot(const Model<7>& model, const Settings& s, const Limits<7>& limits, double heavier,
             const Parts&... parts) const {
    return skinctl::by_impedance(model, configuration(model, s, limits, heavier), parts...);
  }
  auto touch(const Model<7>& model, const Settings& s, double heavier = 1) const {
    using namespace skinctl;
    return RobotTouch<Model<7>>(model, {.observer = {},
                                        .gates = same_gate(model, EventGate<>::dead_band(s.torque_threshold)),
                                        .gain = 1 / heavier});
  }
};

inline skinctl::StiffestContact hand(const Settings& s) {
  return {.stiffness = s.stiffest_hand, .body = s.heaviest_hand, .loss = 0.3};
}
/// By how much the arm has to be felt heavier than it is, so that hands rest on a robot that answers so late.
template <class Kind>
double heavier(const Kind& kind, const Model<Kind::joints>& model, const Settings& s,
               const Limits<Kind::joints>& limits) {
  return std::max(1.0, 1.05 * hand(s).heavier(kind.robot(model, s, limits, 1), kind.touch(model, s)));
}
/// The least mass with which the tool is felt [kg].
template <class Kind>
double felt_mass(const Kind& kind, const Model<Kind::joints>& model, const Settings& s,
                 const Limits<Kind::joints>& limits, double heavier) {
  return hand(s).min_felt_mass(kind.robot(model, s, limits, heavier), kind.touch(model, s, heavier));
}

template <class Kind>
auto make_scene(const Kind& kind, const Model<Kind::joints>& model, const Settings& s,
                const Limits<Kind::joints>& limits, double heavier) {
  using namespace skinctl;
  constexpr std::size_t N = Kind::joints;
  const auto arm = kind.robot(model, s, limits, heavier, hand(s));
  // A limit of jerk bounds lambda and K_c. The integrals keep their gains: they bring a heavy arm back.
  auto back = tracking_settings(arm);
  const auto fitted = tracking_settings(arm, limits.jerk);
  back.lambda = std::min(fitted.lambda, 12 / std::sqrt(heavier));
  back.K_c = std::min(fitted.K_c, 4 / std::sqrt(heavier));
  back.tb = {};
  back.max_velocity = JointVelocity<N>::constant(0.3);
  return Cycle(arm, kind.touch(model, s, heavier),
               SplineJoint<N>(back) + SkinJointControl{} + GravityControl{})
      .with(MaxJerk{limits.jerk});
}

}  // namespace compliant_arm
