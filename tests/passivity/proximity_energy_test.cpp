// What is seen is no contact: its torque is the controller's own, and is paid for.
#include <doctest/doctest.h>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::array<double, 6> pose{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};

// Two cells on opposite sides of the forearm.
const std::vector<PlacedCell<2>> cells{cell_at<2>(1, {-0.2, 0, 0.06}, {0, 0, 1}),
                                       cell_at<2>(2, {-0.2, 0, -0.06}, {0, 0, -1})};
template <class... Parts>
auto yielding(const CellGains& gains, const Parts&... parts) {
  const auto robot = by_position(ur5::Model{},
                                 {.limits = limits_of<ur5::Description>(20.0),
                                  .period = 8ms,
                                  .delay = 8ms,
                                  .lag = 8ms,
                                  .virtual_damping = 4,
                                  .viscous_friction = JointTorque<6>::constant(2),
                                  .dead_band = JointPosition<6>::constant(0.02)},
                                 parts...);
  return Cycle(robot, open_skin(Patch<2, 2>(cells, gains)), SkinJointControl{} + GravityControl{});
}

/// A hand 4 mm in front of one cell, and a wall of `stiffness` at the other one.
template <class... Parts>
auto pushed_into_a_wall(double stiffness, const Parts&... parts) {
  const auto scene = yielding(open_gains, parts...);
  TouchedArm<2, std::remove_cv_t<decltype(scene)>> arm(scene, cells, pose, 0.008, 0.008);
  while (arm.time() < 4)
    arm.step(8ms, [&](std::size_t k, const CellAt& at) {
      return k == 0 ? CellTouch{.proximity = at.time < 3 ? 0.9 : 0}
                    : CellTouch{.force = std::max(0.0, stiffness * at.out)};
    });
  return arm;
}

}  // namespace

TEST_CASE("Proximity is paid for: a hand at 4 mm lets a wall have what tank and account hold, no more") {
  constexpr double energy = 0.05;
  const EnergyTank<> tank({.start = energy, .max = energy});
  for (const double stiffness : {200.0, 500.0, 3000.0}) {
    CAPTURE(stiffness);
    const auto free = pushed_into_a_wall(stiffness);
    if (stiffness < 1000) CHECK(free.extracted > 0.5);  // what it would get
    const auto kept = pushed_into_a_wall(
        stiffness, tank, PassivityObserver<>({.start = energy, .max = energy, .stiffness = 3000}));
    CHECK(kept.extracted <= energy);
    CHECK((kept.status.has(Reason::tank_empty) || kept.status.has(Reason::energy_held)));
    CHECK(kept.extracted > 0.1 * energy);
    // Each alone: behind a delay of 24 ms the tank sees another contact than the real arm.
    const auto paid = pushed_into_a_wall(stiffness, tank);
    CHECK(paid.extracted <= 1.2 * energy);
    const auto booked = pushed_into_a_wall(
        stiffness, PassivityObserver<>({.start = energy, .max = energy, .stiffness = 3000}));
    CHECK(booked.extracted <= energy);
  }
}

TEST_CASE("LinkContact: with a separation, what is seen slows an arm whose tank is empty") {
  const LinkContact<2> contact{
      .region = {.force = 40, .blow = 40, .first = 500ms, .stiffness = 2e4, .mass = 4, .power = 100},
      .reach = 0.5,
      .reaction_time = 20ms,
      .separation = Separation{.body_speed = 0, .reaction_time = 50ms, .deceleration = 2, .margin = 0.02},
      .range = 1};
  const auto scene =
      yielding({.force = newtons_per_unit}, EnergyTank<>({.start = 0, .max = 0})).with(contact);
  // A hand leads it towards somebody whom the cell on the other side sees.
  const auto led = [&](double proximity) {
    TouchedArm<2, std::remove_cv_t<decltype(scene)>> arm(scene, cells, pose, 0.008, 0.008);
    double fastest = 0;
    while (arm.time() < 1)
      arm.step(8ms, [&](std::size_t k, const CellAt& at) {
        fastest = std::max(fastest, k == 1 ? at.speed : 0.0);
        return k == 0 ? CellTouch{.force = 30} : CellTouch{.proximity = proximity};
      });
    return fastest;
  };
  const double far = led(0.3), near = led(0.99);
  CHECK(far > 0.15);
  CHECK(near < 0.5 * far);
  CHECK(near > 0.01);  // as slow as for a contact, not stopped
}
