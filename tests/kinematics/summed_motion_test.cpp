#include "skinctl/kinematics/summed_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/sliding_robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// The largest shares of the bounds that random motions of the origin of link `Ix` use.
template <std::size_t Ix, RobotModel M>
std::array<double, 2> shares_of_bounds(const M& model, double slides_by) {
  constexpr std::size_t n = M::joints;
  Random rng = seeded(17);
  double way = 0, bend = 0;
  const auto place = [&](const JointPosition<n>& q) {
    return link_poses(model, q).template get<Ix>().origin();
  };
  const auto velocity = [&](const JointPosition<n>& q, const JointVelocity<n>& u) {
    return (1 / 2e-6) * (place(integrate(q, u, 1e-6)) - place(integrate(q, u, -1e-6)));
  };
  // The largest distance from an axis that turns the point, over all of a motion.
  const auto reach_at = [&](const JointPosition<n>& q) {
    double reach = 0;
    const auto poses = link_poses(model, q);
    const auto p = place(q);
    [&]<std::size_t... J>(std::index_sequence<J...>) {
      const auto one = [&](auto j) {
        if (M::kinds[j] == JointKind::prismatic || ((ancestors<M>(Ix) >> j) & 1u) == 0) return;
        const Xyz<double> off = p - poses.template get<j.value>().origin();
        const Xyz<double> across = cross(poses.template get<j.value>().axis_z(), off);
        reach = std::max(reach, norm(across));
      };
      (one(std::integral_constant<std::size_t, J>()), ...);
    }(std::make_index_sequence<n>{});
    return reach;
  };
  for (int k = 0; k < rounds(3000); ++k) {
    JointPosition<n> q;
    JointVelocity<n> u, over;
    const double size = std::pow(10, uniform(rng, -3.0, 0.0));
    SummedMotion<M, double> sum, moved;
    for (std::size_t i = 0; i < n; ++i) {
      const double scale = M::kinds[i] == JointKind::prismatic ? slides_by : 1;
      q[i] = scale * uniform(rng, -3.0, 3.0);
      u[i] = scale * uniform(rng, -1.0, 1.0), over[i] = scale * size * uniform(rng, -1.0, 1.0);
      if (((ancestors<M>(Ix) >> i) & 1u) != 0) sum.add(i, u[i]), moved.add(i, over[i]);
    }
    double reach = 0;
    for (int s = 0; s <= 50; ++s) reach = std::max(reach, reach_at(integrate(q, over, 0.02 * s)));
    reach *= 1.01;
    const auto there = integrate(q, over, 1.0);
    way = std::max(way, norm(Xyz<double>(place(there) - place(q))) / moved.way(reach));
    bend = std::max(bend,
                    norm(Xyz<double>(velocity(there, u) - velocity(q, u))) / (sum.bend(reach, moved) + 1e-7));
  }
  return {way, bend};
}

}  // namespace

TEST_CASE(
    "SummedMotion: bounds the way of a point and what its velocity changes by, of joints of both kinds") {
  const auto check = [](const std::array<double, 2>& share) {
    CHECK(share[0] <= 1 + 1e-6);
    CHECK(share[1] <= 1 + 1e-6);
    CHECK(share[0] > 0.3);  // no loose bounds
    CHECK(share[1] > 0.2);
  };
  check(shares_of_bounds<5>(ur5::Model{}, 1));
  for (const double metres : {0.01, 0.3, 3.0}) {
    CAPTURE(metres);
    check(shares_of_bounds<2>(cylindrical(), metres));
  }
}

TEST_CASE("SummedMotion: without joints that slide it is the sum of angles, bit for bit") {
  SummedMotion<ur5::Model, double> a, b;
  double x = 0, y = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    a.add(i, -0.125 * double(i)), b.add(i, 0.25 * double(i));
    x += 0.125 * double(i), y += 0.25 * double(i);
  }
  CHECK(a.way(1.3) == 1.3 * x);
  CHECK(a.bend(1.3, b) == 1.3 * x * y);
  CHECK((a + b).bend(1.3) == 1.3 * (x + y) * (x + y));
}
