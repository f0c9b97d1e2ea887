#include "skinctl/control/clearance_control.hpp"

#include <doctest/doctest.h>

#include "skinctl/model/ur5.hpp"

using namespace skinctl;

namespace {
const Clearance wall{.capsules = {{5, {{0.0, 0.0, 0.03}, {0.0, 0.0, 0.08}, 0.04}},
                                  {LinkCapsule::fixed, {{-2.0, 0.0, -0.2}, {2.0, 0.0, -0.2}, 0.1}}},
                     .pairs = {{0, 1}},
                     .margin = 0.02};
using Pushes = ClearanceControl<ur5::Model>;
}  // namespace

TEST_CASE("ClearanceControl: pushes apart what is near, along the gradient, and nothing that is far") {
  const Pushes law(ur5::Model{}, wall, {.force = 15, .range = 0.3});
  const Clearances<ur5::Model> clearances(ur5::Model{}, wall);
  int pushed = 0, none = 0;
  for (double lift = -1.6; lift < 0.6; lift += 0.02) {
    const State<6> state{.time = 0ns, .q = {0.0, lift, 1.2, -1.0, -1.57, 0.0}, .dq = {}};
    const NoTouch touch;
    const ur5::Model model{};
    const Quantities<ur5::Model, Pushes::needs> known(model, state, 0.008, touch);
    const auto tau = law.torque(known);
    double d[64], g[64][6];
    clearances.distances(state.q, d);
    clearances.gradients(state.q, g);
    double along = 0, size = 0;
    for (std::size_t i = 0; i < 6; ++i) along += tau[i] * g[0][i], size += g[0][i] * g[0][i];
    const double push = std::min(1.0, (0.3 - d[0]) / 0.28);
    CHECK(along == doctest::Approx(push > 0 ? 15 * push * size : 0));
    (push > 0 ? pushed : none) += 1;
  }
  CHECK(pushed > 10);
  CHECK(none > 10);
  CHECK_THROWS_AS(Pushes(ur5::Model{}, wall, {.force = 15, .range = 0.02}), ConfigurationError);
  CHECK_THROWS_AS(Pushes(ur5::Model{}, wall, {.force = -1, .range = 0.1}), ConfigurationError);
}
