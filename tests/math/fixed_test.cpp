// by night: a study
//
// Promise: fixed point gives poses, G, inverse dynamics and M where there is no floating point, with the
// error that its header states; forward dynamics do not compile
// Tried: 10 000 states of a UR5 at 3 rad/s, 10 rad/s^2, three formats; sines to 0.52 steps at any angle;
// on a Cortex-M3 a tenth of float's instructions. Also: `bare_metal/fixed.cpp`, `compile_fail/dynamics/`

#include "bench/studies/fixed_point/fixed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using math::Fixed, math::Q11_20, math::Q15_16, math::Q9_22;

static_assert(Real<Q9_22> && !Real<int> && is_fixed_point<Q9_22> && !is_fixed_point<float>);
static_assert(sizeof(Q9_22) == 4 && std::is_trivially_copyable_v<Q9_22>);
static_assert(Q15_16(1.5) * Q15_16(-2.25) == Q15_16(-3.375) && Q15_16(7) / Q15_16(2) == Q15_16(3.5));
static_assert(Q9_22(1e9) == std::numeric_limits<Q9_22>::max() &&
              Q9_22(-1e9) == std::numeric_limits<Q9_22>::lowest());
static_assert(Q9_22(1000) == std::numeric_limits<Q9_22>::max() && Q9_22(-3) == -Q9_22(3.0));
static_assert(Q9_22(1) / Q9_22(0) == std::numeric_limits<Q9_22>::max());
static_assert(sqrt(Q15_16(2.25)) == Q15_16(1.5) && sqrt(Q15_16(-1)) == Q15_16(0));

TEST_CASE_TEMPLATE("Fixed: sums are exact, products and quotients right to half a step", T, Q15_16, Q11_20,
                   Q9_22) {
  CHECK(T(std::numeric_limits<double>::quiet_NaN()) == T(0));
  testing::Seeded random(3);
  const double step = 1.0 / double(T::one);
  for (int k = 0; k < (skinctl::testing::sanitized ? 2000 : 20000); ++k) {
    const T a(10 * random()), b(10 * random());
    const double x(a), y(b);
    const double root(sqrt(abs(a))), exact = std::sqrt(std::abs(x));
    const bool good = double(a + b) == x + y && double(a - b) == x - y &&
                      std::abs(double(a * b) - x * y) <= 0.5 * step &&
                      (std::abs(y) < 0.1 || std::abs(double(a / b) - x / y) <= 0.5 * step) && root <= exact &&
                      root > exact - step;
    CAPTURE(x);
    CAPTURE(y);
    REQUIRE(good);
  }
}

TEST_CASE_TEMPLATE("Fixed: sine and cosine are right to 0.52 steps, turns away and at quarter turns", T,
                   Q15_16, Q11_20, Q9_22) {
  const double step = 1.0 / double(T::one);
  double worst = 0;
  bool same = true;
  const auto look = [&](T x) {
    T s, c;
    sin_cos(x, s, c);
    worst = std::max(
        {worst, std::abs(double(s) - std::sin(double(x))), std::abs(double(c) - std::cos(double(x)))});
    same = same && s == sin(x) && c == cos(x);
  };
  constexpr std::int64_t most = skinctl::testing::sanitized ? 20'000 : 200'000;
  for (std::int64_t k = -most; k <= most; ++k)
    look(T::of_steps(static_cast<std::int32_t>(k * 10007 % std::numeric_limits<std::int32_t>::max())));
  for (int k = -300; k <= 300; ++k)
    for (int off = -3; off <= 3; ++off) look(T(k * 1.5707963267948966) + T::of_steps(off));
  CHECK(worst <= 0.52 * step);
  CHECK(same);
}

namespace {
/// The largest errors over random poses at up to 3 rad/s and 10 rad/s^2, beside double.
template <class T>
struct Errors {
  double tool = 0, gravity = 0, torque = 0, mass = 0;
  explicit Errors(int states) {
    testing::Seeded random(11);
    const ur5::Model model;
    for (int k = 0; k < states; ++k) {
      // Of the numbers that both have.
      JointPosition<6, T> q;
      JointVelocity<6, T> dq;
      JointAcceleration<6, T> ddq;
      JointPosition<6> q_exact;
      JointVelocity<6> dq_exact;
      JointAcceleration<6> ddq_exact;
      for (std::size_t i = 0; i < 6; ++i) {
        q[i] = T(3.1 * random()), dq[i] = T(3 * random()), ddq[i] = T(10 * random());
        q_exact[i] = double(q[i]), dq_exact[i] = double(dq[i]), ddq_exact[i] = double(ddq[i]);
      }
      const auto p = Poses<ur5::Model, link_bit<5>, T>(model, q).template get<5>().origin();
      const auto x = Poses<ur5::Model, link_bit<5>>(model, q_exact).template get<5>().origin();
      const Xyz<double> way{double(p.x) - x.x, double(p.y) - x.y, double(p.z) - x.z};
      tool = std::max(tool, std::sqrt(dot(way, way)));
      const auto g = gravity_torque(model, q);
      const auto g_exact = gravity_torque(model, q_exact);
      const auto tau = inverse_dynamics(model, q, dq, ddq);
      const auto tau_exact = inverse_dynamics(model, q_exact, dq_exact, ddq_exact);
      const auto m = mass_matrix(model, q);
      const auto m_exact = mass_matrix(model, q_exact);
      for (std::size_t i = 0; i < 6; ++i) {
        gravity = std::max(gravity, std::abs(double(g[i]) - g_exact[i]));
        torque = std::max(torque, std::abs(double(tau[i]) - tau_exact[i]));
        for (std::size_t j = 0; j < 6; ++j) mass = std::max(mass, std::abs(double(m(i, j)) - m_exact(i, j)));
      }
    }
  }
};
}  // namespace

TEST_CASE("Fixed: a UR5's pose, G, inverse dynamics and M by format") {
  const auto check = [](const auto& e, const char* name, double tool, double gravity, double torque,
                        double mass) {
    MESSAGE(std::string(name) << ": tool " << 1e6 * e.tool << " um, G " << e.gravity
                              << " N m, inverse dynamics " << e.torque << " N m, M " << e.mass << " kg m^2");
    CHECK(e.tool <= tool);
    CHECK(e.gravity <= gravity);
    CHECK(e.torque <= torque);
    CHECK(e.mass <= mass);
  };
  constexpr int states = skinctl::testing::sanitized ? 1000 : 10000;
  check(Errors<Q15_16>(states), "Q15.16", 6e-5, 1.9e-3, 3.7e-3, 2.6e-4);
  check(Errors<Q11_20>(states), "Q11.20", 4e-6, 7.5e-5, 1.5e-4, 1.1e-5);
  check(Errors<Q9_22>(states), "Q9.22", 1e-6, 2.4e-5, 4.7e-5, 2.9e-6);
}
