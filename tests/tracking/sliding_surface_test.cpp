#include "skinctl/tracking/sliding_surface.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"
#include "skinctl/tracking/joint_space.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
constexpr std::size_t n = 6;

template <class T>
struct Case {
  SurfaceInputs<n, T> in;
  JointPosition<n, T> q;
  JointVelocity<n, T> dq;
};
template <class T>
Case<T> random_case(Seeded& rng, double size) {
  Case<T> c;
  c.in.target = {rng.vector<JointPosition<n, T>>(size), rng.vector<JointVelocity<n, T>>(size),
                 rng.vector<JointAcceleration<n, T>>(size)};
  c.in.K_p = {T(rng.between(0, 30)), T(100 * rng())};
  c.in.bias = {rng.vector<JointVelocity<n, T>>(size), rng.vector<JointAcceleration<n, T>>(size)};
  for (std::size_t i = 0; i < n; ++i)
    c.in.I1[i] = T(0.4 * rng()), c.in.I2[i] = T(4 * rng()), c.in.used.I1[i] = c.in.used.I2[i] = T(rng());
  c.in.held = false;
  c.q = rng.vector<JointPosition<n, T>>(size);
  c.dq = rng.vector<JointVelocity<n, T>>(size);
  return c;
}
}  // namespace

TEST_CASE_TEMPLATE("SlidingSurface: S_q is S_delta + K_i1 I1 + K_i2 I2, computed either way", T,
                   SKINCTL_SCALARS) {
  const SurfaceGains<T> gains(JointControlSettings<n, T>{});
  Seeded rng(30);
  for (const double size : {0.0, 1e-8, 1e-3, 1.0, 30.0, 1e6})
    for (int k = 0; k < 200; ++k) {
      const auto c = random_case<T>(rng, size);
      const auto s = JointSpace<n, T>().surface(gains, c.in, {c.q, c.dq}, {});
      for (std::size_t i = 0; i < n; ++i) {
        const T sum = s.S_delta[i] + gains.K_i1 * c.in.I1[i] + gains.K_i2 * c.in.I2[i];
        const T magnitudes = magnitude(c.dq[i]) + magnitude(c.in.target.dq_d[i]) +
                             c.in.K_p.K * (magnitude(c.q[i]) + magnitude(c.in.target.q_d[i])) +
                             magnitude(c.in.bias.S_d[i]) + gains.K_i1 * magnitude(c.in.I1[i]) +
                             gains.K_i2 * magnitude(c.in.I2[i]);
        CAPTURE(size);
        CHECK(magnitude(T(s.S_q[i] - sum)) <= T(64) * epsilon<T>() * magnitudes);
      }
    }
}

TEST_CASE_TEMPLATE("SlidingSurface: is eqs. (9)-(14), against 50 digits", T, SKINCTL_SCALARS) {
  const JointControlSettings<n, T> settings{.K_i1 = T(1.5), .K_i2 = T(0.5)};
  const SurfaceGains<T> gains(settings);
  Seeded rng(31);
  for (int k = 0; k < 200; ++k) {
    const auto c = random_case<T>(rng, 2.0);
    const auto s = JointSpace<n, T>().surface(gains, c.in, {c.q, c.dq}, {});
    for (std::size_t i = 0; i < n; ++i) {
      using E = Digits50;
      const E e = E(c.q[i]) - E(c.in.target.q_d[i]), de = E(c.dq[i]) - E(c.in.target.dq_d[i]);
      const E K(c.in.K_p.K), dK(c.in.K_p.dK), S_d(c.in.bias.S_d[i]);
      const E S_delta = de + K * e - S_d;
      const E dI1 = E(s.dI1[i]), dI2 = E(s.dI2[i]);
      const E rest = E(c.in.used.I1[i]) * S_delta > 0 ? 1 - magnitude(E(c.in.used.I1[i])) : E(1);
      const E u(static_cast<double>(epsilon<T>()) * 400);
      CHECK(magnitude(E(s.S_delta[i]) - S_delta) <= u);
      CHECK(magnitude(dI1 - rest * S_delta) <= u);
      CHECK(magnitude(dI2 - rest * tanh(E(gains.mu) * S_delta)) <= u);
      const E dq_r = E(c.in.target.dq_d[i]) - K * e + S_d - E(gains.K_i1) * E(c.in.I1[i]) -
                     E(gains.K_i2) * E(c.in.I2[i]);
      CHECK(magnitude(E(s.dq_r[i]) - dq_r) <= u);
      const E ddq_r = E(c.in.target.ddq_d[i]) - K * de - dK * e + E(c.in.bias.dS_d[i]) - E(gains.K_i1) * dI1 -
                      E(gains.K_i2) * dI2;
      CHECK(magnitude(E(s.ddq_r[i]) - ddq_r) <= u * 10);
      CHECK(magnitude(E(s.S_q[i]) - (E(c.dq[i]) - dq_r)) <= u);
    }
  }
}

