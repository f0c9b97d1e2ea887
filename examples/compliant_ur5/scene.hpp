// The scene of the main job: a UR5 with 260 cells that goes to its goals and gives way to touch.
#pragma once

#include "examples/compliant_ur5/settings.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

namespace compliant_ur5 {

inline constexpr std::size_t cells = 260;

inline skinctl::JointLimits<6> limits(const Settings& s) {
  using namespace skinctl;
  return JointLimits<6>({.lower = JointPosition<6>(ur5::Description::lower),
                         .upper = JointPosition<6>(ur5::Description::upper),
                         .velocity = JointVelocity<6>::constant(s.control.velocity_limit),
                         .acceleration = JointAcceleration<6>::constant(s.control.acceleration_limit),
                         .torque = JointTorque<6>(ur5::Description::max_torque)});
}

inline std::array<skinctl::Gains, 6> gains(const Settings& s) {
  std::array<skinctl::Gains, 6> gains;
  for (std::size_t i = 0; i < 6; ++i)
    gains[i] = s.rigid
                   ? skinctl::Gains{.force = 0, .proximity = 0}
                   : skinctl::Gains{.force = s.control.force_gain[i], .proximity = s.control.proximity_gain};
  return gains;
}

/// Friction of the virtual arm.
inline skinctl::VirtualShape<6> shape(const Settings& s) {
  skinctl::VirtualShape<6> shape;
  shape.decay = s.control.decay;
  shape.viscous = skinctl::JointTorque<6>(s.control.viscous);
  return shape;
}

inline skinctl::JointControlSettings<6> tracking(const Settings& s) {
  skinctl::JointControlSettings<6> t;
  t.dt = std::min(0.002, 1 / s.rate);
  t.lambda = s.control.lambda;
  t.K_c = s.control.K_c;
  t.K_i1 = s.control.K_i1;
  t.K_i2 = s.control.K_i2;
  t.tb = 0;
  t.max_velocity = skinctl::JointVelocity<6>::constant(s.control.max_velocity);
  t.shape = shape(s);
  return t;
}

/// From skin and state to commands for `I`: every number of it comes from the settings.
template <skinctl::Interface I>
auto make_scene(const Settings& s) {
  using namespace skinctl;
  const Nanoseconds period = nanoseconds(1 / s.rate);

  ResolverConfiguration<6> resolver{
      .limits = limits(s), .period = period, .delay = nanoseconds(s.control.delay)};
  resolver.lag = s.control.lag;
  resolver.shape = shape(s);
  resolver.dead_band = JointPosition<6>::constant(0.02);

  GuardConfiguration<6> guard{.limits = limits(s), .period = period};
  guard.longest_interval = 10 * period;

  SkinSettings skin;
  skin.force = EventGate<>::dead_band(s.control.force_threshold);

  const auto law = SplineJoint<6>(tracking(s)) + SkinJointControl{} + GravityControl{};
  const Passivity keeper(ContactDamper<>({.most = s.control.contact_damping}));
  using Robot = Resolver<I, ur5::Model, double, CrankNicolson, 32, Passivity<ContactDamper<>>>;
  return Cycle(Robot(ur5::Model{}, resolver, keeper), law, ur5_skin<cells>(gains(s), skin),
               Guard<I, 6>(guard));
}

}  // namespace compliant_ur5
