#include "skinctl/trajectory/spline_so3.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class T>
T angle_between(const Rotation<T>& R, const Rotation<T>& S) {
  return norm(log_so3(S * R.transpose()));
}
template <class T>
Xyz<T> direction(Seeded& rng) {
  const Xyz<T> v{T(rng()), T(rng()), T(rng())};
  return T(T(1) / norm(v)) * v;
}
}  // namespace

TEST_CASE_TEMPLATE("RotationSpline: leaves and arrives at rest, at exactly the given rotations", T, float,
                   double) {
  Seeded rng(8);
  for (int i = 0; i < 100; ++i) {
    const auto R_i = exp_so3(T(rng.between(0, 3)) * direction<T>(rng));
    const auto R_g = exp_so3(T(rng.between(0, 3)) * direction<T>(rng));
    const RotationSpline<T> s(R_i, R_g, T(2));
    const Xyz<T> zero{T(0), T(0), T(0)};
    for (const T& t : {T(-1), T(0)}) {
      CHECK(s.at(t).R == R_i);
      CHECK(s.at(t).omega == zero);
      CHECK(s.at(t).domega == zero);
    }
    for (const T& t : {T(2), T(5)}) {
      CHECK(s.at(t).R == R_g);
      CHECK(s.at(t).omega == zero);
      CHECK(s.at(t).domega == zero);
    }
    // no step inside either, where the side it is computed from changes
    CHECK(angle_between(s.at(T(1) - T(64) * epsilon<T>()).R, s.at(T(1) + T(64) * epsilon<T>()).R) <
          T(1000) * epsilon<T>());
    CHECK(angle_between(R_i, s.at(T(1e-6)).R) <= T(16) * epsilon<T>());
    CHECK(rotation_error(s.at(T(0.7)).R) < T(32) * epsilon<T>());
  }
}

TEST_CASE("RotationSpline: takes the shortest way, at every instant a part of the same turn") {
  Seeded rng(9);
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-3, 1.0, 3.0, 3.14159, 3.1415926535}) {
    const auto R_i = exp_so3(rng.between(0, 3) * direction<double>(rng));
    const auto axis = direction<double>(rng);
    const auto R_g = exp_so3(angle * axis) * R_i;
    const RotationSpline<double> s(R_i, R_g, 1.0);
    CAPTURE(angle);
    CHECK(norm(s.turn()) == doctest::Approx(angle).epsilon(1e-7));
    CHECK(norm(s.turn()) <= pi<double>() * (1 + 1e-15));
    for (int k = 0; k <= 20; ++k) {
      const double a1 = quintic(k / 20.0).a1;
      const auto expected = exp_so3(a1 * s.turn()) * R_i;
      CHECK(angle_between(s.at(k / 20.0).R, expected) <= 4e-15);
    }
  }
}

TEST_CASE("RotationSpline: omega and domega are the derivatives of R, in 50 digits") {
  Seeded rng(10);
  const Digits50 h("1e-15");
  for (int i = 0; i < 30; ++i) {
    const auto R_i = exp_so3(Digits50(rng.between(0, 3)) * direction<Digits50>(rng));
    const auto R_g = exp_so3(Digits50(rng.between(0, 3)) * direction<Digits50>(rng));
    const RotationSpline<Digits50> s(R_i, R_g, Digits50(1.5));
    const Digits50 t(rng.between(0, 1.5));
    const auto before = s.at(t - h), now = s.at(t), after = s.at(t + h);
    const auto turned = log_so3(after.R * before.R.transpose());
    const auto omega = (Digits50(1) / (2 * h)) * turned;
    const auto domega = (Digits50(1) / (2 * h)) * (after.omega - before.omega);
    CHECK(norm(Xyz<Digits50>(omega - now.omega)) < Digits50("1e-25"));
    CHECK(norm(Xyz<Digits50>(domega - now.domega)) < Digits50("1e-25"));
  }
}

TEST_CASE("RotationSpline: near half a turn it goes on the way round of the spline before") {
  Seeded rng(11);
  for (int i = 0; i < 50; ++i) {
    const auto R_i = exp_so3(rng.between(0, 3) * direction<double>(rng));
    const auto axis = direction<double>(rng);
    const RotationSpline<double> first(R_i, exp_so3((pi<double>() - 1e-6) * axis) * R_i, 1.0);
    const auto beyond = exp_so3((pi<double>() + 1e-6) * axis) * R_i;
    const RotationSpline<double> turned_back(R_i, beyond, 1.0);
    const RotationSpline<double> goes_on(R_i, beyond, 1.0, first.turn());
    CHECK(dot(first.turn(), turned_back.turn()) < 0);
    CHECK(dot(first.turn(), goes_on.turn()) > 0);
    CHECK(norm(Xyz<double>(goes_on.turn() - first.turn())) == doctest::Approx(2e-6).epsilon(1e-3));
    CHECK(goes_on.at(1.0).R == beyond);
  }
}
