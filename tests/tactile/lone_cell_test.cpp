// Promise: what one cell alone may count up to holds in every pose
// Tried: 300 poses: no joint gets more than 0.9 of its Coulomb friction

#include "skinctl/tactile/lone_cell.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/robot/robot_description.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "tests/support/random_skin.hpp"
#include "tests/support/sliding_robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Largest share of its friction that each cell's lone force gives a joint, of `poses` random poses.
template <class Patches>
std::vector<double> largest_shares(const Patches& patches, const JointTorque<6>& coulomb, int poses) {
  const auto force = lone_forces(ur5::Model{}, coulomb, cell_places(patches), 0.9);
  std::vector<double> most(force.size());
  Random rng = seeded(3);
  for (int pose = 0; pose < poses; ++pose) {
    const auto at = link_poses(ur5::Model{}, random_position<6, double>(rng));
    std::size_t i = 0;
    for_each_index<6>([&](auto k) {
      for (const auto& cell : std::get<k.value>(patches).placed()) {
        const auto tau = torque_of_cell<k.value>(at, ur5::Model{}, cell.X_LC, force[i]);
        for (std::size_t j = 0; j < 6; ++j) most[i] = std::max(most[i], std::abs(tau[j]) / coulomb[j]);
        ++i;
      }
    });
  }
  return most;
}

}  // namespace

TEST_CASE("lone_forces: in no pose does one cell's lone force give a joint more than its share of friction") {
  const auto shares = largest_shares(ur5::skin_patches<60>(), {7.5, 7.5, 7.5, 1.4, 1.4, 1.4}, 300);
  REQUIRE(shares.size() == 60);
  double worst = 0, best = 0;
  for (const double share : shares) worst = std::max(worst, share), best = best + share / 60;
  CHECK(worst <= 0.9 * (1 + 1e-9));
  CHECK(worst > 0.7);  // the bound is reached somewhere
  CHECK(best > 0.35);  // and is no factor of three too small on average
}

TEST_CASE("lone_forces: cells anywhere that look anywhere, each joint the weak one in turn") {
  Random rng = seeded(7);
  for (std::size_t weak = 0; weak < 6; ++weak) {
    CAPTURE(weak);
    const auto patches = random_patches(rng, {}, std::index_sequence<0, 1, 2, 3, 4, 5>{},
                                        std::index_sequence<8, 8, 8, 8, 8, 8>{});
    JointTorque<6> coulomb = JointTorque<6>::constant(20);
    coulomb[weak] = 1;
    const auto shares = largest_shares(patches, coulomb, 100);
    const double worst = *std::max_element(shares.begin(), shares.end());
    CHECK(worst <= 0.9 * (1 + 1e-9));
    CHECK(worst > 0.8);
    // Of the next link, whose joint stands still where this one's does not.
    if (weak < 5) {
      const auto next = shares.begin() + 8 * static_cast<std::ptrdiff_t>(weak + 1);
      CHECK(*std::max_element(next, next + 8) > 0.6);
    }
  }
}

TEST_CASE("lone_forces: of a described robot, by its Coulomb friction; wrong numbers are refused") {
  const auto places = cell_places(ur5::skin_patches<60>());
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 0};
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

TEST_CASE(
    "lone_forces: of an arm on wheels: the base slides under no lone cell; a slide behind a turn is "
    "refused") {
  using Tree = ChainOf<slides, slides, turns, turns>;
  auto links = on_wheels<Tree>(40);
  links[3].R = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  links[3].p[2] = 0.5;
  links[3].inertia = {2, {0.2, 0, 0}, 0.01, 0.01, 0.01};
  const auto model = model_of<Tree>(links);
  const JointTorque<4> coulomb{12, 12, 5, 6};
  Random rng = seeded(5);
  double largest[4] = {};
  for (int k = 0; k < 2000; ++k) {
    const auto unit = [&] { return uniform(rng, -1.0, 1.0); };
    const Xyz<double> way{unit(), unit(), unit()}, normal = (1 / norm(way)) * way;
    const CellPlace cell{.link = 3, .place = {0.4 * unit(), 0.1 * unit(), 0.1 * unit()}, .normal = normal};
    const double force = lone_forces(model, coulomb, std::span(&cell, 1))[0];
    const JointPosition<4> q{5 * unit(), 5 * unit(), 3 * unit(), 3 * unit()};
    const auto poses = link_poses(model, q);
    const Rotation<double> R = poses.get<3>().axes();
    const Xyz<double> F = force * (R * normal), N = force * (R * cross(cell.place, normal));
    const auto tau = transpose(jacobian<3>(poses)) * Wrench<Link<3>, Link<3>, Base>{F, N};
    for (std::size_t j = 0; j < 4; ++j) largest[j] = std::max(largest[j], std::abs(tau[j]) / coulomb[j]);
  }
  for (const double share : largest) CHECK(share <= 0.9 * (1 + 1e-9));
  CHECK(*std::max_element(largest, largest + 4) > 0.7);

  const CellPlace outside{.link = 2};
  CHECK_THROWS_AS(
      static_cast<void>(lone_forces(cylindrical(), JointTorque<3>{1, 1, 1}, std::span(&outside, 1))),
      ConfigurationError);
}
