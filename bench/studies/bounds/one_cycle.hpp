// The torque of a whole law, and one cycle of a whole scene, with error bounds, at single states.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "bench/studies/proofs/bound.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "tests/support/scene.hpp"

namespace skinctl::bounds {

struct Touched {
  std::array<float, 6> q, dq;
  std::array<float, 3> force;
};

/// The command of the first cycle of a UR5 whose skin is touched: skin, gravity, four sub-steps, limits,
/// guard.
template <class T>
std::array<T, 6> first_command(const Touched& at) {
  const auto scene = testing::kinesthetic_scene<Interface::position, 260, T>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  State<6, T> state;
  for (std::size_t i = 0; i < 6; ++i) state.q[i] = T(at.q[i]);
  auto memory = std::make_unique<typename Scene::Memory>(scene.start(state));
  typename Scene::Input input;
  input.now = state.time = 8ms;
  input.measured = state;
  std::array<CellSample, 3> samples;
  for (std::size_t i = 0; i < 3; ++i)
    samples[i] = {
        .time = 7ms, .cell = static_cast<std::uint32_t>(20 + 80 * i), .force = {at.force[i], 0.1f, 0}};
  input.samples = samples;
  const auto out = scene.step(*memory, input);
  std::array<T, 6> q;
  for (std::size_t i = 0; i < 6; ++i) q[i] = out.command.position[i];
  return q;
}

/// The torque of a whole law of a UR5 on its way to a goal, whose last link is touched: sliding mode, skin
/// and gravity. It began at rest and moves at `dq` 2 ms later.
template <class T>
std::array<T, 6> law_torque(const Touched& at) {
  using Touch = LinkWrenches<ur5::Model, 0b100000, T>;
  JointControlSettings<6, T> settings;
  settings.tb = 0s;
  const auto law = SplineJoint<6, T>(settings) + SkinJointControl{} + GravityControl{};
  using Law = std::remove_cvref_t<decltype(law)>;
  using Known = Quantities<ur5::Model, Law::needs, T, Touch>;
  const ur5::Model arm;
  Touch touch;
  State<6, T> state;
  for (std::size_t i = 0; i < 6; ++i) state.q[i] = T(at.q[i]);
  auto memory = law.start(Known(arm, state, T(0.002), touch));
  JointGoal<6, T> goal{state.q, 2s};
  for (T& q : goal.q_g) q = q + T(0.25);
  memory = law.receive(memory, Known(arm, state, T(0.002), touch), goal).memory;
  memory = evaluate(law, memory, Known(arm, state, T(0.002), touch), T(0.002)).memory;
  for (std::size_t i = 0; i < 6; ++i) state.dq[i] = T(at.dq[i]);
  touch.template set<5>({{T(at.force[0]), T(at.force[1]), T(at.force[2])}, {T(0), T(0.5), T(0)}});
  const auto out = evaluate(law, memory, Known(arm, state, T(0.002), touch), T(0.002));
  std::array<T, 6> tau;
  for (std::size_t i = 0; i < 6; ++i) tau[i] = out.torque[i];
  return tau;
}

/// A bracket of what `program` computes, over random states.
template <class R, class Wide, class Program>
void print_at_states(const char* name, const char* unit, int states, float fastest, Program&& program) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> angle(-2.5f, 2.5f), force(0, 0.5f), rate(-fastest, fastest);
  double found = 0, proven = 0;
  std::uint64_t open = 0;
  int bounded = 0;
  for (int k = 0; k < states; ++k) {
    Touched at{};
    for (auto& q : at.q) q = angle(rng);
    for (auto& f : at.force) f = force(rng);
    if (fastest > 0)
      for (auto& dq : at.dq) dq = rate(rng);
    math::undecided() = 0;
    const auto bound = program(at, math::Bound<R>(R(0)));
    open += math::undecided();
    const auto computed = program(at, R(0));
    const auto exact = program(at, Wide(0));
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      found = std::max(found, std::abs(static_cast<double>(static_cast<Wide>(computed[i]) - exact[i])));
      most = std::max(most, bound[i].error());
    }
    if (std::isfinite(most)) ++bounded, proven = std::max(proven, most);
  }
  std::printf("%-22s %-4s[%.2e, %.2e], %d of %d states, %.1f comparisons a state left open\n", name, unit,
              found, proven, bounded, states, static_cast<double>(open) / states);
}
inline void print_one_cycle() {
  const auto torque = [](const Touched& at, auto zero) { return law_torque<decltype(zero)>(at); };
  std::printf(
      "\nThe torque of a whole law of a UR5 (sliding mode, skin, gravity), at random states within 3 "
      "rad/s:\n");
  print_at_states<float, double>("whole law, float", "N m", 1000, 3, torque);
  print_at_states<double, long double>("whole law, double", "N m", 1000, 3, torque);
  const auto command = [](const Touched& at, auto zero) { return first_command<decltype(zero)>(at); };
  std::printf(
      "\nThe command of one cycle of a UR5 with 260 cells, three of them touched, at random states:\n");
  print_at_states<float, double>("one cycle, float", "rad", 200, 0, command);
  print_at_states<double, long double>("one cycle, double", "rad", 200, 0, command);
}

}  // namespace skinctl::bounds
