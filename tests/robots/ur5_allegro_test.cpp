#include "skinctl/robots/ur5_allegro.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/worst_torque.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::array<double, 9> upright{1, 0, 0, 0, 1, 0, 0, 0, 1};

oracle::Robot arm_with_hand(bool left) {
  oracle::Robot hand = oracle::allegro(left);
  oracle::Body palm;
  palm.motion = oracle::Motion::fixed;
  palm.mass = 0.4154, palm.com = {0, 0, -0.0475}, palm.inertia = {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4};
  hand.bodies.push_back(palm);
  return oracle::joined(oracle::ur5(), 5, hand, upright, {0, 0, 0.0823 + 0.095});
}

}  // namespace

static_assert(RobotModel<ur5_allegro::Model<>> && ur5_allegro::Model<>::joints == 22);
static_assert(RobotModel<ur5_allegro::TwoModel<>> && ur5_allegro::TwoModel<>::joints == 44);
static_assert(ur5_allegro::TwoModel<>::parents[22] == -1 && ur5_allegro::TwoModel<>::parents[28] == 27);
static_assert(
    is_zero<decltype(std::declval<ur5_allegro::TwoModel<>>().number<23, LinkParameter::cos_alpha, double>())>,
    "the second arm's zeros are still types");

TEST_CASE("UR5 with an Allegro hand: KDL and MuJoCo agree") {
  CHECK(worst_torque(ur5_allegro::arm_with_hand(), oracle::without_fixed(arm_with_hand(false)), many_states,
                     7) <= 1e-12);
}

TEST_CASE("two UR5 with hands on one base: KDL and MuJoCo agree at 44 joints") {
  // Shoulders at the sides of a torso: each base turned out by a quarter about x, one further by 0.3 about z.
  const double s = std::sin(0.3), c = std::cos(0.3);
  const Stand right{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0, -0.2, 1.1}};
  const Stand left{{{c, s, 0}, {0, 0, 1}, {s, -c, 0}}, {0, 0.2, 1.1}};
  oracle::Robot bare;
  const auto table = oracle::joined(
      oracle::joined(bare, -1, arm_with_hand(false), {1, 0, 0, 0, 0, 1, 0, -1, 0}, {0, -0.2, 1.1}), -1,
      arm_with_hand(true), {c, 0, s, s, 0, -c, 0, 1, 0}, {0, 0.2, 1.1});
  CHECK(worst_torque(ur5_allegro::two_arms_with_hands(right, left), oracle::without_fixed(table), many_states,
                     7) <= 1e-12);
}
