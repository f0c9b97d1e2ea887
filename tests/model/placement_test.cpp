#include "skinctl/model/placement.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/kinematics/poses.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;

namespace {
Rotation<double> product(const detail::Zxz& z) {
  const double c = std::cos(z.beta), s = std::sin(z.beta);
  const Rotation<double> G{{z.gamma.cos, z.gamma.sin, 0}, {-z.gamma.sin, z.gamma.cos, 0}, {0, 0, 1}};
  const Rotation<double> A{{1, 0, 0}, {0, z.alpha.cos, z.alpha.sin}, {0, -z.alpha.sin, z.alpha.cos}};
  const Rotation<double> B{{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  return G * A * B;
}
double difference(const Rotation<double>& R, const Rotation<double>& S) {
  double worst = 0;
  for (const auto& [u, v] : {std::pair{R.x, S.x}, std::pair{R.y, S.y}, std::pair{R.z, S.z}})
    worst = std::max({worst, std::abs(u.x - v.x), std::abs(u.y - v.y), std::abs(u.z - v.z)});
  return worst;
}
}  // namespace

TEST_CASE(
    "placement: Rz(gamma) Rx(alpha) Rz(beta) gives back every rotation, axes nearly parallel included") {
  oracle::Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const auto r = random.rotation();
    const Rotation<double> R{{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
    CHECK(difference(product(detail::decompose_zxz(R)), R) <= 1e-15);
  }
  for (double tilt : {0.0, 1e-300, 1e-17, 1e-16, 1e-15, 1e-12, 1e-8, 1e-4}) {
    for (double pole : {0.0, 3.141592653589793}) {
      const Rotation<double> R = exp_so3(Xyz<double>{0.0, 0.0, 0.7}) * exp_so3(Xyz<double>{pole, 0.0, 0.0}) *
                                 exp_so3(Xyz<double>{tilt, tilt, 0.0});
      CAPTURE(tilt);
      CAPTURE(pole);
      CHECK(difference(product(detail::decompose_zxz(R)), R) <= 1e-15);
    }
  }
}

TEST_CASE("placement: right angles stay exact, so that models can fold them") {
  const Rotation<double> y_to_z{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  const auto z = detail::decompose_zxz(y_to_z);
  CHECK(z.alpha.cos == 0);
  CHECK(z.alpha.sin == -1);
  CHECK(z.gamma.cos == 1);
  CHECK(z.gamma.sin == 0);
  CHECK(z.beta == 0);
}

TEST_CASE("placement: first children need no gamma, whatever the file says") {
  const auto robot = testing::random_robot<testing::MixedTree>("mixed tree", 5);
  for (std::size_t i : {std::size_t(1), std::size_t(2), std::size_t(4), std::size_t(6), std::size_t(8)})
    CHECK(robot.model.link(i)[LinkParameter::sin_gamma] == 0);
  CHECK(robot.model.link(3)[LinkParameter::sin_gamma] != 0);  // the second child of link 1
}

TEST_CASE("placement: axes that are no rotation are refused") {
  std::array<PlacedLink, 1> bad{};
  bad[0].R.x.x = 1.001;
  CHECK_THROWS_AS(static_cast<void>(canonical_links<Chain<1>>(bad)), ConfigurationError);
}
