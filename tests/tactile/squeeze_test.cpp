// Promise: a soft body is told from a stiff one
// Tried: 400 against 1500 N/m, each scattering by 15 %: at most 1 % confused

#include "skinctl/tactile/squeeze.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "examples/worlds/squeezed_body.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("Squeeze: without noise the stiffness is the body's", T, float, double) {
  const Squeeze<T> squeeze;
  auto rng = seeded(1);
  for (const double k : {100.0, 400.0, 1500.0, 4000.0}) {
    typename Squeeze<T>::Memory m;
    const SqueezedBody body{
        .stiffness = k, .stiffening = 0, .force_noise = 0, .force_step = 1e-6, .closing_noise = 0};
    body.squeeze(rng, [&](double force, double x) { squeeze.take(m, T(force), T(x)); });
    const auto result = squeeze.result(m);
    REQUIRE(result.known);
    CHECK(double(result.stiffness) == doctest::Approx(k).epsilon(std::is_same_v<T, float> ? 5e-3 : 1e-4));
  }
}

TEST_CASE("Squeeze: soft is told from rigid: 400 and 1500 N/m with noise, steps and a stiffening flesh") {
  const Squeeze<> squeeze;
  auto rng = seeded(2);
  const int cases = sanitized ? 100 : 2000;
  int confused = 0, unknown = 0;
  const double border = std::sqrt(400.0 * 1500.0);
  for (int n = 0; n < cases; ++n) {
    const double k = n % 2 == 0 ? 400 : 1500;
    // Bodies of one kind scatter by 15 %, and the skin by 20 %.
    std::normal_distribution<double> normal;
    const SqueezedBody body{.stiffness = k * std::exp(0.15 * normal(rng)),
                            .finger_stiffness = 5000 * std::exp(0.2 * normal(rng)),
                            .stiffening = uniform(rng, 0.0, 0.1),
                            .closing_noise = 2e-4};
    Squeeze<>::Memory m;
    body.squeeze(rng, [&](double force, double x) { squeeze.take(m, force, x); });
    const auto result = squeeze.result(m);
    unknown += !result.known;
    confused += (result.stiffness > border) != (k > border);
  }
  MESSAGE("400 against 1500 N/m: " << 100.0 * confused / cases << " % of " << cases << " confused, "
                                   << unknown << " not told");
  CHECK(100.0 * confused / cases <= 1);
  CHECK(unknown == 0);
}

TEST_CASE("Squeeze: begins anew after a release, ignores what is not finite, tells nothing too early") {
  const Squeeze<> squeeze;
  Squeeze<>::Memory m;
  for (double f = 0; f < 1.9; f += 0.1) squeeze.take(m, f, f / 1000);
  CHECK_FALSE(squeeze.result(m).known);  // 0.5 to 1.9 N is less than 1.5 N
  for (double f = 1.9; f < 3; f += 0.1) squeeze.take(m, f, f / 1000);
  CHECK(squeeze.result(m).stiffness == doctest::Approx(1 / (1e-3 - 2e-4)));
  squeeze.take(m, NAN, 1);
  squeeze.take(m, 1, INFINITY);
  CHECK(squeeze.result(m).stiffness == doctest::Approx(1 / (1e-3 - 2e-4)));
  squeeze.take(m, 0.2, 0);
  CHECK_FALSE(squeeze.result(m).known);
  for (double f = 0; f < 3; f += 0.1) squeeze.take(m, f, f / 6000);
  CHECK(std::isinf(squeeze.result(m).stiffness));  // as stiff as the fingers themselves
  CHECK_THROWS_AS(Squeeze<>({.finger_stiffness = 0}), ConfigurationError);
  CHECK_THROWS_AS(Squeeze<>({.from = 4}), ConfigurationError);
  CHECK_THROWS_AS(Squeeze<>({.min_span = 4}), ConfigurationError);
}
