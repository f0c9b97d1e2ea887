// Promise: a skin that no law or limit answers says so when it is touched
// Tried: laws without touch, alone and in a sum; a skin's law, one that sees its scene, a limit of contacts

#include <doctest/doctest.h>

#include <memory>

#include "skinctl/limits/contact_limits.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

struct Watches : Composable {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  Status see(Memory&, const auto&, const auto&) const noexcept { return {}; }
  template <class K>
  JointTorque<6> torque(const Memory&, const K&) const noexcept {
    return {};
  }
  Memory advance(const Memory& m, const auto&, double, Opposition) const noexcept { return m; }
};
struct Damper : StatelessLaw<Damper> {
  JointTorque<6> torque(const auto& known) const noexcept {
    return JointTorque<6>::generate([&](std::size_t i) { return -2.0 * known.dq()[i]; });
  }
};

// The statuses before and while cell 150 is pressed.
template <class Scene>
std::pair<Status, Status> touch(const Scene& scene) {
  typename Scene::Input input;
  input.measured.q = home_position();
  auto memory = std::make_unique<typename Scene::Memory>(scene.start(input.measured));
  Status before, after;
  for (int k = 0; k < 100; ++k) {
    input.now = input.measured.time += 8ms;
    const CellSample sample{.time = input.now, .cell = 150, .force = {0.5f, 0.5f, 0.5f}};
    input.samples = std::span(&sample, k < 50 ? 0 : 1);
    (k < 50 ? before : after) |= scene.step(*memory, input).status;
  }
  return {before, after};
}
auto scene_with(const auto& law) {
  return make_scene<Interface::position, 260, double>(law);
}

}  // namespace

TEST_CASE(
    "unanswered touch: a scene whose laws and limits do not read its skin says so while it is touched") {
  const auto unanswered = [](const auto& scene) {
    const auto [before, after] = touch(scene);
    CHECK_FALSE(before.has(Reason::touch_unanswered));
    CHECK(after.has(Reason::touch_unanswered));
  };
  unanswered(scene_with(GravityControl{}));
  unanswered(scene_with(Damper{} + GravityControl{}));
}

TEST_CASE("unanswered touch: not where a law, one that sees, or a limit takes it") {
  const auto answered = [](const auto& scene) {
    const auto [before, after] = touch(scene);
    CHECK_FALSE((before | after).has(Reason::touch_unanswered));
  };
  answered(scene_with(SkinJointControl{} + GravityControl{}));
  answered(scene_with(Watches{} + GravityControl{}));
  answered(scene_with(0.5 * Damper{} + 0.5 * Watches{} + GravityControl{}));
  answered(Cycle(test_robot<Interface::position, double>({}), GravityControl{}));
  const auto bare = scene_with(GravityControl{});
  answered(bare.with(
      LinkContact<3>{.region = {.force = 80, .blow = 120, .first = 100ms, .stiffness = 2e4, .mass = 4},
                     .reach = 0.45,
                     .reaction_time = 20ms}));
}
