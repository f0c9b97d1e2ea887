// Functions of few numbers at the ends of what a scalar holds: exact, bounded, or refused, never by surprise.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

namespace {

/// Zeros, denormals, every tenth of the exponents, the largest number, both signs.
template <class T>
std::vector<T> extremes() {
  using L = std::numeric_limits<T>;
  std::vector<T> out{T(0), L::denorm_min(), L::min(), T(1), L::max()};
  for (int e = L::min_exponent10; e <= L::max_exponent10; e += L::max_exponent10 / 10)
    out.push_back(std::pow(T(10), T(e)));
  const std::size_t n = out.size();
  for (std::size_t i = 0; i < n; ++i) out.push_back(-out[i]);
  return out;
}
template <class T>
constexpr T infinity = std::numeric_limits<T>::infinity();

}  // namespace

TEST_CASE_TEMPLATE("extremes: exp_so3 is a rotation for every length, and NaN beyond", T, float, double) {
  const T eps = std::numeric_limits<T>::epsilon();
  for (const T x : extremes<T>())
    for (const T y : {T(0), x, T(-x / 3)}) {
      const Xyz<T> phi{x, y, T(x / 7)};
      // The length itself has to be a number.
      if (!(std::hypot(static_cast<long double>(x), static_cast<long double>(y)) * 1.02L <
            static_cast<long double>(std::numeric_limits<T>::max())))
        continue;
      CAPTURE(phi.x);
      CAPTURE(phi.y);
      CHECK(rotation_error(exp_so3(phi)) <= 8 * eps);
      // The angular velocity of a turn is at most as fast as its vector changes, and along the axis it is
      // equal.
      const Xyz<T> dphi{T(0.3), T(-0.2), T(0.5)};
      const Xyz<T> omega = left_jacobian_so3(phi, dphi);
      CHECK(norm(omega) <= norm(dphi) * (1 + 8 * eps));
      if (x != T(0)) {
        const Xyz<T> axis =
            (T(1) / std::hypot(T(1), T(y / x), T(1) / T(7))) * Xyz<T>{T(1), T(y / x), T(1) / T(7)};
        CHECK(std::abs(dot(axis, omega) - dot(axis, dphi)) <= 8 * eps);
      }
    }
  // Just below and beyond the change of formula the rotation is the same.
  for (const T x :
       {std::sqrt(detail::far_around<T>()) * T(0.999), std::sqrt(detail::far_around<T>()) * T(1.001)}) {
    const Xyz<T> phi{T(0.6) * x, T(0), T(-0.8) * x};
    const T angle = norm(phi);
    const T trace = 1 + 2 * std::cos(angle);
    const auto R = exp_so3(phi);
    CHECK(std::abs(R.x.x + R.y.y + R.z.z - trace) <= 16 * eps);
  }
  for (const T wrong : {infinity<T>, -infinity<T>, std::numeric_limits<T>::quiet_NaN()})
    CHECK(std::isnan(exp_so3(Xyz<T>{wrong, T(0), T(1)}).x.x));
}

TEST_CASE_TEMPLATE("extremes: speed_to_stop stops within the distance, whatever the numbers", T, float,
                   double) {
  for (const T d : extremes<T>())
    for (const T t : extremes<T>())
      for (const T a : extremes<T>()) {
        if (t < 0 || a <= 0) continue;
        const T u = speed_to_stop(d, t, a);
        CAPTURE(d);
        CAPTURE(t);
        CAPTURE(a);
        CHECK(u >= T(0));
        if (!(d > T(0))) CHECK(u == T(0));
        // u is rounded to a number of T, denormal ones to the nearest of few.
        const auto w = static_cast<long double>(u > T(0) ? u - std::numeric_limits<T>::denorm_min() : u);
        const auto needed = w * w / (2 * static_cast<long double>(a)) + w * static_cast<long double>(t);
        CHECK(needed <=
              static_cast<long double>(d > T(0) ? d : T(0)) * (1 + 8 * std::numeric_limits<T>::epsilon()) +
                  static_cast<long double>(std::numeric_limits<T>::denorm_min()));
      }
  CHECK(speed_to_stop(std::numeric_limits<T>::quiet_NaN(), T(0), T(1)) == T(0));
  CHECK(speed_to_stop(T(0.5), T(0), T(4)) == T(2));
  CHECK(speed_to_stop(infinity<T>, T(0), T(4)) > T(1e8));
}

