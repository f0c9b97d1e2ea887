// A robot by torque, with random skills in random contacts, and the energy that it gives.
#pragma once

#include "skinctl/math/ldlt.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "tests/support/contact_scene.hpp"

namespace skinctl::testing {

/// The energies of a scene, as `Energies`, and the deepest debt of the tank [J].
struct TorqueEnergies {
  double extracted = 0, debt = 0, path = 0;
  bool finite = true;
  Status status;
};

/// Two seconds of a scene on a frictionless UR5 by torque at 1 kHz, in steps of 0.1 ms. The robot feels the
/// obstacles directly; the skin samples them at the rate of the commands.
template <class PassivityParts>
TorqueEnergies run_torque(const RandomScene& scene, const PassivityParts& passivity) {
  using Robot = ResolverBy<Interface::torque, ur5::Model, double, CrankNicolson, 32, PassivityParts>;
  constexpr Nanoseconds period = 1ms;
  auto law = scene.law;
  for (TimedSkill& s : law.skills) s.damping *= 0.1;  // small enough for a wrist commanded once a millisecond
  RobotConfiguration<6> c{.limits = scene.configuration.limits, .period = period};
  c.viscous_friction = scene.configuration.viscous_friction;
  c.dead_band = JointPosition<6>::constant(1e-3);
  const Robot robot(ur5::Model{}, c, passivity);
  State<6> state;
  state.q = JointPosition<6>(scene.pose);
  auto memory = robot.start(state);
  RandomSkills::Memory law_memory;
  JointTorque<6> tau = memory.command().torque;
  TorqueEnergies out;
  double given = 0;
  const double h = 1e-4;
  for (Nanoseconds now = period; now < 2s; now += period) {
    SceneTouch touch;
    const double from = seconds<double>(now - period);
    const auto steps = static_cast<int>(period / 100us);
    for (int j = 0; j <= steps; ++j) {
      touch.contacts.count = 0;
      touch.seen = {};
      std::array<double, 6> q{}, dq{};
      for (std::size_t i = 0; i < 6; ++i) q[i] = state.q[i], dq[i] = state.dq[i];
      for (const StiffBody& o : scene.obstacles) {
        auto& contact = touch.contacts.list[touch.contacts.count];
        contact.link = 2 + touch.contacts.count++;
        contact.force = o.force(q, scene.pose, dq, from + j * h);
        std::copy(std::begin(o.row), std::end(o.row), contact.row);
        if (j == steps) o.keep_off(q, scene.pose, from + j * h, touch.seen);
      }
      if (j == steps) break;
      const auto push = skin_torque(0, 0, contact_part(touch));
      const JointAngles<ur5::Model, double> angles(ur5::Model{}, state.q);
      const JointTorque<6> net = tau + push - bias_torque(ur5::Model{}, angles, state.dq);
      JointAcceleration<6> a;
      math::Ldlt<6, double>(mass_matrix(ur5::Model{}, angles).data).solve(net.data, a.data);
      const auto mean = integrate(state.dq, a, 0.5 * h);  // so that the work of held torques is exact
      state.dq = integrate(state.dq, a, h);
      state.q = integrate(state.q, mean, h);
      given -= h * power(push, mean);
      out.path += h * std::abs(state.dq[0]);
      out.extracted = std::max(out.extracted, given);
    }
    state.time = now;
    const auto result = robot.step(memory, law, law_memory, state, robot.interval(memory, now),
                                   std::span<const SceneTouch>(&touch, 1));
    tau = result.command.torque;
    out.finite = out.finite && power(tau, state.dq) - power(tau, state.dq) == 0;
    out.status |= result.status;
    if constexpr (Robot::has_tank) out.debt = std::max(out.debt, -memory.driven.tank.energy);
  }
  return out;
}

}  // namespace skinctl::testing
