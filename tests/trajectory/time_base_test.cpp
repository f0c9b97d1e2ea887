#include "skinctl/trajectory/time_base.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
// dx = -f(t) x from 0 to 1, Runge-Kutta of fourth order.
template <class T, class F>
T decayed(const T& from, const T& to, int steps, const F& f) {
  T x(1), t = from;
  const T h = (to - from) / T(steps);
  for (int i = 0; i < steps; ++i) {
    const T middle = f(T(t + h / T(2))), begin = f(t), end = f(T(from + (to - from) * T(i + 1) / T(steps)));
    const T k1 = -begin * x;
    const T k2 = -middle * (x + h / T(2) * k1);
    const T k3 = -middle * (x + h / T(2) * k2);
    const T k4 = -end * (x + h * k3);
    x += h / T(6) * (k1 + T(2) * k2 + T(2) * k3 + k4);
    t += h;
  }
  return x;
}
}  // namespace

TEST_CASE("TimeBase: peaks at 0.8755 tb with 14.465/tb, and the error's speed at 1.886 x0/tb") {
  const TimeBase<> base;
  CHECK(base.peak_time() == doctest::Approx(0.8755).epsilon(1e-4));
  CHECK(base.peak_gain() == doctest::Approx(14.465).epsilon(1e-4));
  CHECK(base.peak_speed() == doctest::Approx(1.886).epsilon(5e-4));
}

TEST_CASE("TimeBase: brings an error to x0 (delta / (1 + delta))^(1 + eps), whatever tb is") {
  for (const double eps : {0.01, 0.05, 1.0})
    for (const double delta : {1e-3, 0.01, 0.3}) {
      const TimeBase<> base(eps, delta);
      const double expected = std::pow(delta / (1 + delta), 1 + eps);
      CHECK(base.remaining(1) == doctest::Approx(expected).epsilon(1e-12));
      for (const double tb : {0.1, 1.0, 30.0}) {
        CAPTURE(eps);
        CAPTURE(delta);
        CAPTURE(tb);
        const double x = decayed(0.0, tb, 20000, [&](double t) { return base.gain(t / tb).K / tb; });
        CHECK(x == doctest::Approx(expected).epsilon(1e-7));
      }
      const double half = decayed(0.0, 0.7, 20000, [&](double t) { return base.gain(t).K; });
      CHECK(half == doctest::Approx(base.remaining(0.7)).epsilon(1e-9));
    }
}

TEST_CASE("TimeBase: dK is the derivative of K, against differences in 50 digits") {
  const TimeBase<Digits50> exact(Digits50(0.05), Digits50(0.01));
  const TimeBase<double> base(0.05, 0.01);
  const TimeBase<float> coarse(0.05f, 0.01f);
  Seeded rng(3);
  const Digits50 h("1e-15");
  for (int i = 0; i < 300; ++i) {
    const double r = i < 10 ? std::pow(0.1, i + 1) : i < 20 ? 1 - std::pow(0.1, i - 9) : rng.between(0, 1);
    CAPTURE(r);
    const Digits50 x(r);
    const Digits50 slope = (exact.gain(x + h).K - exact.gain(x - h).K) / (2 * h);
    const Digits50 scale = magnitude(slope) + 1e-3;
    CHECK(magnitude(exact.gain(x).dK - slope) <= Digits50("1e-25") * (scale + 1000));
    CHECK(magnitude(Digits50(base.gain(r).dK) - slope) <= Digits50(1e-12) * (scale + 100));
    CHECK(magnitude(Digits50(base.gain(r).K) - exact.gain(x).K) <= Digits50(4e-15) * exact.gain(x).K);
    const float rf = static_cast<float>(r);
    if (rf > 0.0f && rf < 1.0f)
      CHECK(magnitude(Digits50(coarse.gain(rf).K) - exact.gain(Digits50(rf)).K) <=
            Digits50(4e-6) * exact.gain(Digits50(rf)).K);
  }
}

TEST_CASE_TEMPLATE("TimeBase: starts and ends with K = dK = 0, and is 0 outside", T, float, double,
                   Digits50) {
  const TimeBase<T> base;
  for (const T& r : {T(-1), T(0), T(1), T(2)}) {
    CHECK(base.gain(r).K == T(0));
    CHECK(base.gain(r).dK == T(0));
  }
}

TEST_CASE("TimeBase: finds its peaks for every shape") {
  Seeded rng(4);
  for (int i = 0; i < 200; ++i) {
    const double eps = std::pow(10.0, rng.between(-6, 1)), delta = std::pow(10.0, rng.between(-9, 1));
    const TimeBase<> base(eps, delta);
    CAPTURE(eps);
    CAPTURE(delta);
    double gain = 0, speed = 0;
    for (int k = 1; k < 4000; ++k) {
      const double r = k / 4000.0;
      gain = std::max(gain, base.gain(r).K);
      speed = std::max(speed, base.gain(r).K * base.remaining(r));
    }
    CHECK(gain <= base.peak_gain() * (1 + 1e-12));
    CHECK(speed <= base.peak_speed() * (1 + 1e-12));
    if (delta > 1e-3) CHECK(gain == doctest::Approx(base.peak_gain()).epsilon(1e-4));
    CHECK(speed == doctest::Approx(base.peak_speed()).epsilon(1e-5));
    CHECK(magnitude(base.gain(base.peak_time()).dK) <= 1e-6 * base.peak_gain() * base.peak_gain());
  }
}

TEST_CASE("TimeBase: peaks in float and 50 digits are those in double") {
  const TimeBase<float> f;
  const TimeBase<double> d;
  const TimeBase<Digits50> e(Digits50(0.05), Digits50(0.01));
  CHECK(static_cast<double>(f.peak_gain()) == doctest::Approx(d.peak_gain()).epsilon(1e-5));
  CHECK(static_cast<double>(f.peak_time()) == doctest::Approx(d.peak_time()).epsilon(1e-5));
  CHECK(static_cast<double>(e.peak_gain()) == doctest::Approx(d.peak_gain()).epsilon(1e-14));
  CHECK(static_cast<double>(e.peak_speed()) == doctest::Approx(d.peak_speed()).epsilon(1e-14));
  CHECK(magnitude(e.gain(e.peak_time()).dK) < Digits50("1e-40"));
}

TEST_CASE("TimeBase: refuses shapes that cannot work, with the number") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -0.1, 1e-320, 11.0, nan}) {
    if (bad != 1e-320) CHECK_THROWS_AS(TimeBase<>(bad, 0.01), ConfigurationError);
    CHECK_THROWS_AS(TimeBase<>(0.05, bad), ConfigurationError);
  }
  CHECK_THROWS_WITH_AS(TimeBase<>(0.05, -0.5), "skinctl: delta of the time base = -0.5, allowed: 1e-12 to 10",
                       ConfigurationError);
}
