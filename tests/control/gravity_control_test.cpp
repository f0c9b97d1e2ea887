#include "skinctl/control/gravity_control.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class L, class T>
using KnownTo = Quantities<ur5::Model, L::needs, T>;
static_assert(Law<GravityControl, KnownTo<GravityControl, double>>);
static_assert(Law<GravityCompensation<GravityInstant::start>,
                  KnownTo<GravityCompensation<GravityInstant::start>, float>>);
static_assert(GravityControl::needs == Needs{.middle = true});
static_assert(std::is_empty_v<GravityControl> && std::is_empty_v<GravityControl::Memory>);
}  // namespace

TEST_CASE_TEMPLATE("GravityControl: carries a robot at rest, at either instant", T, float, double, Digits50) {
  const ur5::Model model;
  const NoTouch none;
  Seeded rng(50);
  for (int i = 0; i < 20; ++i) {
    const State<6, T> state{0ns, rng.vector<JointPosition<6, T>>(3), {}};
    const auto expected = gravity_torque(model, state.q);
    const GravityControl law;
    CHECK(law.torque(KnownTo<GravityControl, T>(model, state, T(0.008), none)) == expected);
    const GravityCompensation<GravityInstant::start> early;
    CHECK(early.torque(KnownTo<GravityCompensation<GravityInstant::start>, T>(model, state, T(0.008),
                                                                              none)) == expected);
  }
}

TEST_CASE("GravityControl: a moving robot keeps its energy to second order, and only to first if G lags") {
  const ur5::Model model;
  const NoTouch none;
  const auto gained = [&](const auto& law, double dt) {
    using K = KnownTo<std::remove_cvref_t<decltype(law)>, double>;
    Seeded rng(51);
    double worst = 0;
    for (int i = 0; i < 10; ++i) {
      State<6> x{0ns, rng.vector<JointPosition<6>>(3), rng.vector<JointVelocity<6>>(1)};
      const auto energy = [&] {
        const auto m = mass_matrix(model, x.q);
        double e = 0;
        for (std::size_t r = 0; r < 6; ++r)
          for (std::size_t c = 0; c < 6; ++c) e += 0.5 * x.dq[r] * m(r, c) * x.dq[c];
        return e;
      };
      const double before = energy();
      for (double t = 0; t < 0.4; t += dt) x = simulate(model, x, law.torque(K(model, x, dt, none)), dt);
      worst = std::max(worst, magnitude(energy() - before) / before);
    }
    return worst;
  };
  const double coarse = gained(GravityControl{}, 0.008), fine = gained(GravityControl{}, 0.004);
  CHECK(coarse < 2e-3);
  CHECK(coarse / fine > 3);
  CHECK(gained(GravityCompensation<GravityInstant::start>{}, 0.008) > 10 * coarse);
}
