#include "skinctl/kinematics/zyz.hpp"

#include <doctest/doctest.h>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class T>
T distance(const Rotation<T>& R, const Rotation<T>& S) {
  using std::abs;
  T worst(0);
  for (const auto& [a, b] : {std::pair{R.x, S.x}, std::pair{R.y, S.y}, std::pair{R.z, S.z}})
    for (const T d : {a.x - b.x, a.y - b.y, a.z - b.z})
      if (!(abs(d) <= worst)) worst = abs(d);
  return worst;
}
const double pi = std::acos(-1.0);
}  // namespace

TEST_CASE_TEMPLATE("Zyz: angles of a rotation and back, straight up and down included", T, float, double) {
  const T eps = std::numeric_limits<T>::epsilon();
  oracle::Random random(1);
  for (double theta : {0.0, 1e-30, 1e-8, 1e-4, 0.3, 1.5, 3.0, 3.1415, pi})
    for (int k = 0; k < 50; ++k) {
      const Zyz<T> a{T(random.uniform(-pi, pi)), T(theta), T(random.uniform(-pi, pi))};
      const Rotation<T> R = rotation_zyz(a);
      CAPTURE(theta);
      CHECK(rotation_error(R) <= T(8) * eps);
      const Zyz<T> b = zyz_angles(R);
      CHECK(distance(rotation_zyz(b), R) <= T(8) * eps);
      // Near the angles it came from, the same branch.
      const Zyz<T> c = zyz_angles(R, a);
      CHECK(distance(rotation_zyz(c), R) <= T(8) * eps);
      if (std::sin(theta) > 0.1) {
        const Zyz<T> d = difference(c, a);
        CHECK(std::abs(d.phi) + std::abs(d.theta) + std::abs(d.psi) <= T(200) * eps);
      }
    }
}

TEST_CASE("Zyz: a path through theta = 0 is continuous near the last angles; differences are wrapped") {
  Zyz<double> last{0.7, 0.3, -0.4};
  for (int k = 0; k <= 48; ++k) {
    const double theta = 0.3 - 0.0125 * k;
    const Zyz<double> next = zyz_angles(rotation_zyz(Zyz<double>{0.7, theta, -0.4}), last);
    const Zyz<double> d = difference(next, last);
    CHECK(std::abs(d.phi) + std::abs(d.psi) <= 1e-12);
    last = next;
  }
  CHECK(last.theta == doctest::Approx(-0.3));
  CHECK(difference(Zyz<double>{3.1, 0, -3.1}, Zyz<double>{-3.1, 0, 3.1}).phi ==
        doctest::Approx(6.2 - 2 * pi));
  CHECK(std::abs(wrapped(1e6 * 2 * pi + 0.25) - 0.25) <= 1e-9);
}

TEST_CASE("ZyzMap: it is the slope of the rotation, and its inverse undoes it outside the zone") {
  const Digits50 h("1e-20");
  oracle::Random random(2);
  for (int k = 0; k < 20; ++k) {
    const auto number = [&] { return Digits50(random.uniform(-2, 2)); };
    const Zyz<Digits50> a{number(), Digits50(random.uniform(0.1, 3.0)), number()},
        rates{number(), number(), number()};
    const Zyz<Digits50> dd{number(), number(), number()};
    const auto at = [&](const Digits50& t) { return a + t * rates + (t * t / 2) * dd; };
    const ZyzMap<Digits50> B(a);
    const auto w = log_so3(rotation_zyz(at(h)) * rotation_zyz(at(-h)).transpose());
    const auto omega = B * rates;
    CHECK(static_cast<double>(abs(w.x / (2 * h) - omega.x) + abs(w.y / (2 * h) - omega.y)) <= 1e-15);
    CHECK(static_cast<double>(abs(w.z / (2 * h) - omega.z)) <= 1e-15);
    CHECK(abs(abs(B.determinant()) - abs(sin(a.theta))) <= Digits50("1e-45"));

    const auto rates_at = [&](const Digits50& t) { return rates + t * dd; };
    const auto w1 = ZyzMap<Digits50>(at(h)) * rates_at(h), w0 = ZyzMap<Digits50>(at(-h)) * rates_at(-h);
    const auto domega = B * dd + B.rate_times(rates);
    CHECK(static_cast<double>(abs((w1.x - w0.x) / (2 * h) - domega.x)) <= 1e-15);
    CHECK(static_cast<double>(abs((w1.y - w0.y) / (2 * h) - domega.y)) <= 1e-15);
    CHECK(static_cast<double>(abs((w1.z - w0.z) / (2 * h) - domega.z)) <= 1e-15);

    const auto back = B.solve(omega);
    CHECK(static_cast<double>(abs(back.phi - rates.phi) + abs(back.psi - rates.psi)) <= 1e-30);
    const auto dback = B.solve_rate(omega, domega, rates);
    CHECK(static_cast<double>(abs(dback.phi - dd.phi) + abs(dback.theta - dd.theta)) <= 1e-30);
    CHECK(static_cast<double>(abs(dback.psi - dd.psi)) <= 1e-30);
  }
}

