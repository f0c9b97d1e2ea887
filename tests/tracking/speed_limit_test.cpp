#include "skinctl/tracking/speed_limit.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("limit_speed: nothing below three quarters, never above the limit, and its own derivative",
                   T, float, double) {
  Seeded rng(1);
  const JointVelocity<4, T> limit{T(1), T(2), T(0.5), T(3)};
  for (int k = 0; k < 500; ++k) {
    const auto v = rng.vector<JointVelocity<4, T>>(k < 100 ? 0.3 : 1000.0 / (k + 1));
    const auto a = rng.vector<JointAcceleration<4, T>>(1);
    auto slow = v;
    auto change = a;
    const bool changed = limit_speed(limit, slow, change);
    detail::Row<4, T> slow_row(v), change_row(a);
    CHECK(limit_speed(limit, slow_row, change_row) == changed);
    CHECK((JointVelocity<4, T>(slow_row) == slow && JointAcceleration<4, T>(change_row) == change));
    T most(0);
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(magnitude(slow[i]) <= limit[i]);
      most = std::max(most, magnitude(T(v[i] / limit[i])));
    }
    if (most < T(0.63)) CHECK_FALSE(changed);  // 0.75 / 4^(1/8): all four at once
    if (!changed) CHECK((slow == v && change == a));
    if (sizeof(T) == 4) continue;
    const auto at = [&](const T& t) {
      auto w = integrate(v, a, t);
      auto b = a;
      limit_speed(limit, w, b);
      return w;
    };
    const T h = T(1e-6);
    const auto ahead = at(h), behind = at(-h);
    for (std::size_t i = 0; i < 4; ++i)
      CHECK(magnitude(T((ahead[i] - behind[i]) / (T(2) * h) - change[i])) < T(1e-6));
  }
}
