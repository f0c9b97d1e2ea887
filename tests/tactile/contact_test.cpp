#include "skinctl/tactile/contact.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

// Where a point fixed to link I is in the base's frame.
template <std::size_t I>
std::array<double, 3> place(const JointPosition<6>& q, const std::array<double, 3>& p) {
  const ur5::Model model;
  const auto pose = Poses<ur5::Model, all_links(6), double>(model, JointAngles<ur5::Model, double>(model, q))
                        .template get<I>();
  const auto x = pose.origin() + pose.axes() * Xyz<double>{p[0], p[1], p[2]};
  return {x.x, x.y, x.z};
}

}  // namespace

TEST_CASE("Contact: the row is how the touched point moves against the push, by central differences") {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int k = 0; k < 20; ++k) {
    JointPosition<6> q;
    for (double& x : q) x = 2 * u(rng);
    const std::array<double, 3> p{0.2 * u(rng), 0.2 * u(rng), 0.2 * u(rng)}, f{u(rng), u(rng), u(rng)};
    LinkWrenches<ur5::Model, link_bit<2> | link_bit<4>> wrenches;
    wrenches.set<4>({{f[0], f[1], f[2]},
                     {p[1] * f[2] - p[2] * f[1], p[2] * f[0] - p[0] * f[2], p[0] * f[1] - p[1] * f[0]}});
    const auto contacts = contacts_of(ur5::Model{}, q, wrenches);
    REQUIRE(contacts.count == 1);
    const auto& c = contacts.list[0];
    CHECK(c.link == 4);
    const double force = std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    CHECK(c.force == doctest::Approx(force));
    // The push's direction in the base's frame.
    const auto at = place<4>(q, p), tip = place<4>(q, {p[0] + f[0], p[1] + f[1], p[2] + f[2]});
    for (std::size_t j = 0; j < 6; ++j) {
      auto high = q, low = q;
      high[j] += 1e-6;
      low[j] -= 1e-6;
      const auto a = place<4>(high, p), b = place<4>(low, p);
      double moved = 0;
      for (std::size_t i = 0; i < 3; ++i) moved -= (a[i] - b[i]) / 2e-6 * (tip[i] - at[i]) / force;
      CHECK(std::abs(c.row[j] - moved) < 1e-8);
    }
    // The pushes together are the skin's torque.
    wrenches.set<2>({{1, 2, 3}, {0.1, -0.2, 0.3}});
    const auto both = contacts_of(ur5::Model{}, q, wrenches);
    REQUIRE(both.count == 2);
    const auto tau = skin_torque(ur5::Model{}, q, wrenches);
    for (std::size_t j = 0; j < 6; ++j)
      CHECK(tau[j] == doctest::Approx(-both.list[0].force * both.list[0].row[j] -
                                      both.list[1].force * both.list[1].row[j]));
  }
}

TEST_CASE("Contact: nothing felt, nothing finite, no skin: no contact") {
  using Wrenches = LinkWrenches<ur5::Model, link_bit<2>>;
  const JointPosition<6> q;
  Wrenches w;
  CHECK(contacts_of(ur5::Model{}, q, w).count == 0);
  for (const double bad : {1e-4, std::nan(""), std::numeric_limits<double>::infinity()}) {
    w.set<2>({{bad, 0, 0}, {0, 0, 0}});
    CHECK(contacts_of(ur5::Model{}, q, w).count == 0);
  }
  struct NoSkin {};
  CHECK(contacts_of(ur5::Model{}, q, NoSkin{}).count == 0);
}

TEST_CASE("Contact: a couple without cells acts no further off than the link reaches") {
  using Wrenches = LinkWrenches<ur5::Model, link_bit<2>>;
  const JointPosition<6> q{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
  Wrenches w;
  // 12 N against 11 N, 0.3 m apart, along y of the link: 3.6 N m about its joint.
  w.set<2>({{0, 1, 0}, {0, 0, 3.6}});
  const auto c = contacts_of(ur5::Model{}, q, w);
  REQUIRE(c.count == 1);
  CHECK(c.list[0].force == 1);
  CHECK(std::abs(c.list[0].row[2]) > 0.3);
  CHECK(std::abs(c.list[0].row[2]) < 0.9);  // the forearm is 0.39 m long
  CHECK(std::abs(c.list[0].place.x) == doctest::Approx(std::abs(c.list[0].row[2])));
  CHECK(c.list[0].normal.y == 1);
  w.set<2>({{0, 12, 0}, {0, 0, -3.6}});  // a push 0.3 m off is as it is
  const auto tau = skin_torque(ur5::Model{}, q, w);
  const auto push = contacts_of(ur5::Model{}, q, w).list[0];
  CHECK(push.place.x == doctest::Approx(-0.3));
  for (std::size_t j = 0; j < 6; ++j) CHECK(tau[j] == doctest::Approx(-push.force * push.row[j]));
}
