#include "skinctl/dynamics/rotor_inertia.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("RotorInertia: on the diagonal of M by the square of the gear, in torque and energy alike") {
  const RotorInertia<2> rotors({1e-5, 2e-5}, {100, -50});
  CHECK(rotors[0] == doctest::Approx(0.1));
  CHECK(rotors[1] == doctest::Approx(0.05));
  MassMatrix<2> M;
  M(0, 0) = 2, M(1, 1) = 1, M(0, 1) = M(1, 0) = 0.5;
  const auto with = M + rotors;
  CHECK(with(0, 0) == doctest::Approx(2.1));
  CHECK(with(0, 1) == 0.5);
  const JointAcceleration<2> ddq{3, -4};
  const auto tau = with * ddq, parts = M * ddq + rotors * ddq;
  CHECK(tau[0] == doctest::Approx(parts[0]));
  CHECK(tau[1] == doctest::Approx(parts[1]));
  CHECK(kinetic_energy(rotors, JointVelocity<2>{1, 2}) == doctest::Approx(0.05 + 0.1));
  CHECK((M + RotorInertia<2>())(0, 0) == 2);
  CHECK_THROWS_AS(RotorInertia<2>({-1e-5, 0}, {100, 1}), ConfigurationError);
}
