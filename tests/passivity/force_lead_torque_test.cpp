// Contacts that ring, of joints by torque.
//
// Promise: a contact of joints by torque comes to rest by the force lead
// Tried: a finger on 3 kN/m, answered a cycle late: swings by 112 N alone and 115 N in groups, with the
// lead below 0.01 N

#include <doctest/doctest.h>

#include "skinctl/resolver/resolver_of.hpp"
#include "tests/support/arm_with_finger.hpp"
#include "tests/support/grouped_plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Model3 = ArmWithFingerModel;

// The contact of a finger tip in place of a skin.
struct TipTouch {
  using scalar = double;
  Contacts<3, double, 1> contacts;
};
TipTouch led_by(const TipTouch& touch, const double& share, const TipTouch& change) noexcept {
  TipTouch out = touch;
  out.contacts.list[0].force += share * change.contacts.list[0].force;
  return out;
}
template <class M, class A>
JointTorque<3> skin_torque(const M&, const A&, const TipTouch& touch) noexcept {
  JointTorque<3> tau;
  for (const auto& c : touch.contacts)
    for (std::size_t i = 0; i < 3; ++i) tau[i] -= c.force * c.row[i];
  return tau;
}

// Answers touch, holds the arm, and presses the finger against what is there.
struct Press {
  struct Memory {};
  static constexpr Needs needs{.angles = true, .gravity = true, .touch = true};
  static constexpr LawRole role = LawRole::reactive;
  JointPosition<3> goal;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<3> torque(const Memory&, const K& known) const noexcept {
    auto tau = skin_torque(known.model(), known.angles(), known.touch()) + known.gravity();
    for (std::size_t i = 0; i < 2; ++i) tau[i] += 200 * (goal[i] - known.q()[i]) - 20 * known.dq()[i];
    tau[2] += 1;
    return tau;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

struct Rings {
  double swing = 0, mean = 0;  ///< of the force in the last half second [N]
};

/// A wall of 3 kN/m at the finger tip; the force is answered a cycle late.
template <LinkMask ByTorque, class Robot>
Rings press(const Robot& robot) {
  const JointPosition<3> begin{0.2, 0.3, 0.5};
  GroupedPlant<Model3, ByTorque, 0b111u & ~ByTorque> plant(Model3{}, begin, 0);
  const double row[3] = {0, 0.45, 0.1};
  const auto force = [&](const JointPosition<3>& q) {
    double depth = -0.002;
    for (std::size_t i = 0; i < 3; ++i) depth += row[i] * (q[i] - begin[i]);
    return depth > 0 ? 3000 * depth : 0.0;
  };
  auto memory = robot.start({0ns, begin, {}});
  const Press law{begin};
  Press::Memory law_memory;
  TouchChange<TipTouch>::Memory change{};
  Rings out;
  double least = 1e9, most = 0, sum = 0;
  for (int k = 1; k <= 2000; ++k) {
    const Nanoseconds now = k * 1ms;
    plant.command(memory.command());
    plant.run(1e-3, 20, [&](const auto& q, const auto&) {
      JointTorque<3> push;
      for (std::size_t i = 0; i < 3; ++i) push[i] = -force(q) * row[i];
      return push;
    });
    TipTouch touch;
    touch.contacts.count = 1;
    auto& c = touch.contacts.list[0];
    c.link = 2, c.force = force(plant.q()), c.normal = {0, 0, 1};
    std::copy(std::begin(row), std::end(row), c.row);
    const TipTouch touches[max_substeps] = {touch, touch, touch, touch};
    const TipTouch changes[1] = {TouchChange<TipTouch>::next(change, touch)};
    static_cast<void>(robot.step(memory, law, law_memory, State<3>{now, plant.q(), plant.dq()},
                                 robot.interval(memory, now), std::span<const TipTouch>(touches), AnyState{},
                                 PressedUnknown{}, changes));
    if (k <= 1500) continue;
    least = std::min(least, c.force), most = std::max(most, c.force), sum += c.force;
  }
  out.swing = most - least;
  out.mean = sum / 500;
  return out;
}
template <std::size_t N>
RobotConfiguration<N> configuration(std::optional<Nanoseconds> lead) {
  return {.limits = JointLimits<N>({.lower = JointPosition<N>::constant(-3),
                                    .upper = JointPosition<N>::constant(3),
                                    .velocity = JointVelocity<N>::constant(20),
                                    .acceleration = JointAcceleration<N>::constant(1e3),
                                    .torque = JointTorque<N>::constant(150)}),
          .period = 1ms,
          .force_lead = lead,
          .substep = 1ms};
}
Rings by_torque_alone(std::optional<Nanoseconds> lead) {
  return press<0b111>(resolver_of(by_torque(Model3{}, configuration<3>(lead))));
}
Rings in_groups(std::optional<Nanoseconds> lead) {
  auto arm = configuration<2>(lead);
  arm.virtual_damping = 0;
  arm.viscous_friction = {10, 10};
  return press<0b100>(resolver_of(
      by_groups(Model3{}, velocity_joints<0b011>(arm), torque_joints<0b100>(configuration<1>(lead)))));
}

}  // namespace

TEST_CASE("Force lead: a finger by torque that rings on a wall comes to rest on it, alone and on an arm") {
  // 1 N m on a lever of 0.1 m, of which the answer to touch gives half.
  for (const auto& [bare, led] : {std::pair{by_torque_alone(0ns), by_torque_alone(std::nullopt)},
                                  std::pair{in_groups(0ns), in_groups(std::nullopt)}}) {
    MESSAGE("swings by " << bare.swing << " N, with the touch a period ahead by " << led.swing << " N");
    CHECK(bare.swing > 50);
    CHECK(led.swing < 0.01);
    CHECK(led.mean == doctest::Approx(5).epsilon(1e-3));
  }
}