TEST_CASE_TEMPLATE("ZyzMap: in the zone the inverse is bounded, smooth, and its rate is its slope", T, float,
                   double) {
  const T zone = static_cast<T>(0.05);
  for (double theta = -0.2; theta <= 0.2; theta += 0.001) {
    const auto rates = ZyzMap<T>({T(0.4), T(theta), T(1)}, zone).solve({T(0.6), T(-0.64), T(0.48)});
    CHECK(std::abs(rates.psi) <= T(2) / zone);
    CHECK(std::abs(rates.phi) <= T(2) / zone + T(0.48));
  }
  const auto straight = ZyzMap<T>({T(0.4), T(0), T(1)}).solve({T(1), T(0), T(2)});
  CHECK(straight.psi == 0);
  CHECK(straight.phi == 2);
  for (const char* theta : {"0", "0.003", "0.02", "0.0499", "0.06", "3.13"}) {
    const Digits50 h("1e-20");
    const Zyz<Digits50> a{Digits50(0.5), Digits50(theta), Digits50(1)},
        da{Digits50(0.25), Digits50(-0.5), Digits50(2)};
    const Xyz<Digits50> w{Digits50(0.5), Digits50(-1), Digits50(0.25)},
        dw{Digits50(2), Digits50(0.125), Digits50(-1)};
    const auto at = [&](const Digits50& t) { return ZyzMap<Digits50>(a + t * da).solve(w + t * dw); };
    const auto ahead = at(h), behind = at(-h);
    const ZyzMap<T> map({T(a.phi), T(a.theta), T(a.psi)});
    const auto rate = map.solve_rate(cast<T>(w), cast<T>(dw), {T(da.phi), T(da.theta), T(da.psi)});
    const double scale = 4e3 * static_cast<double>(std::numeric_limits<T>::epsilon()) *
                         (1 + std::abs(static_cast<double>(rate.psi)));
    CAPTURE(theta);
    CHECK(std::abs(static_cast<double>((ahead.psi - behind.psi) / (2 * h) - Digits50(rate.psi))) <= scale);
    CHECK(std::abs(static_cast<double>((ahead.phi - behind.phi) / (2 * h) - Digits50(rate.phi))) <= scale);
    CHECK(std::abs(static_cast<double>((ahead.theta - behind.theta) / (2 * h) - Digits50(rate.theta))) <=
          scale);
  }
}

TEST_CASE(
    "AnalyticJacobian: rates of a UR5's position and angles, first and second, by quotients in 50 digits") {
  const auto model = calibrated_from<ur5::Description, Digits50>();
  oracle::Random random(3);
  const Motion<6, Digits50> at(random);
  const auto q_at = [&](const Digits50& t) {
    return JointPosition<6, Digits50>::generate(
        [&](std::size_t i) { return at.q[i] + t * at.dq[i] + t * t / 2 * at.ddq[i]; });
  };
  const auto pose = [&](const Digits50& t) { return link_poses<link_bit<5>>(model, q_at(t)).get<5>(); };
  const auto J = jacobian<5>(link_poses(model, at.q));
  const Zyz<Digits50> angles = zyz_angles(pose(Digits50(0)).axes());
  const AnalyticJacobian<std::remove_cv_t<decltype(J)>> J_a(J, angles);
  const ZyzVelocity<Digits50> v = J_a * at.dq, a = J_a.acceleration(at.dq, at.ddq);
  const Digits50 h("1e-12");
  const auto ahead = zyz_angles(pose(h).axes(), angles), behind = zyz_angles(pose(-h).axes(), angles);
  const auto d1 = difference(ahead, angles), d0 = difference(angles, behind);
  CHECK(static_cast<double>(abs((d1.phi + d0.phi) / (2 * h) - v.angles.phi)) <= 1e-18);
  CHECK(static_cast<double>(abs((d1.theta + d0.theta) / (2 * h) - v.angles.theta)) <= 1e-18);
  CHECK(static_cast<double>(abs((d1.psi + d0.psi) / (2 * h) - v.angles.psi)) <= 1e-18);
  CHECK(static_cast<double>(abs((d1.phi - d0.phi) / (h * h) - a.angles.phi)) <= 1e-18);
  CHECK(static_cast<double>(abs((d1.theta - d0.theta) / (h * h) - a.angles.theta)) <= 1e-18);
  CHECK(static_cast<double>(abs((d1.psi - d0.psi) / (h * h) - a.angles.psi)) <= 1e-18);
  // Column by column the same.
  const auto dJ = jacobian_rate(J, at.dq);
  Digits50 psi(0), linear(0);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((psi += J_a.column<I>().angles.psi * at.ddq[I] + J_a.column_rate<I>(dJ, at.dq).angles.psi * at.dq[I],
      linear += J_a.column<I>().linear.x * at.ddq[I] + J_a.column_rate<I>(dJ, at.dq).linear.x * at.dq[I]),
     ...);
  }(std::make_index_sequence<6>{});
  CHECK(static_cast<double>(abs(psi - a.angles.psi) + abs(linear - a.linear.x)) <= 1e-40);
}
