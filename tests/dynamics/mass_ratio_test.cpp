#include "skinctl/dynamics/mass_ratio.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/model/loaded.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/largest_eigenvalue.hpp"

using namespace skinctl;

namespace {
using Arm = Loaded<ur5::Model, 5>;
Arm carrying(double mass) {
  return Arm(ur5::Model{}, {.mass = mass, .c = {0, 0, 0.1}, .xx = 0.01, .yy = 0.01, .zz = 0.01});
}
/// A bar that swings about a horizontal axis.
struct Bar {
  static constexpr std::size_t joints = 1;
  static constexpr auto parents = chain_parents<1>();
  static constexpr auto kinds = all_of_kind<1>(JointKind::revolute);
  static constexpr double gravity[3] = {0, -9.81, 0};
  static constexpr std::array<LinkParameters<double>, 1> links = {
      make_link({.p = {0, 0, 0}}, {2, {0.25, 0, 0}, 0.01, 0.05, 0.05})};
};
}  // namespace

TEST_CASE("mass_ratio: the largest eigenvalue over its poses, as Eigen finds it") {
  const JointTorque<6> rotors{0.1, 0.2, 0.1, 0.05, 0.05, 0.02};
  double largest = 1;
  std::uint64_t bits = 1;
  for (int pose = 0; pose < 64; ++pose) {
    JointPosition<6> q;
    for (double& angle : q) {
      bits = bits * 6364136223846793005u + 1442695040888963407u;
      angle = (static_cast<double>(bits >> 32) / 4294967296.0 - 0.5) * 6.2832;
    }
    testing::Matrix66 a, b;
    const auto heavy = mass_matrix(carrying(3), q), light = mass_matrix(ur5::Model{}, q);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const double rotor = i == j ? rotors[std::size_t(i)] : 0;
        a(i, j) = heavy(std::size_t(i), std::size_t(j)) + rotor;
        b(i, j) = light(std::size_t(i), std::size_t(j)) + rotor;
      }
    largest = std::max(largest, testing::largest_eigenvalue(a, b));
  }
  const double found = mass_ratio(carrying(3), ur5::Model{}, rotors);
  CHECK(largest > 2);
  CHECK(found >= largest * (1 - 1e-9));
  CHECK(found <= largest * 1.0021);
}

TEST_CASE("mass_ratio: 1 for the same robot and for one that is heavier than told; rotors bound it") {
  const JointTorque<6> none{}, rotors = JointTorque<6>::constant(0.1);
  CHECK(mass_ratio(ur5::Model{}, ur5::Model{}, none) == 1);
  CHECK(mass_ratio(ur5::Model{}, carrying(5), none) == 1);
  CHECK(mass_ratio(carrying(5), ur5::Model{}, none) > 20);
  CHECK(mass_ratio(carrying(5), ur5::Model{}, rotors) < 5);
  CHECK(mass_ratio(carrying(5), ur5::Model{}, rotors) > mass_ratio(carrying(2), ur5::Model{}, rotors));
  const JointTorque<6, float> in_float = JointTorque<6, float>::constant(0.1f);
  CHECK(std::abs(mass_ratio(Loaded<ur5::Model, 5, float>(ur5::Model{}, {.mass = 2, .c = {0, 0, 0.1}}),
                            ur5::Model{}, in_float) -
                 mass_ratio(Arm(ur5::Model{}, {.mass = 2, .c = {0, 0, 0.1}}), ur5::Model{}, rotors)) < 0.02);
}

TEST_CASE("gravity_rate: of a bar with a load, both by hand; nothing for the same robot") {
  const StaticModel<Bar> bar;
  using Loaded1 = Loaded<StaticModel<Bar>, 0>;
  const Loaded1 heavy(bar, {.mass = 3, .c = {0.5, 0, 0}, .xx = 0, .yy = 0.01, .zz = 0.01});
  const double M = 0.05 + 2 * 0.25 * 0.25 + 0.01 + 3 * 0.25;
  const JointTorque<1> rotors = JointTorque<1>::constant(0.2);
  // Of 64 poses one is nearly hanging or upright.
  const double found = gravity_rate(heavy, Loaded1(bar, {}), rotors), by_hand = 3 * 9.81 * 0.5 / (M + 0.2);
  CHECK(found <= 1.002 * by_hand);
  CHECK(found >= 0.98 * by_hand);
  CHECK(gravity_rate(heavy, heavy, rotors) < 2e-3);
  // The other way round the torque is made for the light arm.
  const double light = 0.05 + 2 * 0.25 * 0.25;
  CHECK(gravity_rate(Loaded1(bar, {}), heavy, rotors) ==
        doctest::Approx(found * (M + 0.2) / (light + 0.2)).epsilon(3e-3));
  const JointTorque<6> six = JointTorque<6>::constant(0.1);
  CHECK(gravity_rate(carrying(5), ur5::Model{}, six) > gravity_rate(carrying(2), ur5::Model{}, six));
  CHECK(gravity_rate(Loaded<ur5::Model, 5, float>(ur5::Model{}, {.mass = 2, .c = {0, 0, 0.1}}), ur5::Model{},
                     JointTorque<6, float>::constant(0.1f)) ==
        doctest::Approx(gravity_rate(Arm(ur5::Model{}, {.mass = 2, .c = {0, 0, 0.1}}), ur5::Model{}, six))
            .epsilon(1e-2));
}

TEST_CASE("mass_ratio: infinite where the light robot has no inertia, or nothing is a number") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isinf(mass_ratio(ur5::Model{}, ur5::Model{}, JointTorque<6>::constant(nan))));
}

TEST_CASE("inertia_range: of the same poses and of the rotors; a load adds to it") {
  const auto of = [](const auto& arm, double rotor) {
    return inertia_range(arm, JointTorque<6>::constant(rotor));
  };
  const auto bare = of(ur5::Model{}, 0), with_rotors = of(ur5::Model{}, 0.1), loaded = of(carrying(3), 0);
  // All links stretched, by hand: the shoulder about its vertical axis has no less than folded.
  const auto stretched = mass_matrix(ur5::Model{}, JointPosition<6>{});
  for (std::size_t i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(with_rotors.most[i] == doctest::Approx(bare.most[i] + 0.1));
    CHECK(with_rotors.least[i] == doctest::Approx(bare.least[i] + 0.1));
    CHECK(loaded.most[i] > bare.most[i]);
    CHECK(bare.most[i] > 0.9 * stretched(i, i));
    CHECK(bare.least[i] > 0);
    CHECK(bare.least[i] <= 1.001 * stretched(i, i));
  }
  // The last joint has one link about its axis, whatever the pose; the first one folds its arm.
  CHECK(bare.least[5] == doctest::Approx(bare.most[5]));
  CHECK(bare.least[0] < 0.2 * bare.most[0]);
}
