// Two hands on one link are two contacts.
//
// Promise: two hands on one link are two contacts
// Tried: squeezed from both sides, each counts; the account of the passivity observer is that of both.
// Also: `tactile/pressed_area_test.cpp`

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

// At both ends of the forearm, on opposite sides: pushes on both turn it about the elbow.
const std::vector<PlacedCell<2>> cells{cell_at<2>(1, {-0.05, 0.05, 0}, {0, 1, 0}),
                                       cell_at<2>(2, {-0.35, -0.05, 0}, {0, -1, 0})};
template <class... Parts>
auto described(const Parts&... parts) {
  return by_position(ur5::Model{},
                     {.limits = limits_of<ur5::Description>(20.0),
                      .period = 8ms,
                      .delay = 8ms,
                      .lag = 8ms,
                      .virtual_damping = 4,
                      .viscous_friction = JointTorque<6>::constant(2),
                      .dead_band = JointPosition<6>::constant(0.02)},
                     parts...);
}
template <class... Parts>
auto yielding(const Parts&... parts) {
  return Cycle(described(parts...), open_skin(Patch<2, 2>(cells, open_gains)),
               SkinJointControl{} + GravityControl{});
}

/// How far the elbow turns within a second of constant pushes [rad].
template <class Scene>
double turned(const Scene& scene, double first, double second) {
  TouchedArm<2, Scene> arm(scene, cells, pose, 0.008, 0.008);
  while (arm.time() < 1)
    arm.step(8ms, [&](std::size_t k, const CellAt&) { return CellTouch{.force = k == 0 ? first : second}; });
  return std::abs(arm.q()[2] - pose[2]);
}

}  // namespace

TEST_CASE("PassivityObserver: two hands that twist a link lead it, and the account is that of both") {
  const PassivityObserver<> observer({.start = 0.5, .max = 10, .stiffness = 3e3});
  const auto scene = yielding(observer);
  TouchedArm<2, std::remove_cv_t<decltype(scene)>> arm(scene, cells, pose, 0.008, 0.008);
  const double free = turned(yielding(), 11, 12);
  while (arm.time() < 1)
    arm.step(8ms, [&](std::size_t k, const CellAt&) { return CellTouch{.force = k == 0 ? 11.0 : 12.0}; });
  CHECK(std::abs(arm.q()[2] - pose[2]) == doctest::Approx(free).epsilon(1e-9));
  const double energy = arm.memory().robot.passivity.template of<PassivityObserver<>>().energy;
  CHECK(energy - 0.5 == doctest::Approx(-arm.given[0] - arm.given[1]).epsilon(0.02));
}

TEST_CASE("LinkContact: a link that is squeezed from both sides is touched by each") {
  const LinkContact<2> contact{
      .region = {.force = 40, .blow = 60, .first = 100ms, .stiffness = 2e4, .mass = 4, .power = 100},
      .reach = 0.5,
      .reaction_time = 20ms};
  const auto scene = yielding().with(contact);
  for (const bool strong : {false, true}) {
    TouchedArm<2, std::remove_cv_t<decltype(scene)>> arm(scene, cells, pose, 0.008, 0.008);
    while (arm.time() < 0.5)
      arm.step(8ms, [&](std::size_t, const CellAt&) { return CellTouch{.force = strong ? 50.0 : 30.0}; });
    CHECK(arm.status.has(Reason::contact_force) == strong);
  }
}
