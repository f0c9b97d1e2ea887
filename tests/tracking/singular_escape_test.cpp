#include "skinctl/tracking/singular_escape.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Escape = SingularEscape<6>;
using Velocity = Twist<Flange, Base, Flange, Base>;
auto flange_jacobian(const JointPosition<6>& q) {
  return jacobian<5>(link_poses(ur5::Model{}, q),
                     Transform<Link<5>, Flange>::translation_xyz(0, 0, ur5::Description::d6));
}
double fastest(const JointVelocity<6>& v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}
JointVelocity<6> wish(const JointPosition<6>& q, const Velocity& asked) {
  return Escape().wish<TaskSpace::pose>(flange_jacobian(q), asked, JointVelocity<6>::constant(3));
}
}  // namespace

TEST_CASE("SingularEscape: a wrist turns round, so fast that a right angle takes less than 0.7 s") {
  const JointPosition<6> wrist{0.3, -1.2, 1.4, -1.8, 0, 0.3};
  const auto J = flange_jacobian(wrist);
  const auto u = singular_directions(J)[0].u;
  for (const double speed : {0.02, 0.1, 1.0, -1.0}) {
    CAPTURE(speed);
    const auto turn = wish(wrist, speed * u);
    CHECK(fastest(turn) > 2.2);
    CHECK(fastest(turn) < 3);
    CHECK(as_eigen(J * turn).norm() < 1e-6);  // the tool does not notice
  }
  CHECK(fastest(wish(wrist, 1e-5 * u)) < 0.02);  // nothing is asked: nothing turns
  // Something else is asked, of which the tool is capable as it stands.
  const Velocity regular = J * JointVelocity<6>{0.1, 0.2, -0.1, 0.1, 0.3, 0.1};
  CHECK(fastest(wish(wrist, regular)) < 1e-6);
}

TEST_CASE("SingularEscape: a stretched arm bends when asked back, and does nothing when asked out") {
  const JointPosition<6> elbow{0.3, -1.1, 0, -0.7, 1.2, 0.5};
  const auto J = flange_jacobian(elbow);
  const auto d = singular_directions(J)[0];
  const double bend = as_eigen(d.u).dot(as_eigen(bias_acceleration(J, d.v)));
  CHECK(fastest(wish(elbow, (bend > 0 ? 0.2 : -0.2) * d.u)) > 2);
  CHECK(fastest(wish(elbow, (bend > 0 ? -0.2 : 0.2) * d.u)) == 0);
}

TEST_CASE("SingularEscape: straight up, elbow and shoulder at once: what is out of reach moves nothing") {
  // The wrist can neither rise nor enter the cylinder about the first axis on which it stands.
  for (const double off : {1e-12, 1e-9, 1e-6, 1e-4}) {
    CAPTURE(off);
    const JointPosition<6> q{0, -1.5707963267948966 + off, off, -1.5707963267948966, 1.5707963267948966, 0};
    const auto wrist = link_poses(ur5::Model{}, q).get<4>().origin();
    const double side = wrist.y > 0 ? 1 : -1;
    const auto asked = [&](double outward, double up) {
      return Velocity{{0, side * outward, up}, {0, 0, 0}};
    };
    CHECK(fastest(wish(q, asked(-0.1, 0.5))) < 0.2);
    CHECK(fastest(wish(q, asked(-0.02, 0.5))) < 0.2);
    CHECK(fastest(wish(q, asked(0.1, 0.5))) > 1);
    CHECK(fastest(wish(q, asked(0.1, -0.5))) > 1);
  }
}

TEST_CASE("SingularEscape: every joint has its own limit") {
  const JointPosition<6> wrist{0.3, -1.2, 1.4, -1.8, 0, 0.3};
  const auto J = flange_jacobian(wrist);
  const auto asked = 0.1 * singular_directions(J)[0].u;
  const auto equal = JointVelocity<6>::constant(3);
  const auto turn = Escape().wish<TaskSpace::pose>(J, asked, equal);
  auto idle = equal, busy = equal;  // the fifth does not turn with the others
  idle[4] = 1, busy[3] = 1;
  CHECK(fastest(Escape().wish<TaskSpace::pose>(J, asked, idle)) ==
        doctest::Approx(fastest(turn)).epsilon(0.05));
  const auto slower = Escape().wish<TaskSpace::pose>(J, asked, busy);
  CHECK(std::abs(slower[3]) < 1);
  CHECK(fastest(slower) < 0.6 * fastest(turn));
}

TEST_CASE("SingularEscape: on a way that is nearly straight it goes on, whatever the sign of sigma") {
  // Either side of sigma = 0 the least direction points the other way; a target that turns round does not.
  for (const double off : {-1e-5, -1e-9, 0.0, 1e-9, 1e-5}) {
    CAPTURE(off);
    const JointPosition<6> q{0.3, -1.2, 1.4, -1.8, off, 0.3};
    const auto J = flange_jacobian(q);
    const auto asked = 0.1 * singular_directions(J)[0].u;
    const auto limit = JointVelocity<6>::constant(3);
    const auto fresh = Escape().wish<TaskSpace::pose>(J, asked, limit);
    for (const double sense : {-1.0, 1.0}) {
      Escape turning;
      turning.v = sense * fresh;
      CHECK(fastest(turning.wish<TaskSpace::pose>(J, asked, limit) - sense * fresh) < 1e-12);
    }
  }
  // Where sigma is clearly not zero, it goes where that leads.
  const JointPosition<6> q{0.3, -1.2, 1.4, -1.8, 0.01, 0.3};
  const auto asked = 0.1 * singular_directions(flange_jacobian(q))[0].u;
  Escape turning;
  turning.v = -wish(q, asked);
  const auto again = turning.wish<TaskSpace::pose>(flange_jacobian(q), asked, JointVelocity<6>::constant(3));
  CHECK(fastest(again - wish(q, asked)) < 1e-12);
}

TEST_CASE("SingularEscape: goes to its wish smoothly, for every interval; a NaN changes nothing") {
  const JointVelocity<6> wanted{1, -1, 0.5, 0, 2, 0};
  for (const double dt : {1e-4, 0.001, 0.008, 0.1, 10.0}) {
    Escape e;
    double last = 0;
    for (double t = 0; t < 1 || t < 20 * dt; t += dt) {
      const auto next = e.advanced(wanted, dt);
      CHECK(next.v[4] == doctest::Approx(e.v[4] + dt * next.a[4]));
      CHECK(next.v[4] >= last - 1e-12);
      CHECK(next.v[4] <= 2 + 1e-12);
      last = next.v[4];
      e = next;
    }
    CHECK(fastest(e.v - wanted) < 1e-6);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto held = e.advanced(JointVelocity<6>::constant(nan), dt);
    for (std::size_t i = 0; i < 6; ++i) CHECK(held.v[i] == e.v[i]);
  }
}
