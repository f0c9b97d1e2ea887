#include "skinctl/math/sincos.hpp"

#include <doctest/doctest.h>

#include <array>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "math/exact_error.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// What the docstring promises.
template <class T>
struct Promise;
template <>
struct Promise<double> {
  static constexpr double limit = 1e6, ulp = 2.5, absolute = 2.1e-16, near_zero = 2e-31;
};
template <>
struct Promise<float> {
  static constexpr double limit = 800, ulp = 2.5, absolute = 1.13e-7, near_zero = 4e-14;
};

template <class T>
void check_promise(T x, const math::SinCos<T>& y) {
  using P = Promise<T>;
  INFO("x = ", as_code(x));
  const Digits50 s = sin(Digits50(x)), c = cos(Digits50(x));
  CHECK(error_in_ulp(y.sin, s, P::near_zero) <= P::ulp);
  CHECK(error_in_ulp(y.cos, c, P::near_zero) <= P::ulp);
  CHECK(absolute_error(y.sin, s) <= P::absolute);
  CHECK(absolute_error(y.cos, c) <= P::absolute);
}

/// The number of type T next to k quarter turns, and its neighbours: where sine or cosine nearly vanish.
template <class T>
std::array<T, 3> around_quarter_turn(double k) {
  const T x = static_cast<T>(Digits50(k) * boost::math::constants::half_pi<Digits50>());
  return {std::nextafter(x, T(-1e9)), x, std::nextafter(x, T(1e9))};
}