TEST_CASE_TEMPLATE("SlidingSurface: integrals stop at their limit, smoothly, and always find back", T,
                   SKINCTL_SCALARS) {
  const T limit(0.5);
  const auto taken = [](const T& load, const T& rate, const T& most) {
    using Two = JointVelocity<2, T>;
    using Gains = SurfaceGains<T>;
    const Two used{Gains::used(load, most), T(0)};
    const Two of_each(Gains::taken(used, detail::Row<2, T>(Two{rate, rate})));
    CHECK(of_each[1] == rate);  // the joint beside it keeps its own
    return of_each[0];
  };
  for (const T& rate : {T(0.3), T(-0.3)}) {
    const T sign = rate < T(0) ? T(-1) : T(1);
    CHECK(taken(T(0), rate, limit) == rate);
    CHECK(taken(sign * T(0.25), rate, limit) == rate);
    CHECK(taken(sign * T(0.5), rate, limit) == T(0));
    CHECK(taken(sign * T(9), rate, limit) == T(0));
    CHECK(taken(sign * T(-0.5), rate, limit) == rate);
    CHECK(magnitude(taken(sign * T(0.375), rate, limit)) == doctest::Approx(0.15));
    T last = magnitude(rate);
    for (int i = 0; i <= 1000; ++i) {
      const T part = magnitude(taken(sign * (T(0.25) + T(i) * T(0.00025)), rate, limit));
      CHECK(part <= last);
      CHECK(last - part < T(0.002));
      last = part;
    }
  }
}

TEST_CASE_TEMPLATE("SlidingSurface: while held the integrals stand still and leave ddq_r", T,
                   SKINCTL_SCALARS) {
  const SurfaceGains<T> gains(JointControlSettings<n, T>{});
  Seeded rng(32);
  auto c = random_case<T>(rng, 1.0);
  const auto runs = JointSpace<n, T>().surface(gains, c.in, {c.q, c.dq}, {});
  c.in.held = true;
  const auto held = JointSpace<n, T>().surface(gains, c.in, {c.q, c.dq}, {});
  CHECK(held.dI1 == JointVelocity<n, T>{});
  CHECK(held.dI2 == JointVelocity<n, T>{});
  CHECK(held.S_q == runs.S_q);
  for (std::size_t i = 0; i < n; ++i)
    CHECK(held.ddq_r[i] ==
          doctest::Approx(runs.ddq_r[i] + gains.K_i1 * runs.dI1[i] + gains.K_i2 * runs.dI2[i]));
}

TEST_CASE_TEMPLATE("Integrals: lose nothing in ten million small steps, and take nothing that is not finite",
                   T, SKINCTL_SCALARS) {
  Integrals<1, T> sum;
  const T step = T(1e-6), dt = T(1e-3);
  const auto add = [&](T rate) { sum = sum.advanced(JointVelocity<1, T>::constant(rate), dt); };
  add(T(1e6));  // a large sum that plain additions of 1e-9 would not change in float
  for (int i = 0; i < 10'000'000; ++i) add(step);
  const Digits50 exact = Digits50(T(1e6) * dt) + Digits50(1e7) * Digits50(T(step * dt));
  CHECK(magnitude(Digits50(sum.sum[0]) - Digits50(sum.carry[0]) - exact) <=
        Digits50(2 * static_cast<double>(epsilon<T>())) * exact);
  const auto before = sum;
  add(std::numeric_limits<T>::quiet_NaN());
  add(std::numeric_limits<T>::infinity());
  CHECK(sum.sum[0] == doctest::Approx(before.sum[0]));
}
