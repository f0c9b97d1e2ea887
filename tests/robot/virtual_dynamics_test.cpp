#include "skinctl/robot/virtual_dynamics.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<VirtualDynamics<6>>);

namespace {

/// Goes 0.3 rad with joint 4 (a wrist, whose inertia is small beside the friction) in a second; the largest
/// distance of the command from the spline, and the one at the end.
std::pair<double, double> tracking_error(const SceneSettings& s, bool law_knows) {
  JointControlSettings<6> settings;
  settings.lambda = s.lambda;
  settings.K_c = s.K_c;
  settings.tb = s.tb;
  if (law_knows) settings.virtual_dynamics = shape<double>(s);
  // A resolver by hand: with a description the law that does not know would be refused.
  const Cycle scene(resolver_of(test_robot<Interface::position, double>(s)),
                    SplineJoint<6>(settings) + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(scene)>;
  auto memory = std::make_unique<Scene::Memory>();
  State<6> state;
  state.q = home_position();
  scene.start(*memory, state);
  double worst = 0, last = 0;
  for (int k = 1; k <= 300; ++k) {
    Scene::Input input;
    input.now = k * 8ms;
    input.measured = state;
    input.measured.time = input.now;
    if (k == 1) {
      input.goal = {home_position(), 1s};
      input.goal->q_g[4] += 0.3;
    }
    const auto out = scene.step(*memory, input);
    state.q = out.command.position;
    state.dq = out.planned.velocity;
    const double r = std::min(1.0, (k - 1) * 0.008);
    const double spline = home[4] + 0.3 * r * r * r * (10 - 15 * r + 6 * r * r);
    last = std::abs(state.q[4] - spline);
    worst = std::max(worst, last);
  }
  return {worst, last};
}

}  // namespace

TEST_CASE("shape: a law that knows the virtual robot's friction tracks as if there were none") {
  SceneSettings s;
  s.decay = 6;
  s.viscous = 20;
  const auto [worst, last] = tracking_error(s, true);
  CHECK(worst <= 0.02);
  CHECK(last <= 1e-3);
  CHECK(tracking_error(s, false).first >= 5 * worst);
}
