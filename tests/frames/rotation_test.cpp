#include "skinctl/frames/rotation.hpp"

#include <doctest/doctest.h>

#include <type_traits>
#include <vector>

#include "tests/support/digits50.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<Rotation<float>> && sizeof(Rotation<float>) == 9 * sizeof(float));
static_assert(std::is_trivially_copyable_v<Rotation<double>> &&
              sizeof(Rotation<double>) == 9 * sizeof(double));

namespace {
/// Lengths of rotation vectors around every place where a formula or a branch changes.
template <class T>
std::vector<T> telling_angles() {
  const T half_turn = pi<T>();
  const T hair = T(4) * epsilon<T>();
  std::vector<T> angles{T(0),    T(1e-30), T(1e-16), T(1e-8),   T(1e-4),  T(0.1), T(0.5),
                        T(0.99), T(1),     T(1.01),  T(1.9999), T(2.001), T(3)};
  for (const T& d : {T(1e-2), T(1e-4), T(1e-8), hair}) angles.push_back(half_turn - d * half_turn);
  return angles;
}
template <class T>
std::vector<Xyz<T>> telling_axes(Random& rng) {
  const T o(0), l(1);
  std::vector<Xyz<T>> axes{{l, o, o}, {o, l, o}, {o, o, l}, {-l, o, o}, {o, -l, o}, {o, o, -l}};
  for (int i = 0; i < 40; ++i) axes.push_back(random_direction<T>(rng));
  return axes;
}
/// `d/ds exp(phi + s dphi)` at s = 0, as the angular velocity in the outer axes, by a central difference
/// quotient.
Xyz<Digits50> omega_by_definition(const Xyz<Digits50>& phi, const Xyz<Digits50>& dphi) {
  const Digits50 h("1e-16");
  const auto rotation = [](const Xyz<Digits50>& v) {
    const Digits50 angle = norm(v);
    return angle == 0 ? Rotation<Digits50>{} : rotation_about((Digits50(1) / angle) * v, angle);
  };
  const Rotation<Digits50> D = rotation(phi + h * dphi) * rotation(phi - h * dphi).transpose();
  const Digits50 scale = 1 / (4 * h);
  return {scale * (D.y.z - D.z.y), scale * (D.z.x - D.x.z), scale * (D.x.y - D.y.x)};
}
}  // namespace

TEST_CASE_TEMPLATE("Rotation: a product turns as its factors one after the other", T, float, double,
                   Digits50) {
  auto rng = seeded(1);
  for (int i = 0; i < 200; ++i) {
    const auto R = random_rotation<T>(rng), S = random_rotation<T>(rng);
    for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
      const auto v = random_xyz(rng, reach);
      CAPTURE(as_code(R));
      CAPTURE(as_code(S));
      CAPTURE(as_code(v));
      CHECK(largest((R * S) * v - R * (S * v)) <= T(16) * epsilon<T>() * reach);
      CHECK(largest(turn_back(R, R * v) - v) <= T(16) * epsilon<T>() * reach);
      CHECK(largest(turn_back(R, v) - R.transpose() * v) <= T(4) * epsilon<T>() * reach);
    }
    CHECK(rotation_error(R * S) <= T(16) * epsilon<T>());
  }
}

TEST_CASE("Rotation: a known axis costs no arithmetic, it is a column") {
  auto rng = seeded(2);
  const auto R = random_rotation<double>(rng);
  CHECK(R * UnitZ{} == R.z);
  CHECK(R * ZeroTriple{} == Xyz<double>{0.0, 0.0, 0.0});
}

