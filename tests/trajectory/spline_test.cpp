#include "skinctl/trajectory/spline.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<JointSpline<6>>);

TEST_CASE_TEMPLATE("JointSpline: leaves and arrives at rest, at exactly the given positions", T, float,
                   double, Digits50) {
  Seeded rng(6);
  for (int i = 0; i < 200; ++i) {
    const JointSpline<6, T> s{rng.vector<JointPosition<6, T>>(6), rng.vector<JointPosition<6, T>>(6), T(1.7)};
    for (const T& t : {T(-1), T(0)}) {
      const auto r = s.at(t);
      CHECK(r.q_d == s.q_i);
      CHECK(r.dq_d == JointVelocity<6, T>{});
      CHECK(r.ddq_d == JointAcceleration<6, T>{});
    }
    for (const T& t : {T(1.7), T(1e9)}) {
      const auto r = s.at(t);
      CHECK(r.q_d == s.q_g);
      CHECK(r.dq_d == JointVelocity<6, T>{});
      CHECK(r.ddq_d == JointAcceleration<6, T>{});
    }
  }
  const JointSpline<6, T> standing{rng.vector<JointPosition<6, T>>(6), rng.vector<JointPosition<6, T>>(6),
                                   T(0)};
  CHECK(standing.at(T(0)).q_d == standing.q_g);
}

TEST_CASE("JointSpline: velocity and acceleration are the derivatives of the position") {
  const JointSpline<2, Digits50> s{JointPosition<2, Digits50>{Digits50(0.3), Digits50(-2)},
                                   JointPosition<2, Digits50>{Digits50(1), Digits50(3)}, Digits50(2.5)};
  const Digits50 h("1e-15");
  Seeded rng(7);
  for (int i = 0; i < 100; ++i) {
    const Digits50 t(rng.between(0, 2.5));
    const auto r = s.at(t), before = s.at(t - h), after = s.at(t + h);
    for (std::size_t j = 0; j < 2; ++j) {
      CHECK(magnitude((after.q_d[j] - before.q_d[j]) / (2 * h) - r.dq_d[j]) < Digits50("1e-25"));
      CHECK(magnitude((after.dq_d[j] - before.dq_d[j]) / (2 * h) - r.ddq_d[j]) < Digits50("1e-25"));
    }
  }
}

TEST_CASE_TEMPLATE("JointSpline: every joint moves one way only", T, float, double) {
  const JointSpline<2, T> s{JointPosition<2, T>{T(0.3), T(-2)}, JointPosition<2, T>{T(1), T(-2.5)}, T(1)};
  auto last = s.at(T(0)).q_d;
  for (int i = 1; i <= 20000; ++i) {
    const auto q = s.at(T(i) / T(20000)).q_d;
    CHECK(q[0] >= last[0]);
    CHECK(q[1] <= last[1]);
    last = q;
  }
}

TEST_CASE("JointSpline: the shortest time keeps below the speed limit, just") {
  const double tf = shortest_spline_time(-2.0, 0.5);
  CHECK(tf == doctest::Approx(1.875 * 2 / 0.5));
  const JointSpline<2> s{JointPosition<2>{0.0, 1.0}, JointPosition<2>{-2.0, 1.0}, tf};
  CHECK(s.at(tf / 2).dq_d[0] == doctest::Approx(-0.5));
}
