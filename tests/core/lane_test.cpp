#include "skinctl/core/lane.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/robot_table.hpp"

using namespace skinctl;

static_assert(is_lane<Lane<double>> && !is_lane<double>);
static_assert(Scalar<Lane<float>> && !Real<Lane<float>>);
static_assert(std::is_same_v<RealOf<Lane<float>>, float>);
static_assert(std::is_trivially_copyable_v<Lane<double>>);
static_assert(sizeof(Lane<double>) == native_lanes<double> * sizeof(double));

TEST_CASE_TEMPLATE("lane: every operation works lane by lane as on a plain number", T, float, double) {
  constexpr std::size_t W = native_lanes<T>;
  using L = Lane<T, W>;
  oracle::Random random(1);
  for (int k = 0; k < 200; ++k) {
    T a[W], b[W], out[W];
    for (std::size_t i = 0; i < W; ++i) {
      a[i] = static_cast<T>(random.uniform(-4, 4));
      b[i] = static_cast<T>(random.uniform(0.1, 4));
    }
    const L x = L::load(a), y = L::load(b);
    const auto check = [&](const L& z, auto plain) {
      z.store(out);
      for (std::size_t i = 0; i < W; ++i) {
        CHECK(out[i] == plain(a[i], b[i]));
        CHECK(z[i] == out[i]);
      }
    };
    check(x + y, [](T p, T q) { return p + q; });
    check(x - y, [](T p, T q) { return p - q; });
    check(x * y, [](T p, T q) { return p * q; });
    check(x / y, [](T p, T q) { return p / q; });
    check(-x, [](T p, T) { return -p; });
    check(abs(x), [](T p, T) { return std::abs(p); });
    check(sqrt(y), [](T, T q) { return std::sqrt(q); });
    check(select(x > T(0), x, y), [](T p, T q) { return p > 0 ? p : q; });
    check(T(2) * x, [](T p, T) { return 2 * p; });
    bool some = false, every = true;
    for (std::size_t i = 0; i < W; ++i) some = some || a[i] < b[i], every = every && a[i] < b[i];
    CHECK(any(x < y) == some);
    CHECK(all(x < y) == every);
  }
}