TEST_CASE_TEMPLATE("Rotation: exp is the turn by |phi| about phi, at every length", T, float, double) {
  auto rng = seeded(3);
  auto angles = telling_angles<T>();
  for (const T& more : {pi<T>(), T(5), T(6.2831), T(6.2832), T(100), std::numeric_limits<T>::min()})
    angles.push_back(more);
  for (const T& angle : angles) {
    for (const auto& axis : telling_axes<T>(rng)) {
      const Xyz<T> phi = angle * axis;
      const Xyz<Digits50> exact_phi = skinctl::cast<Digits50>(phi);
      const Digits50 exact_angle = norm(exact_phi);
      const Rotation<Digits50> expected = exact_angle == 0
                                              ? Rotation<Digits50>{}
                                              : rotation_about((1 / exact_angle) * exact_phi, exact_angle);
      const Rotation<T> R = exp_so3(phi);
      CAPTURE(as_code(phi));
      CHECK(largest(testing::cast<Digits50>(R), expected) <= Digits50(T(4) + T(2) * angle) * epsilon<T>());
      CHECK(rotation_error(R) <= T(16) * epsilon<T>());
    }
  }
}

TEST_CASE("Rotation: exp of a vector whose square underflows still turns") {
  const Rotation<double> R = exp_so3(Xyz<double>{0.0, 1e-200, 0.0});
  CHECK(R.x == Xyz<double>{1.0, 0.0, -1e-200});
  CHECK(log_so3(R) == Xyz<double>{0.0, 1e-200, 0.0});
  // A square that is too small for all its digits: the axis keeps them, a whole turn away.
  for (const double tiny : {1e-150, 1e-160, 1.3e-162}) {
    const Xyz<double> phi{0.6 * tiny, 0.0, 0.8 * tiny};
    const Xyz<double> turn = (-2.0 * pi<double>()) * Xyz<double>{0.6, 0.0, 0.8};
    CHECK(largest(log_so3(exp_so3(phi), turn) - turn) <= 16 * epsilon<double>());
  }
}

TEST_CASE_TEMPLATE("Rotation: log finds the vector that exp was given, to relative precision", T, float,
                   double) {
  auto rng = seeded(4);
  for (const T& angle : telling_angles<T>()) {
    for (const auto& axis : telling_axes<T>(rng)) {
      const Xyz<Digits50> unit = (1 / norm(skinctl::cast<Digits50>(axis))) * skinctl::cast<Digits50>(axis);
      const Xyz<Digits50> expected = Digits50(angle) * unit;
      const Rotation<T> R = testing::cast<T>(rotation_about(unit, Digits50(angle)));
      const Xyz<Digits50> phi = skinctl::cast<Digits50>(log_so3(R));
      CAPTURE(as_code(R));
      // Next to half a turn the rounding of R may put it on the other side.
      const bool may_flip = angle > pi<T>() - T(16) * epsilon<T>();
      const bool flipped = may_flip && dot(phi, expected) < 0;
      CHECK(largest(flipped ? phi + expected : phi - expected) <= Digits50(T(8) * epsilon<T>() * angle));
      CHECK(norm(phi) <= Digits50(pi<T>()) * (1 + Digits50(epsilon<T>())));
    }
  }
}

TEST_CASE("Rotation: log and exp are inverse to 50 digits") {
  auto rng = seeded(5);
  for (int i = 0; i < 200; ++i) {
    const Xyz<Digits50> phi = (pi<Digits50>() * uniform<Digits50>(rng)) * random_direction<Digits50>(rng);
    CHECK(largest(log_so3(exp_so3(phi)) - phi) <= 64 * epsilon<Digits50>());
  }
}

TEST_CASE_TEMPLATE("Rotation: exactly half a turn has the vector whose largest component is positive", T,
                   float, double, Digits50) {
  const T o(0), l(1);
  CHECK(largest(log_so3(Rotation<T>{{l, o, o}, {o, -l, o}, {o, o, -l}}) - Xyz<T>{pi<T>(), o, o}) <=
        epsilon<T>());
  CHECK(largest(log_so3(Rotation<T>{{-l, o, o}, {o, l, o}, {o, o, -l}}) - Xyz<T>{o, pi<T>(), o}) <=
        epsilon<T>());
  CHECK(largest(log_so3(Rotation<T>{{-l, o, o}, {o, -l, o}, {o, o, l}}) - Xyz<T>{o, o, pi<T>()}) <=
        epsilon<T>());
}

