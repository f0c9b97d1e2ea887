#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;

static_assert(std::is_empty_v<Weightless<ur5::Model>>);

TEST_CASE("Weightless: gravity is gone, and nothing else") {
  const ur5::Model heavy;
  const Weightless<ur5::Model> light(heavy);
  testing::Seeded rng(3);
  for (int k = 0; k < 100; ++k) {
    const auto q = rng.vector<JointPosition<6>>(3);
    const auto dq = rng.vector<JointVelocity<6>>(2);
    const auto ddq = rng.vector<JointAcceleration<6>>(5);
    CHECK(gravity_torque(light, q) == JointTorque<6>{});
    const auto difference =
        inverse_dynamics(heavy, q, dq, ddq) - gravity_torque(heavy, q) - inverse_dynamics(light, q, dq, ddq);
    for (const double d : difference) CHECK(std::abs(d) < 1e-12);
    const auto M = mass_matrix(heavy, q), m = mass_matrix(light, q);
    for (std::size_t i = 0; i < 36; ++i) CHECK(std::abs(M.data[i] - m.data[i]) < 1e-14);
  }
}
