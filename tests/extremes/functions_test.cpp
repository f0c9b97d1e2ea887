// More functions at the ends of what a number holds: each row says what comes of it, exact, bounded or
// refused.
//
// Promise: rotation vectors, ZYZ angles, sums, clocks, blends, a tank's share, allowed speeds, centres of
// mass, singular directions and small systems of equations at the ends of what a number holds
// Tried: exact, bounded or refused, a row each; a tank's share overspent from 1e19 J on in float, where a
// square left the range
//
// Promise: a function's result at the ends of what a number holds is exact, bounded or refused
// Tried: rotations, braking speeds, wrapped angles, pursuits: 0, denormal numbers, every tenth of the
// exponents, the largest; defaults at periods of 0.1 ms to 1 s, delays and lags to 1 s; float and double.
// Also: `extremes/`

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;

namespace {

template <class T>
using L = std::numeric_limits<T>;

/// Zero, denormal numbers, every tenth of the exponents, the largest number; not negative.
template <class T>
std::vector<T> sizes() {
  std::vector<T> out{T(0), L<T>::denorm_min(), L<T>::min(), T(0.3), T(1), L<T>::max()};
  for (int e = L<T>::min_exponent10; e <= L<T>::max_exponent10; e += L<T>::max_exponent10 / 10)
    out.push_back(std::pow(T(10), T(e)));
  return out;
}
template <class T>
T distance_of(const Rotation<T>& a, const Rotation<T>& b) {
  T most(0);
  for (const auto& d : {a.x - b.x, a.y - b.y, a.z - b.z})
    for (const T x : {d.x, d.y, d.z}) most = std::max(most, std::abs(x));
  return most;
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: log_so3 turns back what exp_so3 turned, by at most half a turn", T,
                   SKINCTL_EXTREME_SCALARS) {
  const T eps = L<T>::epsilon(), pi = std::atan2(T(0), T(-1));
  for (const T s : sizes<T>())
    for (const Xyz<T>& axis :
         {Xyz<T>{T(1), T(0), T(0)}, Xyz<T>{T(0.6), T(0), T(-0.8)}, Xyz<T>{T(-0.48), T(0.6), T(0.64)}}) {
      CAPTURE(s);
      if (s > L<T>::max() / 2) continue;
      const auto R = exp_so3(s * axis);
      const Xyz<T> phi = log_so3(R);
      CHECK(norm(phi) <= pi * (1 + 4 * eps));
      CHECK(distance_of(exp_so3(phi), R) <= 16 * eps);
      if (s < T(3)) CHECK(norm(phi - s * axis) <= 16 * eps * std::max(s, L<T>::min() / eps));
      const Xyz<T> omega{T(0.3), T(-0.2), T(0.5)};
      CHECK(norm(left_jacobian_inverse_so3(phi, omega)) <= T(1.6) * norm(omega));
    }
  const T nan = L<T>::quiet_NaN();
  CHECK(std::isnan(norm(log_so3(Rotation<T>{{nan, T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}}))));
}

TEST_CASE_TEMPLATE("extremes: ZYZ angles give their rotation again, at their singularities too", T,
                   SKINCTL_EXTREME_SCALARS) {
  const T eps = L<T>::epsilon(), pi = std::atan2(T(0), T(-1));
  for (const T theta : {T(0), L<T>::denorm_min(), eps, T(1e-6), T(1), pi - eps, pi, std::nextafter(pi, T(4))})
    for (const T phi : {T(0), T(-3), pi, T(1e-30), T(204.2)}) {
      const auto R = rotation_zyz(Zyz<T>{phi, theta, T(0.7)});
      const auto angles = zyz_angles(R);
      CAPTURE(theta);
      CAPTURE(phi);
      CHECK(distance_of(rotation_zyz(angles), R) <= 16 * eps);
      CHECK((angles.theta >= T(0) && angles.theta <= pi * (1 + eps)));
    }
}

TEST_CASE_TEMPLATE("extremes: normalised mends a hundredth, and leaves NaN", T, SKINCTL_EXTREME_SCALARS) {
  const T eps = L<T>::epsilon();
  for (const T off : {T(0), L<T>::denorm_min(), eps, T(1e-3), T(4e-3), T(-4e-3)}) {
    auto R = exp_so3(Xyz<T>{T(1), T(-2), T(0.5)});
    R.x.y += off, R.z.x -= off, R.y.y += off;
    CHECK(rotation_error(normalised(R)) <= 8 * eps);
  }
  auto R = exp_so3(Xyz<T>{T(1), T(-2), T(0.5)});
  R.x.y = L<T>::quiet_NaN();
  CHECK_FALSE(rotation_error(normalised(R)) <= T(1));
}

TEST_CASE_TEMPLATE("extremes: two_sum loses nothing until it overflows", T, SKINCTL_EXTREME_SCALARS) {
  for (const T x : sizes<T>())
    for (const T y : sizes<T>())
      for (const T sign : {T(1), T(-1)}) {
        const T a = x, b = sign * y;
        if (!(std::abs(a) < L<T>::max() / 2 && std::abs(b) < L<T>::max() / 2)) continue;
        const auto sum = math::two_sum(a, b);
        CHECK(sum.value == a + b);
        // The same error from the operand of smaller magnitude: there a difference is exact.
        const T large = std::abs(a) > std::abs(b) ? a : b, small = std::abs(a) > std::abs(b) ? b : a;
        CHECK(sum.error == small - (sum.value - large));
        CHECK(std::abs(sum.error) <= std::abs(sum.value) * L<T>::epsilon() / 2);
      }
}

TEST_CASE("extremes: durations in seconds and back, and clocks at the ends of 64 bits") {
  const auto last = Nanoseconds::max(), first = Nanoseconds::min();
  for (const Nanoseconds t : {0ns, 1ns, -1ns, Nanoseconds(999'999'999), Nanoseconds(1'000'000'007)})
    CHECK(nanoseconds(seconds<double>(t)) == t);
  for (const double s : {9.3e9, 1e300, HUGE_VAL}) {
    CHECK(nanoseconds(s) == last);
    CHECK(nanoseconds(-s) == first);
  }
  CHECK(nanoseconds(std::nan("")) == 0ns);
  CHECK(seconds<double>(last) == 9223372036.854775807);
  CHECK(std::isfinite(seconds<float>(first)));
  CHECK(milliseconds(last) == doctest::Approx(9.223372036854775e12));
  for (const Nanoseconds dt : {Nanoseconds(0), Nanoseconds(8ms), clock_end})
    CHECK(later(clock_end, dt) == clock_end);
  CHECK(later(clock_end - 8ms, 7ms) == clock_end - 1ms);
}

TEST_CASE_TEMPLATE("extremes: a blend is exact at its ends and lies between them", T,
                   SKINCTL_EXTREME_SCALARS) {
  for (const T a : sizes<T>())
    for (const T b : sizes<T>())
      for (const T w : {T(0), L<T>::denorm_min(), T(0.3), T(1) - L<T>::epsilon(), T(1)}) {
        if (!(a < L<T>::max() / 2 && b < L<T>::max() / 2)) continue;
        const T y = blend(a, T(-b), w);
        if (w == T(0)) CHECK(y == a);
        if (w == T(1)) CHECK(y == -b);
        CHECK((y <= a && y >= -b));
      }
}

TEST_CASE_TEMPLATE("extremes: a tank's share costs what is there, whatever the energies", T,
                   SKINCTL_EXTREME_SCALARS) {
  for (const T x : sizes<T>())
    for (const T w2 : sizes<T>())
      for (const T E : sizes<T>())
        for (const T sign : {T(1), T(-1)}) {
          const T w1 = sign * x;
          if (!(x < L<T>::max() / 4 && w2 < L<T>::max() / 4)) continue;
          CAPTURE(w1);
          CAPTURE(w2);
          CAPTURE(E);
          const T share = affordable_share(w1, w2, E);
          CHECK((share >= T(0) && share <= T(1)));
          const auto s = static_cast<long double>(share), c = static_cast<long double>(w2) * s * s;
          const long double cost = static_cast<long double>(w1) * s + c;
          CHECK(cost <=
                static_cast<long double>(E) + 16 * L<T>::epsilon() * (std::abs(w1 * s) + c) +
                    static_cast<long double>(L<T>::min()) +
                    static_cast<long double>(L<T>::denorm_min()) * (static_cast<long double>(x) + w2));
        }
  for (const T wrong : {T(-1), T(0)}) CHECK(affordable_share(T(1), T(1), wrong) == T(0));
  CHECK(affordable_share(T(1), T(1), L<T>::quiet_NaN()) == T(0));
  CHECK(affordable_share(L<T>::quiet_NaN(), T(1), T(1)) == T(0));
}

TEST_CASE_TEMPLATE("extremes: allowed speeds near a person are numbers that fall with mass and nearness", T,
                   SKINCTL_EXTREME_SCALARS) {
  const BodyRegion region{.force = 140, .blow = 280, .first = 500ms, .stiffness = 25000, .mass = 40};
  T before = L<T>::infinity();
  for (T mass = L<T>::min(); mass < L<T>::max() / 4; mass *= 4) {
    const T v = speed_of_blow(region, mass);
    CHECK(v > T(0));
    CHECK(v <= before);
    before = v;
  }
  CHECK(before == doctest::Approx(280 / std::sqrt(40.0 * 25000)).epsilon(1e-5));
  const Separation apart{.body_speed = 1.6, .reaction_time = 100ms, .deceleration = 2, .margin = 0.1};
  T slower(0);
  for (const T distance : sizes<T>()) {
    const T v = speed_of_separation(apart, distance);
    CHECK(std::isfinite(v));
    CHECK(v >= T(0));
    CHECK(speed_of_separation(apart, T(-distance)) == T(0));
    if (distance > T(1)) slower = std::max(slower, v);
  }
  CHECK(slower > T(1e3));
  CHECK(speed_of_separation(apart, L<T>::quiet_NaN()) == T(0));
}

TEST_CASE_TEMPLATE("extremes: an arm's centre of mass, its height and its slowest directions at any angle", T,
                   SKINCTL_EXTREME_SCALARS) {
  const ur5::Model model;
  for (const T x : sizes<T>())
    for (std::size_t joint = 0; joint < 6; ++joint) {
      JointPosition<6, T> q;
      q[joint] = joint % 2 == 0 ? x : T(-x);
      CAPTURE(x);
      CAPTURE(joint);
      const auto poses = link_poses(model, q);
      const auto centre = centre_of_mass(model, poses);
      CHECK(norm(centre.p) <= T(1));
      CHECK(std::abs(potential_energy(model, q)) <= T(200));
      const auto slow = singular_directions(jacobian<5>(poses));
      CHECK((slow[0].sigma >= T(0) && slow[0].sigma <= slow[1].sigma * (1 + 64 * L<T>::epsilon()) + T(1e-3)));
      CHECK(std::isfinite(slow[1].sigma));
      const auto dq = JointVelocity<6, T>::constant(T(0.5));
      const JointAngles<ur5::Model, T> angles(model, q);
      // Christoffel's C: dq_r and dq may change places.
      const auto dq_r = JointVelocity<6, T>{T(1), T(-2), T(0.5), T(0), T(3), T(-1)};
      const auto a = yr_theta(model, angles, dq, dq_r, {}), b = yr_theta(model, angles, dq_r, dq, {});
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(a[i] - b[i]) <= 400 * L<T>::epsilon());
      CHECK(std::isfinite(bias_torque(model, angles, dq)[0]));
    }
}

TEST_CASE_TEMPLATE("extremes: equations of 1e-38 to 1e307 are solved as those of 1, bit for bit", T,
                   SKINCTL_EXTREME_SCALARS) {
  const T a[9] = {T(4), T(1), T(-0.5), T(1), T(3), T(0.25), T(-0.5), T(0.25), T(2)},
          b[3] = {T(1), T(-2), T(3)};
  T lu_one[3], ldlt_one[3];
  math::Lu<3, T>(a).solve(b, lu_one);
  math::Ldlt<3, T>(a).solve(b, ldlt_one);
  for (int k = L<T>::min_exponent + 12; k < L<T>::max_exponent - 4; ++k) {
    T scaled[9], rows[9], lu[3], ldlt[3];
    for (std::size_t i = 0; i < 9; ++i) {
      scaled[i] = std::ldexp(a[i], k);
      rows[i] = i / 3 == 1 ? scaled[i] : a[i];  // one row alone: other pivots, the same solution
    }
    const math::Lu<3, T> factors(scaled);
    const math::Ldlt<3, T> root(scaled);
    CAPTURE(k);
    REQUIRE(factors.regular());
    REQUIRE(root.positive_definite());
    T by[3];
    for (std::size_t i = 0; i < 3; ++i) by[i] = std::ldexp(b[i], k);
    factors.solve(by, lu), root.solve(by, ldlt);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(lu[i] == lu_one[i]);
      CHECK(ldlt[i] == ldlt_one[i]);
    }
    T mixed[3] = {b[0], std::ldexp(b[1], k), b[2]}, x[3];
    const math::Lu<3, T> uneven(rows);
    uneven.solve(mixed, x);
    for (std::size_t i = 0; i < 3; ++i) CHECK(std::isfinite(x[i]));
  }
  const T nan[9] = {L<T>::quiet_NaN(), T(0), T(0), T(0), T(1), T(0), T(0), T(0), T(1)};
  CHECK_FALSE(math::Lu<3, T>(nan).regular());
  CHECK_FALSE(math::Ldlt<3, T>(nan).positive_definite());
}
