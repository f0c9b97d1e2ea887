#include "skinctl/tracking/surface_bias.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <type_traits>

#include "skinctl/testing/random.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<SurfaceBias<6>>);

namespace {
template <class T>
SurfaceBias<3, T> some_bias(Seeded& rng, Nanoseconds elapsed) {
  SurfaceBias<3, T> b;
  b.decaying = rng.vector<JointVelocity<3, T>>(2);
  b.dv = rng.vector<JointVelocity<3, T>>(2);
  b.da = rng.vector<JointAcceleration<3, T>>(50);
  b.dj = rng.vector<JointAcceleration<3, T>>(1000);
  b.elapsed = elapsed;
  return b;
}
}  // namespace

TEST_CASE("SurfaceBias: dS_d is the derivative of S_d, in 50 digits") {
  Seeded rng(20);
  const Digits50 h("1e-15"), kappa(10), T_h("0.1");
  for (int i = 0; i < 100; ++i) {
    const auto b = some_bias<Digits50>(rng, nanoseconds(rng.between(0, 0.15)));
    const Digits50 x(rng.between(1e-6, 0.02));
    const auto before = b.at(x - h, kappa, T_h), now = b.at(x, kappa, T_h), after = b.at(x + h, kappa, T_h);
    for (std::size_t j = 0; j < 3; ++j)
      CHECK(magnitude((after.S_d[j] - before.S_d[j]) / (2 * h) - now.dS_d[j]) < Digits50("1e-22"));
  }
}

TEST_CASE("SurfaceBias: the rate of dS_d begins with dj and ends with nothing, in 50 digits") {
  Seeded rng(23);
  const Digits50 h("1e-15"), kappa(10), T_h("0.1");
  for (int i = 0; i < 20; ++i) {
    auto b = some_bias<Digits50>(rng, 0ns);
    b.decaying = {};
    const auto begin = b.at(Digits50(0), kappa, T_h), soon = b.at(h, kappa, T_h);
    const auto late = b.at(T_h - h, kappa, T_h), later = b.at(T_h - 2 * h, kappa, T_h);
    for (std::size_t j = 0; j < 3; ++j) {
      CHECK(magnitude((soon.dS_d[j] - begin.dS_d[j]) / h - b.dj[j]) < Digits50("1e-7"));
      CHECK(magnitude((late.dS_d[j] - later.dS_d[j]) / h) < Digits50("1e-7"));
    }
    SurfaceBias<3, Digits50> one;
    one.elapsed = 0ns;
    one.dj = JointAcceleration<3, Digits50>::constant(1);
    for (const Digits50& x : {Digits50("0.001"), Digits50("0.05"), Digits50("0.09")})
      CHECK(magnitude(one.at(x, kappa, T_h).dS_d[0] - SurfaceBias<3, Digits50>::bend(x, T_h)) <
            Digits50("1e-40"));
  }
}

TEST_CASE_TEMPLATE("SurfaceBias: an interval that is known beforehand decays as any other", T,
                   SKINCTL_SCALARS) {
  Seeded rng(22);
  const auto b = some_bias<T>(rng, 200ms);
  for (const T dt : {T(0), T(0.001), T(0.002), T(0.008)}) {
    const detail::Decay<T> known(T(10), dt);
    for (const T x : {T(0.5) * dt, dt, T(2) * dt, T(0.003)}) {
      CAPTURE(dt);
      CAPTURE(x);
      CHECK(known.after(x) == T(std::exp(T(-10) * x)));
      CHECK(b.at(x, known, T(0.1)).S_d == b.at(x, T(10), T(0.1)).S_d);
      CHECK(b.advanced(x, 1ms, known).decaying == b.advanced(x, 1ms, T(10)).decaying);
    }
  }
}

TEST_CASE_TEMPLATE("SurfaceBias: begins with what is handed over and ends with none of it", T,
                   SKINCTL_SCALARS) {
  Seeded rng(21);
  auto b = some_bias<T>(rng, 0ns);
  const auto begin = b.at(T(0), T(10), T(0.1));
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(begin.S_d[j] == b.decaying[j] + b.dv[j]);
    CHECK(begin.dS_d[j] == T(-10) * b.decaying[j] + b.da[j]);
  }
  b.elapsed = 100ms;
  CHECK_FALSE(b.is_transferring(100ms));
  const auto end = b.at(T(0), T(10), T(0.1));
  for (std::size_t j = 0; j < 3; ++j) CHECK(end.S_d[j] == b.decaying[j]);
  // continuous at the end
  b.elapsed = 99999999ns;
  const auto near_end = b.at(T(0), T(10), T(0.1));
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(magnitude(T(near_end.S_d[j] - end.S_d[j])) < T(1e-6));
    CHECK(magnitude(T(near_end.dS_d[j] - end.dS_d[j])) < T(1e-5));
  }
}

TEST_CASE("SurfaceBias: steps of any length lead along the same curve") {
  Seeded rng(22);
  const auto b = some_bias<double>(rng, 0ns);
  auto fine = b;
  for (int i = 0; i < 120; ++i) fine = fine.advanced(0.001, 1ms, 10);
  const auto coarse = b.advanced(0.12, 120ms, 10);
  const auto ahead = b.at(0.12, 10, 0.1), now = fine.at(0, 10, 0.1), then = coarse.at(0, 10, 0.1);
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(now.S_d[j] == doctest::Approx(ahead.S_d[j]).epsilon(1e-13));
    CHECK(then.S_d[j] == doctest::Approx(ahead.S_d[j]).epsilon(1e-13));
  }
}

TEST_CASE_TEMPLATE("SurfaceBias: what has decayed becomes zero, not a denormal number", T, SKINCTL_SCALARS) {
  SurfaceBias<2, T> b;
  b.decaying = JointVelocity<2, T>{T(1), T(-1)};
  for (int i = 0; i < 20000; ++i) {
    b = b.advanced(T(0.001), 1ms, T(10));
    for (const T& x : b.decaying) CHECK((x == T(0) || magnitude(x) > std::numeric_limits<T>::min()));
  }
  CHECK(b.decaying == JointVelocity<2, T>{});
}
