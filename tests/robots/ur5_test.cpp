#include "skinctl/robots/ur5.hpp"

#include <doctest/doctest.h>

#include "tests/support/robots.hpp"

using namespace skinctl;

TEST_CASE("UR5: the model is the table that was entered from the maker's sources by other hands") {
  const auto robot = testing::ur5_robot();
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& l = ur5::Description::links[i];
    const auto& b = robot.table.bodies[i];
    CAPTURE(i);
    CHECK(l[LinkParameter::mass] == b.mass);
    CHECK(l[LinkParameter::c_x] == doctest::Approx(b.com[0]).epsilon(1e-14));
    CHECK(l[LinkParameter::c_y] == doctest::Approx(b.com[1]).epsilon(1e-14));
    CHECK(l[LinkParameter::c_z] == doctest::Approx(b.com[2]).epsilon(1e-14));
    CHECK(l[LinkParameter::s_yy] + l[LinkParameter::s_zz] == doctest::Approx(b.inertia[0]).epsilon(1e-12));
    CHECK(l[LinkParameter::s_xx] + l[LinkParameter::s_zz] == doctest::Approx(b.inertia[4]).epsilon(1e-12));
    CHECK(l[LinkParameter::s_xx] + l[LinkParameter::s_yy] == doctest::Approx(b.inertia[8]).epsilon(1e-12));
    CHECK_NOTHROW(check_link(l));
  }
}

TEST_CASE("UR5: limits are ordered") {
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(ur5::Description::lower[i] < ur5::Description::upper[i]);
    CHECK(ur5::Description::max_torque[i] > 0);
  }
}
