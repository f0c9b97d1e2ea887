// A small robot with a joint of each interface, for tests of scenes.
#pragma once

#include <cmath>

#include "skinctl/cycle/cycle.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/arm_with_finger.hpp"
#include "tests/support/grouped_plant.hpp"

namespace skinctl::testing {

using Model3 = ArmWithFingerModel;

// A torque of its own, and a spring to a goal.
template <LawRole Role>
struct Drive {
  struct Memory {};
  static constexpr Needs needs{.gravity = true, .touch = true};
  static constexpr LawRole role = Role;
  static constexpr int gravity_laws = 1;
  JointTorque<3> tau, stiffness;
  JointPosition<3> goal;
  double after = 0;  ///< when it begins [s]
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<3> torque(const Memory&, const K& known) const noexcept {
    JointTorque<3> out = known.gravity();
    if (seconds<double>(known.time()) < after) return out;
    for (std::size_t i = 0; i < 3; ++i) out[i] += tau[i] + stiffness[i] * (goal[i] - known.q()[i]);
    return out;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};
using Pull = Drive<LawRole::reactive>;

template <std::size_t N>
JointLimits<N> limits(double torque) {
  return JointLimits<N>({.lower = JointPosition<N>::constant(-2),
                         .upper = JointPosition<N>::constant(2),
                         .velocity = JointVelocity<N>::constant(3),
                         .acceleration = JointAcceleration<N>::constant(40),
                         .torque = JointTorque<N>::constant(torque)});
}
inline RobotConfiguration<1> one(bool driven) {
  RobotConfiguration<1> c{.limits = limits<1>(driven ? 0.7 : 150), .period = 2ms, .virtual_damping = 0};
  if (!driven) c.delay = 4ms, c.lag = 4ms, c.viscous_friction[0] = 5;
  return c;
}
// Joint 0 by velocity, 1 by position, the finger by torque.
template <class... Parts>
auto robot(const Parts&... parts) {
  auto column = one(false);
  column.lag = 0ms;
  return by_groups(Model3{}, velocity_joints<0b001>(column), position_joints<0b010>(one(false)),
                   torque_joints<0b100>(one(true)), parts...);
}

constexpr double tip[3] = {0.1, 0, 0};
inline Xyz<double> tip_at(const JointPosition<3>& q) {
  const auto X = Poses<Model3, all_links(3), double>(Model3{}, q).get<2>();
  const auto p = X.axes() * Xyz<double>{tip[0], tip[1], tip[2]};
  return {p.x + X.origin().x, p.y + X.origin().y, p.z + X.origin().z};
}

template <class Scene>
struct Run {
  Scene scene;
  GroupedPlant<Model3, 0b100, 0b001> plant{Model3{}, {0.2, 0.3, 0.5}, 0.004, 0.004};
  State<3> measured{0ns, {0.2, 0.3, 0.5}, {}};
  typename Scene::Memory memory = scene.start(measured);
  typename Scene::Output out{};
  JointTorque<3> push{};  ///< of the world, on the finger
  bool stuck = false;     ///< a hand holds the finger
  JointPosition<3> held{};
  Status seen{};
  double tip_speed = 0;
  JointVelocity<3> fastest{};
  std::uint64_t allocated = 0;

  auto& cycle(typename Scene::Input input = {}) {
    const auto before = tip_at(plant.q());
    plant.run(2e-3, 10, [&](const auto& q, const auto& dq) {
      auto tau = push;
      if (stuck) tau[2] += 2000 * (held[2] - q[2]) - 2 * dq[2];
      return tau;
    });
    const auto way = tip_at(plant.q()) - before;
    tip_speed = std::max(tip_speed, std::sqrt(dot(way, way)) / 2e-3);
    measured = {measured.time + 2ms, plant.q(), plant.dq()};
    for (std::size_t i = 0; i < 3; ++i) fastest[i] = std::max(fastest[i], std::abs(measured.dq[i]));
    input.now = measured.time;
    input.measured = measured;
    const AllocationGuard guard;
    out = scene.step(memory, input);
    allocated += guard.count();
    plant.command(out.planned);
    seen |= out.status;
    return out;
  }
};
template <class Scene>
Run(const Scene&) -> Run<Scene>;

}  // namespace skinctl::testing
