#include "skinctl/tracking/sign.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "skinctl/control/joint_control.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
using K = Quantities<Arm, Needs{}>;
template <class Sign>
using Control = JointControl<6, double, InertialDamping<double>, Sign>;
static_assert(Law<Control<SuperTwistingSign>, K> && Law<Control<ImplicitSign>, K>);
static_assert(sizeof(Control<SaturationSign>::Memory) == sizeof(JointControl<6>::Memory));
static_assert(std::is_trivially_copyable_v<Control<SuperTwistingSign>::Memory>);
}  // namespace

TEST_CASE_TEMPLATE("Sign: odd, within -1 and 1, growing, and no steeper than it says", Sign, TanhSign,
                   SaturationSign, ImplicitSign, SuperTwistingSign) {
  const double mu = 10, slope = Sign::slope(mu, 0.1, 0.002), z[3] = {};
  double last = -1;
  for (double S = -2; S < 2; S += 1e-3) {
    const double in[3] = {S, -S, 0};
    double out[3];
    Sign::rate(detail::Row<3, double>(in), slope, mu, z).store(out);
    CHECK(std::abs(out[0]) <= 1);
    CHECK(out[0] == doctest::Approx(-out[1]));
    CHECK(out[2] == 0);
    CHECK(out[0] >= last - 1e-15);
    if (S > -1.999) CHECK(out[0] - last <= slope * 1e-3 * (1 + 1e-9));
    last = out[0];
  }
  CHECK(last > 0.99);
}

TEST_CASE_TEMPLATE("Sign: with each of them a wrong payload is worked against, without chattering", Sign,
                   TanhSign, SaturationSign, ImplicitSign, SuperTwistingSign) {
  const double dt = 0.002;
  JointControlSettings<6> s{.dt = nanoseconds(dt), .K_i1 = 5, .K_i2 = 0.5, .tb = 0s};
  const Control<Sign> law(s);
  State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
  auto memory = law.start(K(model, x, dt, none));
  const auto home = x.q;
  double rough = 0;
  JointTorque<6> last, before;
  for (int i = 0; i < 3000; ++i) {
    const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
    memory = out.memory;
    if (i > 2500)
      for (std::size_t j = 0; j < 6; ++j)
        rough = std::max(rough, std::abs(out.torque[j] - 2 * last[j] + before[j]));
    before = last, last = out.torque;
    x = simulate(model, x, out.torque + mass_matrix(model, x.q) * JointAcceleration<6>{2, -3, 1, 4, 2, -2},
                 dt, 1);
  }
  double e = 0;
  for (std::size_t j = 0; j < 6; ++j) e = std::max(e, std::abs(x.q[j] - home[j]));
  CHECK(e < 0.004);
  CHECK(rough < 1e-3);
}

TEST_CASE("Sign: the bound of the gains counts the slope of each") {
  JointControlSettings<6> s{.dt = 8ms, .lambda = 45, .K_i2 = 1, .mu = 5, .tb = 0s};
  CHECK_NOTHROW(Control<TanhSign>{s});
  CHECK_THROWS_AS(Control<ImplicitSign>{s}, ConfigurationError);
}

// Whatever gains are accepted, at rest under a load and behind a cycle of delay: a ripple of the torque decays.
TEST_CASE("Sign: super-twisting does not ring, however steep and fast its integral is asked to be") {
  Seeded random(3);
  int accepted = 0, sharp = 0;
  for (int k = 0; k < (sanitized ? 12 : 120); ++k) {
    const double dt = k % 2 == 0 ? 0.004 : 0.008;
    JointControlSettings<6> s{.dt = nanoseconds(dt)};
    s.tb = 0s;
    s.lambda = random.between(0.05, 0.3) / dt;
    s.K_c = random.between(2, 20);
    s.K_i1 = k % 3 == 0 ? 0 : std::pow(10, random.between(-1, 1.3));
    s.K_i2 = std::pow(10, random.between(-1, 1.5));
    s.mu = std::pow(10, random.between(-0.5, 3));
    s.integral_limit = std::pow(10, random.between(-1, 1));
    try {
      static_cast<void>(Control<SuperTwistingSign>(s));
    } catch (const ConfigurationError&) {
      continue;
    }
    ++accepted;
    sharp += 300 * s.K_i2 * s.mu * s.mu * dt > s.K_i1 + 10 * s.K_i2 * s.mu;
    for (const bool delayed : {false, true}) {
      const Control<SuperTwistingSign> law(s);
      State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
      auto memory = law.start(K(model, x, dt, none));
      JointTorque<6> pending = gravity_torque(model, x.q), low, high;
      const int cycles = static_cast<int>(12 / dt), window = static_cast<int>(0.5 / dt);
      double ripple[2] = {};  // at 4 s and at 12 s
      for (int i = 0, seen = 0; i < cycles; ++i) {
        const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
        memory = out.memory;
        const auto tau = delayed ? pending : out.torque;
        pending = out.torque;
        const int to = seen == 0 ? cycles / 3 : cycles - 1;
        if (i == to - window) low = high = tau;
        for (std::size_t j = 0; i > to - window && j < 6; ++j) {
          low[j] = std::min(low[j], tau[j]);
          high[j] = std::max(high[j], tau[j]);
          ripple[seen] = std::max(ripple[seen], high[j] - low[j]);
        }
        if (i == to) ++seen;
        x = simulate(model, x, tau + mass_matrix(model, x.q) * JointAcceleration<6>{2, -3, 1, 4, 2, -2}, dt,
                     1);
      }
      CAPTURE(dt);
      CAPTURE(s.lambda);
      CAPTURE(s.K_i1);
      CAPTURE(s.K_i2);
      CAPTURE(s.mu);
      CAPTURE(delayed);
      CAPTURE(ripple[0]);
      CHECK((ripple[1] < 1e-3 || ripple[1] < 0.5 * ripple[0]));
    }
  }
  CHECK(accepted > (sanitized ? 4 : 50));
  if (!sanitized) CHECK(sharp > 15);  // too few cases there
}
