#include "skinctl/dynamics/mass_ratio.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "skinctl/model/loaded.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {
using Arm = Loaded<ur5::Model, 5>;
Arm carrying(double mass) {
  return Arm(ur5::Model{}, {.mass = mass, .c = {0, 0, 0.1}, .xx = 0.01, .yy = 0.01, .zz = 0.01});
}
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
    Eigen::Matrix<double, 6, 6> a, b;
    const auto heavy = mass_matrix(carrying(3), q), light = mass_matrix(ur5::Model{}, q);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const double rotor = i == j ? rotors[std::size_t(i)] : 0;
        a(i, j) = heavy(std::size_t(i), std::size_t(j)) + rotor;
        b(i, j) = light(std::size_t(i), std::size_t(j)) + rotor;
      }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(a, b);
    largest = std::max(largest, solver.eigenvalues()(5));
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

TEST_CASE("mass_ratio: infinite where the light robot has no inertia, or nothing is a number") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isinf(mass_ratio(ur5::Model{}, ur5::Model{}, JointTorque<6>::constant(nan))));
}
