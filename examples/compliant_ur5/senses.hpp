// Touch without a skin: by the wrist sensor of an e-Series, or by the motors.
#pragma once

#include "examples/compliant_ur5/settings.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

namespace compliant_ur5 {

/// What the arm gives way to where it has no skin.
using UrWrist = skinctl::WristSensor<5, skinctl::ur5::Model>;
using UrMotors = skinctl::MotorTouch<skinctl::ur5::Model>;

/// The middle of the flange, its axes: there the wrench is taken, wherever the tool's point is.
inline skinctl::Transform<skinctl::Link<5>, skinctl::ForceSensor> flange() {
  constexpr auto& p = skinctl::ur5::Description::flange;
  return skinctl::Transform<skinctl::Link<5>, skinctl::ForceSensor>::translation_xyz(p[0], p[1], p[2]);
}
inline constexpr double muted = 1e-9;  ///< gain on a rigid arm

/// `heavier`: see `scene.hpp`. `mass`: with which the arm is felt [kg].
inline UrWrist wrist_touch(const Settings& s, double heavier = 1, double mass = 5) {
  using namespace skinctl;
  const WristControl& c = s.wrist;
  return UrWrist(ur5::Model{},
                 {.X_LS = flange(),
                  .mass = 0,  // the controller takes the payload off that it was told
                  .reach = c.reach,
                  .force = {c.threshold, 2 * c.threshold / 3, 2 * c.threshold / 3},
                  .moment = {c.moment_threshold, 2 * c.moment_threshold / 3, 2 * c.moment_threshold / 3},
                  .gain = s.rigid ? muted : c.gain / heavier,
                  .noise = s.trust_all_cells ? 0 : c.noise,
                  .moment_noise = s.trust_all_cells ? 0 : c.moment_noise,
                  .life = {.mass = mass}});
}

/// What the motors give is the mean of a cycle: a servo is faster than that.
inline UrMotors motor_touch(const Settings& s, double heavier = 1, double mass = 5) {
  using namespace skinctl;
  const MotorControl& c = s.motors;
  UrMotors::Settings m;
  m.observer.rate = c.rate;
  m.observer.rotors = RotorInertia<6>(c.rotor_inertia, same(1));
  m.observer.friction = JointFriction<6>({.viscous = JointTorque<6>(c.viscous),
                                          .coulomb = JointTorque<6>(c.coulomb),
                                          .stiction = {},
                                          .sign_velocity = 0.02});
  m.observer.motors = MotorSampling::mean;
  for (std::size_t i = 0; i < 6; ++i) {
    m.gates[i] = EventGate<>::dead_band(c.threshold[i]);
    m.max_torque[i] = 2 * ur5::Description::max_torque[i];  // a current has peaks
  }
  m.gain = s.rigid ? muted : c.gain / heavier;
  if (!s.trust_all_cells) m.noise = c.noise;
  m.life.mass = mass;
  return UrMotors(ur5::Model{}, m);
}

}  // namespace compliant_ur5
