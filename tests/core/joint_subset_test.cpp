#include "skinctl/core/joint_subset.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

using Fingers = JointSubset<6, 0b101010>;
static_assert(Fingers::count == 3 && Fingers::index == std::array<std::size_t, 3>{1, 3, 5});
static_assert(Fingers::Others::index == std::array<std::size_t, 3>{0, 2, 4});
static_assert(std::is_same_v<Fingers::Others::Others, Fingers>);
static_assert(joints_between(2, 5) == 0b11100 && joints_between(3, 3) == 0);
static_assert(joints_between(0, 64) == ~LinkMask(0));
static_assert(JointSubset<64, ~LinkMask(0)>::count == 64 &&
              JointSubset<64, ~LinkMask(0)>::Others::count == 0);

TEST_CASE("JointSubset: takes its joints out and puts them back, and touches no other") {
  const JointTorque<6> whole{0, 1, 2, 3, 4, 5};
  const JointTorque<3> part = Fingers::of(whole);
  CHECK(part == JointTorque<3>{1, 3, 5});
  CHECK(Fingers::Others::of(whole) == JointTorque<3>{0, 2, 4});
  JointTorque<6> other = JointTorque<6>::constant(9);
  Fingers::put(part, other);
  CHECK(other == JointTorque<6>{9, 1, 9, 3, 9, 5});
  Fingers::Others::put(Fingers::Others::of(whole), other);
  CHECK(other == whole);
}
