#include "skinctl/calibration/link_inertia.hpp"

#include <doctest/doctest.h>

#include "examples/worlds/other_bodies.hpp"
#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("A link with another inertia: it says these ten numbers, and stays where it is") {
  const auto maker = calibrated_from<ur5::Description>();
  auto rng = seeded(4);
  for (std::size_t link = 0; link < 6; ++link) {
    CAPTURE(link);
    detail::fit::Inertia10 own;
    const auto theta = inertial_parameters(maker);
    for (std::size_t k = 0; k < 10; ++k) own(Eigen::Index(k)) = theta.data[10 * link + k];
    const detail::fit::Inertia10 other = other_body(own, rng);
    decltype(maker)::Links links;
    for (std::size_t i = 0; i < 6; ++i) links[i] = maker.link(i);
    links[link] = with_inertia(maker.link(link), other.data());
    const auto found = inertial_parameters(CalibratedModel<Chain<6>>(links));
    for (std::size_t k = 0; k < 60; ++k)
      CHECK(found.data[k] ==
            doctest::Approx(k / 10 == link ? other(Eigen::Index(k % 10)) : theta.data[k]).epsilon(1e-9));
    CHECK(links[link][LinkParameter::p_x] == maker.link(link)[LinkParameter::p_x]);
    CHECK(links[link][LinkParameter::cos_alpha] == maker.link(link)[LinkParameter::cos_alpha]);
  }
}

TEST_CASE("Other bodies: each can exist, and is off by a tenth to a quarter") {
  detail::fit::Inertia10 body;  // 3 kg, a box about (0.1, 0, 0.05)
  body << 3, 0.3, 0, 0.15, 0.02, 0.05, 0.045, 0, -0.015, 0;
  auto rng = seeded(5);
  double least = 1e9, most = 0;
  for (int n = 0; n < 1000; ++n) {
    const detail::fit::Inertia10 other = other_body(body, rng);
    CHECK(detail::SymmetricEigen(detail::fit::pseudo_inertia(other)).values(0) > 0);
    least = std::min(least, other(0) / body(0)), most = std::max(most, other(0) / body(0));
    CHECK((other.segment<3>(1) / other(0) - body.segment<3>(1) / body(0)).norm() < 0.25 * 0.15);
  }
  CHECK(least > 0.75);
  CHECK(least < 0.82);
  CHECK(most < 1.3);
  CHECK(most > 1.22);
}
