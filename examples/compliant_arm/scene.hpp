// The scene of a stiff arm by position with a sensor in its wrist: it gives way at the tool, and comes back.
#pragma once

#include <Eigen/Eigenvalues>

#include "examples/compliant_arm/run.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/passivity/stiffest_contact.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

namespace compliant_arm {

using Model = skinctl::CalibratedModel<skinctl::Chain<6>>;

/// The arm as its controller takes commands.
struct Limits {
  skinctl::JointLimits<6> joints;
  skinctl::JointJerk<6> jerk;
};

inline skinctl::RobotConfiguration<6> configuration(const Settings& s, const Limits& limits,
                                                    skinctl::Nanoseconds period, double heavier = 1) {
  using namespace skinctl;
  return {.limits = limits.joints,
          .period = period,
          .delay = nanoseconds(s.delay),
          .lag = nanoseconds(s.lag),
          .virtual_damping = 4 / heavier,
          .viscous_friction = (1 / heavier) * JointTorque<6>::constant(1),
          .virtual_inertia = JointTorque<6>::constant(0.3)};
}
/// The sensor is on the flange, and its controller takes off what the flange carries.
inline auto sensor(const Model& model, const Settings& s, double heavier = 1) {
  using namespace skinctl;
  WristSensorSettings<5> wrist;
  wrist.force = EventGate<>::dead_band(s.threshold);
  wrist.moment = EventGate<>::dead_band(0.1 * s.threshold);
  wrist.gain = 1 / heavier;
  return wrist_sensor<5>(model, wrist);
}
inline skinctl::StiffestContact hand(const Settings& s) {
  return {.stiffness = s.stiffest_hand, .body = s.heaviest_hand, .loss = 0.3};
}
/// By how much the arm has to be felt heavier than it is, so that hands rest on a robot that answers so late.
inline double heavier(const Model& model, const Settings& s, const Limits& limits,
                      skinctl::Nanoseconds period) {
  const auto arm = skinctl::by_position(model, configuration(s, limits, period));
  return std::max(1.0, 1.05 * hand(s).heavier(arm, sensor(model, s)));
}
/// The least mass with which the tool is felt [kg].
inline double felt_mass(const Model& model, const Settings& s, const Limits& limits,
                        skinctl::Nanoseconds period, double heavier) {
  const auto arm = skinctl::by_position(model, configuration(s, limits, period, heavier));
  return hand(s).lightest(arm, sensor(model, s, heavier));
}

inline auto make_scene(const Model& model, const Settings& s, const Limits& limits,
                       skinctl::Nanoseconds period, double heavier) {
  using namespace skinctl;
  const auto arm = by_position(model, configuration(s, limits, period, heavier), hand(s));
  auto back = tracking_settings(arm);
  back.lambda = 12 / std::sqrt(heavier);
  back.K_c = 4 / std::sqrt(heavier);
  back.tb = {};
  back.max_velocity = JointVelocity<6>::constant(0.3);
  return Cycle(arm, sensor(model, s, heavier), SplineJoint<6>(back) + SkinJointControl{} + GravityControl{})
      .with(MaxJerk{limits.jerk});
}

}  // namespace compliant_arm
