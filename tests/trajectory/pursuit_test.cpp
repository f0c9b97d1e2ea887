#include "skinctl/trajectory/pursuit.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <std::size_t D>
double length(const double (&x)[D]) {
  double sum = 0;
  for (const double y : x) sum += y * y;
  return std::sqrt(sum);
}
/// Random jumps of the target, its velocity and NaNs between; velocity, acceleration and jerk are watched.
template <std::size_t D>
void jump(double rate, const PursuitLimits<double>& l, unsigned seed) {
  Seeded rng(seed);
  Pursuit<D> x;
  double e[D], v_t[D] = {}, moved[D], p[D] = {}, target[D] = {};
  const double dt = 1 / rate;
  for (int i = 0; i < static_cast<int>(40 * rate); ++i) {
    const int phase = i % static_cast<int>(rate);
    if (phase == 0 || rng() > 0.99)
      for (std::size_t k = 0; k < D; ++k)
        target[k] = std::pow(10, rng.between(-4, 1)) * rng(), v_t[k] = 0.2 * rng();
    for (std::size_t k = 0; k < D; ++k) target[k] += dt * v_t[k];
    for (std::size_t k = 0; k < D; ++k) e[k] = rng() > 0.998 ? std::nan("") : target[k] - p[k];
    const auto before = x;
    x.advance(e, v_t, l, dt, moved);
    double da[D];
    for (std::size_t k = 0; k < D; ++k) p[k] += moved[k], da[k] = (x.a[k] - before.a[k]) / dt;
    REQUIRE(length(x.v) <= l.velocity);
    REQUIRE(length(x.a) <= l.acceleration * (1 + 1e-12));
    REQUIRE(length(da) <= l.jerk * (1 + 1e-9));
    for (std::size_t k = 0; k < D; ++k)
      CHECK(magnitude(moved[k] - 0.5 * dt * (before.v[k] + x.v[k])) <= 1.01 * l.jerk * dt * dt * dt / 12);
  }
}
}  // namespace

TEST_CASE("Pursuit: any jump of the target keeps the limits of velocity, acceleration and jerk") {
  jump<1>(125, {1, 4, 40}, 1);
  jump<1>(1000, {1, 4, 40}, 2);
  jump<3>(125, {0.25, 1.5, 15}, 3);
  jump<3>(500, {0.25, 1.5, 15}, 4);
}

TEST_CASE("Pursuit: reaches a target that stands without overshoot, and meets one that moves") {
  const PursuitLimits<double> l{1, 4, 40};
  for (const double rate : {125.0, 1000.0}) {
    for (const double step : {1e-3, 0.1, 1.0, 4.0}) {
      Pursuit<1> x;
      double p = 0, most = 0, moved[1];
      const double still[1] = {0}, drift[1] = {0.3};
      for (int i = 0; i < static_cast<int>((4 + step) * rate); ++i) {
        const double e[1] = {step - p};
        x.advance(e, still, l, 1 / rate, moved);
        p += moved[0];
        most = std::max(most, p);
      }
      CHECK(p == doctest::Approx(step).epsilon(1e-3));
      CHECK(most < step * (1 + 1e-3));
      double target = p + step;
      for (int i = 0; i < static_cast<int>((5 + 2 * step) * rate); ++i) {
        target += 0.3 / rate;
        const double e[1] = {target - p};
        x.advance(e, drift, l, 1 / rate, moved);
        p += moved[0];
      }
      CHECK(p == doctest::Approx(target).epsilon(2e-3));
      CHECK(x.v[0] == doctest::Approx(0.3).epsilon(1e-3));
    }
  }
}

TEST_CASE("Pursuit: stops within its braking distance when the target vanishes") {
  const PursuitLimits<double> l{1, 4, 40};
  Pursuit<1> x;
  double p = 0, moved[1];
  const double still[1] = {0};
  for (int i = 0; i < 2000; ++i) {
    const double e[1] = {100};
    x.advance(e, still, l, 0.002, moved);
  }
  CHECK(x.v[0] > 0.96);
  const double speed = x.v[0];
  for (int i = 0; i < 3000; ++i) {
    const double nothing[1] = {std::nan("")};
    x.advance(nothing, still, l, 0.002, moved);
    p += moved[0];
  }
  CHECK(p <= Pursuit<1>::braking_distance(l, speed));
  CHECK(magnitude(x.v[0]) < 1e-6);
  CHECK_THROWS_AS(check(PursuitLimits<double>{1, 0, 1}), ConfigurationError);
}