template <class T>
bool same(T a, T b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

TEST_CASE_TEMPLATE("sincos: error within what is promised, up to the limit of the polynomial", T, float,
                   double) {
  auto random = seeded(1);
  for (const double reach : {0.8, 3.2, 100.0, Promise<T>::limit}) {
    CAPTURE(reach);
    for (int i = 0; i < 400; ++i) {
      const T x = uniform(random, T(-reach), T(reach));
      check_promise(x, math::sincos(x));
    }
  }
  for (T x : {T(1e-8), T(1), T(Promise<T>::limit), std::nextafter(T(Promise<T>::limit), T(0))}) {
    check_promise(x, math::sincos(x));
    check_promise(T(-x), math::sincos(T(-x)));
  }
}

TEST_CASE_TEMPLATE("sincos: error within what is promised next to multiples of pi/2 and between", T, float,
                   double) {
  auto random = seeded(2);
  const double quarter_turns = Promise<T>::limit / 1.5707964;
  for (int i = 0; i < 600; ++i) {
    const double k = i < 40 ? i : std::floor(uniform(random, -quarter_turns + 1, quarter_turns - 1));
    for (const T x : around_quarter_turn<T>(k)) check_promise(x, math::sincos(x));
    // Where the quadrant changes.
    for (const T x : around_quarter_turn<T>(k + 0.5)) check_promise(x, math::sincos(x));
  }
}

TEST_CASE_TEMPLATE("sincos: beyond the limit as exact as the standard library", T, float, double) {
  auto random = seeded(3);
  const T limit = T(Promise<T>::limit);
  std::vector<T> large = {std::nextafter(limit, std::numeric_limits<T>::max()), limit * T(2),
                          std::numeric_limits<T>::max(), T(1e15)};
  if constexpr (sizeof(T) == 8) large.insert(large.end(), {1e300, 6381956970095103.0 * 0x1p797});
  for (int i = 0; i < 100; ++i) large.push_back(limit * T(std::pow(T(1e6), uniform(random, T(0), T(1)))));
  for (const T magnitude : large)
    for (const T x : {magnitude, T(-magnitude)}) {
      INFO("x = ", as_code(x));
      const auto y = math::sincos(x);
      CHECK(y.sin == std::sin(x));
      CHECK(y.cos == std::cos(x));
    }
}

TEST_CASE_TEMPLATE("sincos: at zero, tiny, denormal, infinite and NaN arguments", T, float, double) {
  using Limits = std::numeric_limits<T>;
  for (const T tiny : {T(0), Limits::denorm_min(), Limits::min(), Limits::min() * T(5), T(1e-30), T(1e-12)})
    for (const T x : {tiny, T(-tiny)}) {
      INFO("x = ", as_code(x));
      const auto y = math::sincos(x);
      CHECK(same(y.sin, x));
      CHECK(y.cos == T(1));
    }
  for (const T x : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
    const auto y = math::sincos(x);
    CHECK(std::isnan(y.sin));
    CHECK(std::isnan(y.cos));
  }
}

TEST_CASE_TEMPLATE("sincos: odd and even to the last bit, and on the unit circle", T, float, double) {
  auto random = seeded(4);
  for (int i = 0; i < 20000; ++i) {
    const T x = random_or_extreme(random, i % 2 == 0 ? T(4) : T(700));
    const auto y = math::sincos(x), minus = math::sincos(T(-x));
    REQUIRE(same(minus.sin, T(-y.sin)));
    REQUIRE(same(minus.cos, y.cos));
    REQUIRE(std::abs(y.sin * y.sin + y.cos * y.cos - T(1)) <= T(4) * std::numeric_limits<T>::epsilon());
    REQUIRE(std::abs(y.sin) <= T(1));
    REQUIRE(std::abs(y.cos) <= T(1));
  }
}

namespace {
template <class T, std::size_t N>
void check_row(Random& random, bool with_large) {
  std::array<T, N> x = random_array<N>(random, T(7)), s{}, c{};
  if (with_large) {
    x[N / 2] = T(1e8);
    x[N - 1] = std::numeric_limits<T>::infinity();
  }
  math::sincos(x, s, c);
  for (std::size_t i = 0; i < N; ++i) {
    CAPTURE(N);
    CAPTURE(i);
    const auto y = math::sincos(x[i]);
    CHECK((same(s[i], y.sin) || (std::isnan(s[i]) && std::isnan(y.sin))));
    CHECK((same(c[i], y.cos) || (std::isnan(c[i]) && std::isnan(y.cos))));
  }
}
}  // namespace

TEST_CASE_TEMPLATE("sincos: a row of any length gives what its numbers give one by one", T, float, double) {
  auto random = seeded(5);
  for (const bool with_large : {false, true}) {
    [&]<std::size_t... N>(std::index_sequence<N...>) {
      (check_row<T, N + 1>(random, with_large), ...);
    }(std::make_index_sequence<33>{});
  }
}

TEST_CASE_TEMPLATE("sincos: lanes do not depend on each other, whatever stands in them", T, float, double) {
  constexpr std::size_t W = native_lanes<T>;
  using L = Lane<T, W>;
  auto random = seeded(6);
  for (int i = 0; i < 200; ++i) {
    T x[W];
    for (auto& value : x) value = random_or_extreme(random, T(1000));
    if (i % 3 == 0) x[0] = std::numeric_limits<T>::quiet_NaN();
    if (i % 5 == 0) x[W - 1] = T(1e30);
    const auto lanes = math::sincos(L::load(x));
    for (std::size_t k = 0; k < W; ++k) {
      const auto one = math::sincos(x[k]);
      CHECK((same(lanes.sin[k], one.sin) || std::isnan(x[k])));
      CHECK((same(lanes.cos[k], one.cos) || std::isnan(x[k])));
    }
    const L row[3] = {L::load(x), L(T(1)), L(T(-2))};
    L s[3], c[3];
    math::sincos<3>(row, s, c);
    CHECK((same(s[0][W - 1], lanes.sin[W - 1]) && same(c[2][0], math::sincos(T(-2)).cos)));
  }
}

TEST_CASE_TEMPLATE("sincos: Libm is the standard library, number by number", T, float, double) {
  auto random = seeded(7);
  using L = Lane<T>;
  const auto x = random_array<17>(random, T(1e4));
  std::array<T, 17> s{}, c{};
  math::sincos<math::Libm>(x, s, c);
  for (std::size_t i = 0; i < 17; ++i) {
    CHECK(s[i] == std::sin(x[i]));
    CHECK(c[i] == std::cos(x[i]));
    CHECK(math::sincos<math::Libm>(x[i]).sin == s[i]);
    CHECK(math::sincos<math::Libm>(L(x[i])).cos[0] == c[i]);
  }
}

TEST_CASE("sincos: 50 digits stay 50 digits") {
  const Digits50 x = Digits50(1) / 3;
  const auto y = math::sincos(x);
  CHECK(abs(y.sin * y.sin + y.cos * y.cos - 1) < Digits50(1e-49));
  Digits50 s[2], c[2];
  const Digits50 angles[2] = {x, -x};
  math::sincos<2>(angles, s, c);
  CHECK(s[1] == -y.sin);
  CHECK(c[0] == y.cos);
}

TEST_CASE("sincos: does not allocate, also beyond the limit") {
  std::array<double, 6> x{0, 1, -2, 3, 1e9, 1e300}, s{}, c{};
  const AllocationGuard guard;
  math::sincos(x, s, c);
  const auto count = guard.count();
  CHECK(count == 0);
}
