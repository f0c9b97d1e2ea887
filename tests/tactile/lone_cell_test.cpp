#include "skinctl/tactile/lone_cell.hpp"

#include <doctest/doctest.h>

#include "skinctl/model/ur5.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/tactile/ur5_skin.hpp"
#include "skinctl/testing/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("lone_forces: in no pose does one cell's lone force give a joint more than its share of friction") {
  const auto patches = ur5::skin_patches<60>();
  const auto places = cell_places(patches);
  const JointTorque<6> coulomb{7.5, 7.5, 7.5, 1.4, 1.4, 1.4};
  const auto force = lone_forces(ur5::Model{}, coulomb, places, 0.9);
  REQUIRE(force.size() == 60);
  Random rng = seeded(3);
  double worst = 0, best = 0;
  std::array<double, 60> most{};
  for (int pose = 0; pose < 300; ++pose) {
    const auto poses = link_poses(ur5::Model{}, random_position<6, double>(rng));
    std::size_t i = 0;
    for_each_index<6>([&](auto k) {
      for (const auto& cell : std::get<k.value>(patches).placed()) {
        const auto tau = torque_of_cell<k.value>(poses, ur5::Model{}, cell.X_LC, force[i]);
        for (std::size_t j = 0; j < 6; ++j) most[i] = std::max(most[i], std::abs(tau[j]) / coulomb[j]);
        ++i;
      }
    });
  }
  for (const double share : most) worst = std::max(worst, share), best = best + share / 60;
  CHECK(worst <= 0.9 * (1 + 1e-9));
  CHECK(worst > 0.7);  // the bound is reached somewhere
  CHECK(best > 0.35);  // and is no factor of three too small on average
}

TEST_CASE("lone_forces: of a described robot, by its Coulomb friction; wrong numbers are refused") {
  const auto places = cell_places(ur5::skin_patches<60>());
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0), .period = 8ms};
  c.coulomb_friction = {7.5, 7.5, 7.5, 1.4, 1.4, 1.4};
  CHECK(lone_forces(by_position(ur5::Model{}, c), places) ==
        lone_forces(ur5::Model{}, c.coulomb_friction, places));
  c.coulomb_friction[0] = 0;  // carries every cell
  for (const double f : lone_forces(by_position(ur5::Model{}, c), places)) CHECK(f == 0);
  const JointTorque<6> some{1, 1, 1, 1, 1, 1};
  CHECK_THROWS_AS(static_cast<void>(lone_forces(ur5::Model{}, some, places, 1.1)), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(lone_forces(ur5::Model{}, some, places, 0.0)), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(lone_forces(ur5::Model{}, JointTorque<6>{1, 1, -1, 1, 1, 1}, places)),
                  ConfigurationError);
  std::vector<CellPlace> beyond{CellPlace{.link = 6}};
  CHECK_THROWS_AS(static_cast<void>(lone_forces(ur5::Model{}, some, beyond)), ConfigurationError);
}