TEST_CASE_TEMPLATE("Rotation: log near the last value goes through half a turn without a jump", T, float,
                   double) {
  auto rng = seeded(6);
  for (int i = 0; i < 50; ++i) {
    const Xyz<T> axis = random_direction<T>(rng);
    Xyz<T> last{T(0), T(0), T(0)};
    const T step = T(0.01);
    for (int k = 1; T(k) * step < T(2) * pi<T>() - T(0.1); ++k) {
      const T angle = T(k) * step;
      const Xyz<T> phi = log_so3(rotation_about(axis, angle), last);
      CAPTURE(as_code(axis));
      CAPTURE(angle);
      CHECK(largest(phi - angle * axis) <= T(32) * epsilon<T>());
      last = phi;
    }
  }
  // The plain log does jump there: the law above is not empty.
  const Xyz<T> z{T(0), T(0), T(1)};
  CHECK(dot(log_so3(rotation_about(z, pi<T>() + T(0.1))), z) < T(0));
}

TEST_CASE_TEMPLATE("Rotation: the left Jacobian is the derivative of exp", T, float, double) {
  auto rng = seeded(7);
  auto angles = telling_angles<T>();
  for (const T& more : {pi<T>(), T(5), T(6)}) angles.push_back(more);
  for (const T& angle : angles) {
    for (const auto& axis : telling_axes<T>(rng)) {
      const Xyz<T> phi = angle * axis;
      const Xyz<T> dphi = random_xyz(rng, T(1));
      const Xyz<Digits50> exact_phi = skinctl::cast<Digits50>(phi),
                          exact_dphi = skinctl::cast<Digits50>(dphi);
      const Xyz<Digits50> omega = omega_by_definition(exact_phi, exact_dphi);
      CAPTURE(as_code(phi));
      CAPTURE(as_code(dphi));
      const Digits50 few_ulp = Digits50(T(16) * epsilon<T>());
      CHECK(largest(skinctl::cast<Digits50>(left_jacobian_so3(phi, dphi)) - omega) <= few_ulp);
      // The inverse, of the same omega rounded; it stretches by (|phi|/2) / sin(|phi|/2).
      const Digits50 stretch = 1 + Digits50(angle) / (2 * sin(Digits50(angle) / 2) + Digits50(1e-40));
      const Xyz<T> back = left_jacobian_inverse_so3(phi, skinctl::cast<T>(omega));
      CHECK(largest(skinctl::cast<Digits50>(back) - exact_dphi) <= few_ulp * stretch * stretch);
    }
  }
}

TEST_CASE("Rotation: the Jacobian's series and closed forms agree to 50 digits where they meet") {
  auto rng = seeded(8);
  for (const Digits50& angle :
       {Digits50("0.999999"), Digits50("1.000001"), Digits50("1.999999"), Digits50("2.000001")}) {
    const Xyz<Digits50> phi = angle * random_direction<Digits50>(rng);
    const Xyz<Digits50> v = random_xyz(rng, Digits50(1));
    CHECK(largest(left_jacobian_inverse_so3(phi, left_jacobian_so3(phi, v)) - v) <= 32 * epsilon<Digits50>());
    CHECK(largest(left_jacobian_so3(phi, v) - omega_by_definition(phi, v)) <= Digits50("1e-30"));
  }
}

