#include "skinctl/trajectory/quintic.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class T>
std::vector<T> telling_ratios() {
  std::vector<T> r{T(0),    T(1e-30), T(1e-8), T(1e-4), T(0.125), T(0.2499999), T(0.25), T(0.2500001),
                   T(0.49), T(0.5),   T(0.51), T(0.75), T(0.9),   T(0.9999),    T(1)};
  r.push_back(T(0.5) - epsilon<T>());
  r.push_back(T(0.5) + epsilon<T>());
  r.push_back(T(1) - epsilon<T>());
  Seeded rng(1);
  for (int i = 0; i < 2000; ++i) r.push_back(static_cast<T>(rng.between(0, 1)));
  return r;
}
// Eq. (22) as printed.
template <class T>
T printed(const T& r) {
  return T(10) * r * r * r - T(15) * r * r * r * r + T(6) * r * r * r * r * r;
}
}  // namespace

TEST_CASE_TEMPLATE("Quintic: is the polynomial of eq. (22) and its derivatives", T, float, double) {
  for (const T& r : telling_ratios<T>()) {
    CAPTURE(r);
    const auto q = quintic(r, T(3));
    const Digits50 x(r), left = 1 - x;
    const Digits50 a1 = printed(x), a2 = 30 * x * x * left * left, a3 = 60 * x * left * (1 - 2 * x);
    const T ulps = T(8) * epsilon<T>();
    CHECK(magnitude(Digits50(q.a1) - a1) <= Digits50(ulps) * a1 + Digits50(std::numeric_limits<T>::min()));
    CHECK(magnitude(Digits50(q.rest) - printed(left)) <= Digits50(ulps) * printed(left));
    CHECK(magnitude(Digits50(q.a2) - 3 * a2) <=
          Digits50(ulps) * 3 * a2 + Digits50(std::numeric_limits<T>::min()));
    CHECK(magnitude(Digits50(q.a3) - 9 * a3) <= Digits50(ulps) * 9 * magnitude(a3));
  }
}

TEST_CASE_TEMPLATE("Quintic: begins and ends at rest, exactly, and stays there", T, float, double, Digits50) {
  for (const T& r : {T(0), T(-1e-30), T(-5), T(-std::numeric_limits<T>::infinity())}) {
    const auto q = quintic(r);
    CHECK(q.a1 == T(0));
    CHECK(q.rest == T(1));
    CHECK(q.a2 == T(0));
    CHECK(q.a3 == T(0));
  }
  for (const T& r :
       {T(1), T(1.5), T(std::numeric_limits<T>::infinity()), T(std::numeric_limits<T>::quiet_NaN())}) {
    const auto q = quintic(r);
    CHECK(q.a1 == T(1));
    CHECK(q.rest == T(0));
    CHECK(q.a2 == T(0));
    CHECK(q.a3 == T(0));
  }
  CHECK(quintic(T(0.5)).a1 == T(0.5));
  CHECK(quintic(T(0.5)).a2 == quintic_peak_speed<T>);
  CHECK(quintic(T(0.5)).a3 == T(0));
}

TEST_CASE_TEMPLATE("Quintic: is symmetric about the middle", T, float, double, Digits50) {
  for (const T& r : telling_ratios<T>()) {
    const T mirrored = T(1) - r;
    if (T(1) - mirrored != r) continue;
    CAPTURE(r);
    const auto a = quintic(r), b = quintic(mirrored);
    CHECK(a.a1 == b.rest);
    CHECK(a.rest == b.a1);
    CHECK(a.a2 == b.a2);
    CHECK(a.a3 == -b.a3);
  }
}

TEST_CASE("Quintic: never decreases in float, on every float from 1/16 to 1 and every 64th below") {
  const auto from_bits = [](std::uint32_t bits) {
    float x;
    static_assert(sizeof x == sizeof bits);
    __builtin_memcpy(&x, &bits, sizeof x);
    return x;
  };
  const auto bits_of = [](float x) {
    std::uint32_t bits;
    __builtin_memcpy(&bits, &x, sizeof x);
    return bits;
  };
  float last = 0, last_rest = 1, last_printed = 0;
  long falls = 0, rises = 0, printed_falls = 0;
  const auto look = [&](std::uint32_t bits) {
    const float r = from_bits(bits);
    const auto q = quintic(r);
    falls += q.a1 < last;
    rises += q.rest > last_rest;
    last = q.a1;
    last_rest = q.rest;
    const float p = printed(r);
    printed_falls += p < last_printed;
    last_printed = p;
  };
  for (std::uint32_t bits = 1; bits < bits_of(0.0625f); bits += 64) look(bits);
  for (std::uint32_t bits = bits_of(0.0625f); bits <= bits_of(1.0f); ++bits) look(bits);
  CHECK(falls == 0);
  CHECK(rises == 0);
  CHECK(last == 1.0f);
  CHECK(printed_falls > 1000);  // the test can see what it looks for
}

TEST_CASE("Quintic: never decreases in double around the places where its formula changes") {
  for (const double middle : {1e-3, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1 - 1e-3}) {
    double r = middle, last = quintic(middle).a1;
    for (int i = 0; i < 100000; ++i) {
      r = std::nextafter(r, 2.0);
      const double a1 = quintic(r).a1;
      if (!(a1 >= last)) FAIL_CHECK("falls at r = " << r);
      last = a1;
    }
  }
}

TEST_CASE("Quintic: its greatest speed and acceleration are what limits are computed with") {
  double speed = 0, acceleration = 0;
  for (int i = 0; i <= 100000; ++i) {
    const auto q = quintic(i * 1e-5);
    speed = std::max(speed, q.a2);
    acceleration = std::max(acceleration, std::abs(q.a3));
  }
  CHECK(speed == doctest::Approx(quintic_peak_speed<double>).epsilon(1e-12));
  CHECK(acceleration == doctest::Approx(quintic_peak_acceleration<double>).epsilon(1e-9));
}

TEST_CASE(
    "MovingStart: begins with the given rates, ends as the quintic, never turns back; its derivatives "
    "agree") {
  for (const double tf : {0.1, 1.0, 7.0})
    for (const double v : {0.01, 0.5, 1.2, 2.4, 2.6, 30.0})  // over tf; beyond 2.5 a part of it
      for (const double a : {-4.0, 0.0, 4.0}) {
        const auto start = MovingStart<double>::along(2.0, 2 * v / tf, 2 * a / (tf * tf), tf);
        const auto at = [&](double r) { return quintic(r, 1 / tf) + start.at(r, tf); };
        CHECK(at(1e-12).a2 == doctest::Approx(std::min(v, 2.5) / tf));
        CHECK(at(1.0).a1 == 1);
        CHECK(at(1.0).a2 == 0);
        CHECK(at(1.0).a3 == 0);
        double last = 0;
        for (double r = 0.001; r < 1; r += 0.001) {
          const auto now = at(r), before = at(r - 1e-6), after = at(r + 1e-6);
          CHECK(now.a2 == doctest::Approx((after.a1 - before.a1) / (2e-6 * tf)).epsilon(1e-6).scale(1 / tf));
          CHECK(now.a3 ==
                doctest::Approx((after.a2 - before.a2) / (2e-6 * tf)).epsilon(1e-5).scale(1 / (tf * tf)));
          CHECK(now.a1 + now.rest == doctest::Approx(1));
          if (a == 0) CHECK(now.a1 >= last - 1e-15);
          last = now.a1;
        }
      }
  CHECK(MovingStart<double>::along(1, -0.5, 0, 1).rate == 0);
  CHECK(MovingStart<double>::along(0, 0.5, 0, 1).rate == 0);
}
