// Laws that project, damp or hold a posture act on the robot that they move: a virtual one with its own
// inertia.
//
// Promise: projections, postures and dampers act on the inertia of the robot that they move, virtual
// inertia and tool shape included
// Tried: null space and posture: the tool stays to 1e-7 m per rad of joint motion; by position and
// velocity, two integrators

#include "skinctl/robot/virtual_mass.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/impedance.hpp"
#include "skinctl/control/posture.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/fusion/null_space.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
using Skin = LinkWrenches<Arm, link_bit<5>>;

/// A tracking law that asks for a torque, whatever happens.
struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs{.gravity = true};
  static constexpr LawRole role = LawRole::tracking;
  JointTorque<6> tau;
  explicit Push(const JointTorque<6>& t = {}) : tau(t) {}
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <GravityTerm G = GravityTerm::included, class K>
  JointTorque<6> torque(const Memory&, const K& known, const LawShare<double>& share = {}) const noexcept {
    auto out = share.feedback * tau;
    if (G == GravityTerm::included) out += share.feed_forward * known.gravity();
    return out;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

struct Reads : StatelessLaw<Reads> {
  static constexpr Needs needs = {.mass_factors = true};
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
};

RobotConfiguration<6> configuration(const JointTorque<6>& inertia) {
  return {.limits = limits_of<ur5::Description>(1e4),
          .period = 2ms,
          .delay = 4ms,
          .virtual_damping = 0,
          .virtual_inertia = inertia,
          .substep = 2ms};
}
const JointTorque<6> heavy{0.5, 1, 0.7, 0.3, 0.2, 0.1};
const Transform<Link<5>, Tool> at_flange;

ToolShape<5, 3> shape() {
  return ToolShape<5, 3>({.mass = ToolShape<5, 3>::diagonal({4, 9, 6}), .rest_decay = 0});
}

/// The velocity of the virtual robot one sub-step after `from` under `law`.
template <class Robot, class L>
JointVelocity<6> after_step(const Robot& robot, const L& law, const State<6>& from) {
  const auto resolver = resolver_of(robot);
  auto memory = resolver.start(from);
  memory.group().v = from.dq;
  const Skin untouched;
  auto law_memory = law.start(resolver.template known<L>(from, 0.002, untouched));
  Interval interval{from.time, from.time + 2ms, 1, {}};
  static_cast<void>(resolver.step(memory, law, law_memory, from, interval, std::span(&untouched, 1)));
  return memory.group().v;
}
/// Speed of the tool's point, by differences of poses.
double point_speed(const JointPosition<6>& q, const JointVelocity<6>& u) {
  const auto at = [&](double h) {
    return link_poses<link_bit<5>>(Arm{}, integrate(q, u, h)).get<5>().origin();
  };
  const Xyz<double> v = (1 / 2e-4) * (at(1e-4) - at(-1e-4));
  return std::sqrt(dot(v, v));
}
JointPosition<6> regular(Seeded& random) {
  JointPosition<6> q;
  do {
    q = random.vector<JointPosition<6>>(2.5);
  } while (std::abs(std::sin(q[2])) < 0.4 || std::abs(std::sin(q[4])) < 0.4);
  return q;
}
/// The largest disturbance of the tool by `law(q)`, over its effect on the joints [m/rad].
template <class Robot, class Make>
double disturbance(const Robot& robot, double speed, Make&& make) {
  Seeded random(3);
  double worst = 0;
  for (int k = 0; k < 40; ++k) {
    const State<6> from{0ns, regular(random), random.vector<JointVelocity<6>>(speed)};
    const auto with = after_step(robot, make(from.q, random), from),
               without = after_step(robot, Push(), from);
    double moved = 0;
    for (std::size_t i = 0; i < 6; ++i) moved = std::max(moved, std::abs(with[i] - without[i]));
    REQUIRE(moved > 1e-7);
    worst = std::max(worst, point_speed(from.q, with - without) / moved);
  }
  return worst;
}
template <class F>
void for_each_robot(F&& f) {
  f("bare", by_position(Arm{}, configuration({})));
  f("virtual inertia", by_position(Arm{}, configuration(heavy)));
  f("virtual inertia, by velocity", by_velocity(Arm{}, configuration(heavy)));
  f("virtual inertia, semi-implicit Euler", by_position(Arm{}, configuration(heavy), SemiImplicitEuler{}));
  f("tool shape", by_position(Arm{}, configuration(heavy), shape()));
  f("tool shape, semi-implicit Euler",
    by_position(Arm{}, configuration(heavy), shape(), SemiImplicitEuler{}));
}
}  // namespace

