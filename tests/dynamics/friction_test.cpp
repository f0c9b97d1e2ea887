#include "skinctl/dynamics/friction.hpp"

#include <doctest/doctest.h>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class T>
typename JointFriction<3, T>::Settings settings() {
  typename JointFriction<3, T>::Settings s;
  s.viscous = {T(0.5), T(0), T(2)};
  s.coulomb = {T(1), T(0.25), T(0)};
  s.stiction = {T(0.5), T(0.75), T(0)};
  return s;
}
}  // namespace

TEST_CASE_TEMPLATE("JointFriction: odd, takes energy at every speed, and is what its parts say", T, float,
                   double) {
  const JointFriction<3, T> friction(settings<T>());
  for (double v : {0.0, 1e-30, 1e-8, 1e-3, 0.01, 0.1, 1.0, 1e3, 1e6}) {
    const auto dq = JointVelocity<3, T>::constant(T(v));
    const auto tau = friction.torque(dq), back = friction.torque(-dq);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(tau[i] == -back[i]);
      CHECK(tau[i] * dq[i] >= 0);
    }
    CHECK(tau[2] == T(2) * T(v));
  }
  const auto fast = friction.torque({T(100), T(100), T(0)});
  CHECK(fast[0] == doctest::Approx(51.0).epsilon(1e-5));
  // The hump: half of the stiction is left at v_s.
  CHECK(friction.torque({T(0), T(0.1), T(0)})[1] == doctest::Approx(0.25 + 0.375).epsilon(1e-5));
  CHECK(friction.torque(JointVelocity<3, T>()) == JointTorque<3, T>());
}

TEST_CASE("JointFriction: the slope is that of the torque, in 50 digits, and lanes do as numbers do") {
  const JointFriction<3, Digits50> friction(settings<Digits50>());
  const JointFriction<3> in_double(settings<double>());
  const Digits50 h("1e-16");
  for (const char* v : {"0", "0.003", "-0.02", "0.1", "-0.3", "2"}) {
    const auto dq = JointVelocity<3, Digits50>::constant(Digits50(v));
    const auto step = JointVelocity<3, Digits50>::constant(h);
    const auto change = friction.torque(dq + step) - friction.torque(dq - step);
    const auto slope = in_double.slope(dq.cast<double>());
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(std::abs(static_cast<double>(change[i] / (2 * h) - Digits50(slope[i]))) <= 1e-12);
  }
  using L = Lane<double>;
  const JointFriction<3, L> lanes(settings<L>());
  CHECK(lanes.torque(JointVelocity<3, L>::constant(L(0.02)))[0][0] ==
        doctest::Approx(in_double.torque(JointVelocity<3>::constant(0.02))[0]).epsilon(1e-14));
}

TEST_CASE("JointFriction: settings that cannot work are refused") {
  auto s = settings<double>();
  s.sign_velocity = 0;
  CHECK_THROWS_AS(JointFriction<3>{s}, ConfigurationError);
  s = settings<double>();
  s.coulomb[1] = -1;
  CHECK_THROWS_AS(JointFriction<3>{s}, ConfigurationError);
}
