// Skills that wait for contacts.
//
// Promise: skills wait for a contact: on a region, with a force, for a time, and for its end
// Tried: one scene, refused on a skin that finds none

#include <doctest/doctest.h>

#include <memory>
#include <string>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/pressing.hpp"
#include "tests/support/skilled_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// Waits for a grip on the elbow that lasts, then for its end.
struct Wait {
  static constexpr const char* name = "wait";
};
struct Guided {
  static constexpr const char* name = "guided";
};
struct Rest {
  static constexpr const char* name = "rest";
};
constexpr std::uint32_t elbow = 1;  // the first region
const auto library = boost::hana::make_map(
    skill<Rest>(recipe(load<controller::Gravity>(), load<controller::SplineJoint>())),
    skill<Wait>(recipe(load<controller::Gravity>())
                    .when({.finish = SkillFinish::touched,
                           .hold = 0ms,
                           .touch = {.regions = elbow, .force = 5, .lasts = 100ms}})
                    .then<Guided>()),
    skill<Guided>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>())
                      .when({.finish = SkillFinish::released, .hold = 50ms, .touch = {.regions = elbow}})
                      .then<Rest>()));
auto skills() {
  return skill_set<Rest>(library, {}, skill_controller<controller::Gravity>(GravityControl{}),
                         skill_controller<controller::SkinJoint>(SkinJointControl{}),
                         skill_controller<controller::SplineJoint>(SplineJoint<6>(skilled_settings(0.008))));
}
const RobotConfiguration<6> robot{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 6};

/// Presses on the elbow and beside it.
template <class Scene, class Set, class Places>
void waits_on(const Scene& scene, const Set& set, const Places& places) {
  const auto m = std::make_unique<typename Scene::Memory>();
  State<6> state;
  state.q = JointPosition<6>{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
  scene.start(*m, state);
  Nanoseconds now{};
  const auto run = [&](double force, double x, double seconds_long, bool ask = false) {
    const Pressing body{2, {x, 0.0, 0.0565}, {0.0, 0.0, 1.0}, 0.05, force};
    for (const Nanoseconds end = now + nanoseconds(seconds_long); now < end;) {
      now += 8ms;
      const auto samples = pushed_samples(pushes(places, std::span(&body, 1)), 10, now - 1ms);
      typename Scene::Input input;
      input.now = now, input.measured = state, input.measured.time = now, input.samples = samples;
      if (ask) input.goal = Set::template start_skill<Wait>(), ask = false;
      const auto out = scene.step(*m, input);
      state.q = out.planned.position, state.dq = out.planned.velocity;
    }
    return std::string(set.active(m->law).name);
  };
  CHECK(run(0, 0, 0.1) == "rest");
  CHECK(run(0, 0, 0.4, true) == "wait");
  CHECK(run(4, -0.12, 0.5) == "wait");  // not hard enough
  CHECK(run(0, 0, 0.1) == "wait");
  CHECK(run(20, -0.32, 0.5) == "wait");  // elsewhere
  CHECK(run(0, 0, 0.1) == "wait");
  CHECK(run(20, -0.12, 0.08) == "wait");  // not long enough
  CHECK(run(0, 0, 0.1) == "wait");
  CHECK(run(20, -0.12, 0.15) == "guided");
  CHECK(run(20, -0.12, 0.5) == "guided");  // until it is let go
  CHECK(run(0, 0, 0.3) == "rest");
}
}  // namespace

TEST_CASE("SkillSet: waits for a contact on a region, with a force and for a time, and for its end") {
  const auto plain = ur5_skin<120>(CellGains{10, 0}, {.force = EventGate<>::dead_band(0.002)});
  const auto places = plain.places();
  Region region{.name = "elbow", .cells = {}};
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].link == 2 && places[i].place.x > -0.2) region.cells.push_back(std::uint32_t(i + 1));
  const ContactSkin skin(plain, Regions{region});
  CHECK(skin.regions().mask("elbow") == elbow);
  const auto set = skills();
  const auto cycle = Cycle(by_position(ur5::Model{}, robot), skin, set);
  waits_on(cycle, set, places);
  waits_on(Configurations(cycle, cycle), set, places);
}

TEST_CASE("SkillSet: skills that wait for contacts are refused on a skin that finds none") {
  CHECK_THROWS_WITH_AS(Cycle(by_position(ur5::Model{}, robot), ur5_skin<120>(), skills()),
                       doctest::Contains("ContactSkin"), ConfigurationError);
}