TEST_CASE("VirtualMass: a second law in the null space, a posture: the tool is not disturbed") {
  for_each_robot([](const char* name, const auto& robot) {
    CAPTURE(std::string(name));
    const double below = disturbance(robot, 0, [](const JointPosition<6>&, Seeded& random) {
      return task_priority<5>(Push(), Push(random.vector<JointTorque<6>>(0.2)),
                              {.keeps = Keeps::point, .heaviest = 1e6, .zone = 1});
    });
    CHECK(below < 1e-7);  // differences of poses
    const double posture = disturbance(robot, 0, [](const JointPosition<6>& q, Seeded& random) {
      return NullSpacePosture<6, 5>(at_flange, q + random.vector<JointPosition<6>>(0.5), 3, 5,
                                    SingularityDamping<double>(1e-6)) +
             GravityControl{};
    });
    CHECK(posture < 1e-7);
    MESSAGE(std::string(name) << ": null space " << below << ", posture " << posture << " m/rad");
  });
}

TEST_CASE("VirtualMass: damping beside the yielding directions of a tool does not brake the tool") {
  for_each_robot([](const char* name, const auto& robot) {
    CAPTURE(std::string(name));
    const double worst = disturbance(robot, 0.3, [](const JointPosition<6>&, Seeded&) {
      return SkinCartesianControl<5, Tool, double, Yields::translation, DampedNullSpace>(
                 at_flange, 20, SingularityDamping<double>(1e-6)) +
             GravityControl{};
    });
    // M at the start of the sub-step against M at its middle: first order in 0.3 rad/s * 1 ms.
    CHECK(worst < 3e-3);
  });
}

// A damper that would stop the joints of the model within a sub-step stops those of the virtual robot.
TEST_CASE("VirtualMass: a stiff damper of an impedance stops the robot that it moves") {
  Seeded random(5);
  JointImpedance<6>::Settings settings;
  settings.stiffness = settings.uniform(0);
  settings.damping = settings.uniform(1e5);
  const JointImpedance<6> law(settings);
  for_each_robot([&](const char* name, const auto& robot) {
    CAPTURE(std::string(name));
    for (int k = 0; k < 20; ++k) {
      const State<6> from{0ns, regular(random), random.vector<JointVelocity<6>>(0.02)};
      const auto left = after_step(robot, law, from);
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(left[i]) < 1e-3);
    }
  });
}

TEST_CASE("VirtualMass: what laws read is the inertia by which the resolver accelerates") {
  Seeded random(7);
  for_each_robot([&](const char* name, const auto& robot) {
    CAPTURE(std::string(name));
    const auto resolver = resolver_of(robot);
    const Skin untouched;
    for (int k = 0; k < 20; ++k) {
      const State<6> from{0ns, regular(random), {}};
      const auto tau = random.vector<JointTorque<6>>(0.1);
      const auto known = resolver.template known<Reads>(from, 0.002, untouched);
      const auto dv = after_step(robot, Push(tau), from);
      JointAcceleration<6> a;
      for (std::size_t i = 0; i < 6; ++i) a[i] = dv[i] / 0.002;
      const JointTorque<6> back = known.mass() * a;
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(back[i] - tau[i]) < 1e-9);
      const auto given = known.mass_factors().solve(tau);
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(0.002 * given[i] - dv[i]) < 1e-9);
    }
  });
}