TEST_CASE_TEMPLATE("extremes: a wrapped angle lies between -pi and pi, for any finite angle", T, float,
                   double) {
  const T pi = std::atan2(T(0), T(-1)), eps = std::numeric_limits<T>::epsilon();
  const auto check = [&](T x) {
    CAPTURE(x);
    const T y = wrapped(x);
    CHECK(y >= -pi);
    CHECK(y <= pi);
    CHECK(std::abs(std::sin(y) - std::sin(x)) <= 4 * eps);
    CHECK(std::abs(std::cos(y) - std::cos(x)) <= 4 * eps);
  };
  check(static_cast<T>(204.203522));
  for (const T x : extremes<T>()) check(x);
  for (int k = -3000; k <= 3000; ++k)
    for (const T off : {T(-1e-3), T(0), T(1e-3)}) check(T(k) * pi / 2 + off);
  for (const T x : {T(0.25), T(-3), pi, T(-pi)}) CHECK(wrapped(x) == x);
  CHECK(std::isnan(wrapped(infinity<T>)));
}

TEST_CASE_TEMPLATE("extremes: a pursuit goes on after a target of any finite distance and speed", T, float,
                   double) {
  const PursuitLimits<T> limits{T(1), T(2), T(20)};
  const T dt = T(0.008);
  for (const T distance : extremes<T>())
    for (const T speed : extremes<T>()) {
      if (!(std::abs(distance) < std::numeric_limits<T>::max() / 2 &&
            std::abs(speed) < std::numeric_limits<T>::max() / 2))
        continue;
      CAPTURE(distance);
      CAPTURE(speed);
      Pursuit<3, T> motion;
      T moved[3];
      for (int k = 0; k < 300; ++k) {
        const T before[3] = {motion.v[0], motion.v[1], motion.v[2]};
        motion.advance({distance, T(0), T(0)}, {T(0), speed, T(0)}, limits, dt, moved);
        T faster(0), fast(0);
        for (std::size_t i = 0; i < 3; ++i) {
          REQUIRE(std::isfinite(motion.v[i]));
          REQUIRE(std::isfinite(moved[i]));
          faster += (motion.v[i] - before[i]) * (motion.v[i] - before[i]);
          fast += motion.v[i] * motion.v[i];
        }
        REQUIRE(std::sqrt(fast) <= limits.velocity * (1 + T(1e-5)));
        REQUIRE(std::sqrt(faster) <= limits.acceleration * dt * (1 + T(1e-5)));
      }
      // A target farther or faster than can be reached soon is followed at speed.
      if (std::max(std::abs(distance), std::abs(speed)) > T(10)) {
        const T size = std::sqrt(motion.v[0] * motion.v[0] + motion.v[1] * motion.v[1]);
        CHECK(size > T(0.9) * limits.velocity);
      }
    }
}

TEST_CASE("extremes: defaults fit every allowed period, delay and lag") {
  for (const Nanoseconds period :
       {100us, 500us, 1000us, 2000us, 8000us, 100'000us, 400'000us, 500'000us, 1'000'000us})
    for (const Nanoseconds delay : {0ms, 8ms, 1000ms})
      for (const Nanoseconds lag : {0ms, 30ms, 1000ms}) {
        CAPTURE(period.count());
        CAPTURE(delay.count());
        CAPTURE(lag.count());
        RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0),
                                .period = period,
                                .delay = delay,
                                .lag = lag,
                                .virtual_damping = 4};
        CHECK_NOTHROW(check(c));
        CHECK_NOTHROW(static_cast<void>(by_position(ur5::Model{}, c)));
        CHECK_NOTHROW((JointGuard<Interface::position, 6>(c)));
        CHECK_NOTHROW((JointGuard<Interface::velocity, 6>(c)));
      }
  for (const Nanoseconds wrong : {0us, 99us, 1'000'001us}) {
    RobotConfiguration<6> c{
        .limits = limits_of<ur5::Description>(15.0), .period = wrong, .virtual_damping = 4};
    CHECK_THROWS_AS(check(c), ConfigurationError);
  }
}