TEST_CASE_TEMPLATE("Rotation: normalised is the nearest rotation, whatever was measured", T, float, double,
                   Digits50) {
  auto rng = seeded(9);
  for (const T& noise : {T(0), T(1e-30), T(1e-8), T(1e-4), T(3e-3)}) {
    for (int i = 0; i < 100; ++i) {
      const auto R = random_rotation<T>(rng);
      const Rotation<T> measured{R.x + random_xyz(rng, noise), R.y + random_xyz(rng, noise),
                                 R.z + random_xyz(rng, noise)};
      const Rotation<T> N = normalised(measured);
      CAPTURE(as_code(measured));
      CHECK(rotation_error(N) <= T(8) * epsilon<T>());
      // Nearest: N^T R is symmetric (the polar factor), unlike what Gram-Schmidt leaves.
      const Rotation<T> S = N.transpose() * measured;
      CHECK(largest(S, S.transpose()) <= T(8) * epsilon<T>());
    }
  }
}

TEST_CASE("Rotation: what is none says so") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Rotation<double> identity;
  CHECK(rotation_error(identity) == 0.0);
  CHECK(rotation_error(Rotation<double>{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}) >= 1.0);
  CHECK(rotation_error(Rotation<double>{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}) == 3.0);
  CHECK(rotation_error(Rotation<double>{{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}) >= 1.0);
  for (int i = 0; i < 9; ++i) {
    double e[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    e[i] = nan;
    const Rotation<double> R{{e[0], e[1], e[2]}, {e[3], e[4], e[5]}, {e[6], e[7], e[8]}};
    CAPTURE(i);
    CHECK(std::isnan(rotation_error(R)));
  }
  CHECK(std::isnan(exp_so3(Xyz<double>{nan, 0.0, 0.0}).y.y));
}

TEST_CASE_TEMPLATE("Rotation: to Eigen and back is the same, columns are the axes", T, float, double) {
  auto rng = seeded(71);
  const Rotation<T> R = random_rotation<T>(rng);
  const Mat3<T> M = as_eigen(R);
  CHECK(as_xyz(M.col(0)) == R.x);
  CHECK(as_xyz(M.col(1)) == R.y);
  CHECK(as_xyz(M.col(2)) == R.z);
  CHECK(Rotation<T>::from_eigen(M) == R);
  CHECK(Rotation<T>::from_eigen(M.transpose()) == R.transpose());
}

TEST_CASE_TEMPLATE("Rotation: log and the factor of its Jacobian at once are those of either alone", T, float,
                   double) {
  auto rng = seeded(14);
  std::vector<T> angles = telling_angles<T>();
  for (int k = 0; k <= 60; ++k) angles.push_back(T(k) * T(0.01));
  for (const T& d : {T(-1e-3), T(-1e-6), T(1e-6), T(1e-3)})
    angles.push_back(T(0.5) + d);  // where the polynomials end
  for (const T& angle : angles) {
    if (angle > T(3.1)) continue;
    for (const auto& axis : telling_axes<T>(rng)) {
      const Xyz<Digits50> unit = (1 / norm(skinctl::cast<Digits50>(axis))) * skinctl::cast<Digits50>(axis);
      const Xyz<Digits50> expected = Digits50(angle) * unit;
      const Rotation<T> R = testing::cast<T>(rotation_about(unit, Digits50(angle)));
      const auto is = detail::log_factors(R, Xyz<T>{T(0), T(0), T(0)});
      CAPTURE(as_code(R));
      CHECK(largest(skinctl::cast<Digits50>(is.phi) - expected) <= Digits50(T(8) * epsilon<T>() * angle));
      const Digits50 factor = detail::inverse_factor(expected);
      CHECK(abs(Digits50(is.inverse) - factor) <= Digits50(T(8) * epsilon<T>()) * factor);
      // The branch is that of log_so3, with every last value.
      const Xyz<T> near = T(uniform<T>(rng) * T(5)) * random_direction<T>(rng);
      CHECK(largest(detail::log_factors(R, near).phi - log_so3(R, near)) <= T(16) * epsilon<T>() * T(7));
    }
  }
  const auto none =
      detail::log_factors(Rotation<T>{{std::numeric_limits<T>::quiet_NaN(), T(0), T(0)}}, Xyz<T>{});
  CHECK_FALSE(dot(none.phi, none.phi) == T(0));
}
