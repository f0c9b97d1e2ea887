// The scene of the hand's job: springs at the joints, touch, gravity; by torque.
#pragma once

#include "examples/adapters/allegro/cells.hpp"
#include "examples/adapters/allegro/limits.hpp"
#include "examples/compliant_allegro/run.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/impedance.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"

namespace compliant_allegro {

using HandModel = skinctl::CalibratedModel<skinctl::allegro::Tree, double>;
using HandSkin = skinctl::SkinOf<HandModel, double, 16>;

/// @param lag  of the estimated velocity, which the torques answer late by.
inline auto make_scene(const Settings& s, Side side, const adapters::allegro::TorqueScale& scale,
                       skinctl::Nanoseconds period, skinctl::Nanoseconds lag) {
  using namespace skinctl;
  // The joints' own friction, which no maker states, is left alone: it calms the hand and costs the last
  // millimetres.
  const auto hand =
      by_torque(skinctl::allegro::hand(side),
                {.limits = adapters::allegro::limits(scale), .period = period, .delay = lag + 1ms},
                FrictionUncompensated{});
  ImpedanceSettings<JointSpace<16>> springs;
  springs.stiffness = springs.uniform(s.stiffness);
  springs.damping = springs.uniform(s.damping);
  springs.space.max_velocity = JointVelocity<16>::constant(1.5);
  SkinSettings touch;
  touch.force = EventGate<>::dead_band(s.threshold);
  return Cycle(hand, HandSkin(adapters::allegro::skin_patches(side, s.force_gain), touch),
               JointImpedance<16>(springs) + SkinJointControl{} + GravityControl{});
}

}  // namespace compliant_allegro
