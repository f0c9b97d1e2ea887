#include "skinctl/tracking/sign.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/control/joint_control.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/plant.hpp"

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
