#include "skinctl/tactile/contact_skin.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/contact.hpp"
#include "skinctl/testing/pressing.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using S = Ur5Skin<260>;
using Felt = ContactSkin<S>;
static_assert(std::is_trivially_copyable_v<Felt::Memory>);

constexpr std::size_t forearm = 2;
/// With thresholds that take next to nothing.
S fine_skin() {
  return ur5_skin<260>(CellGains{10, 0}, {.force = EventGate<>::dead_band(0.002)});
}
/// A push of `force` from the side `angle` of the forearm, `along` [m] on.
Pressing push_at(double along, double angle, double force, double radius = 0.04) {
  const Xyz<double> n{0.0, std::sin(angle), std::cos(angle)};
  return {forearm, Xyz<double>{-0.2 + along, 0.0, 0.0165} + 0.04 * n, n, radius, force};
}
Status press(const Felt& skin, Felt::Memory& m, std::vector<Pressing> bodies, Nanoseconds from,
             Nanoseconds to) {
  const auto samples = pushed_samples(pushes(skin.places(), bodies), 10, to - 1ms);
  Felt::Wrenches mean;
  return skin.receive(m, samples, from, to, 1, &mean);
}

}  // namespace

TEST_CASE("ContactSkin: a skin as before, and its contacts with their identity") {
  const S plain = fine_skin();
  const Felt skin(plain);
  CHECK(skin.places().size() == 260);
  auto m = std::make_unique<Felt::Memory>(skin.start(0ns));
  auto other = std::make_unique<S::Memory>(plain.start(0ns));
  const std::vector<Pressing> two = {push_at(-0.08, 0, 12), push_at(0.08, 0.3, 8)};
  const auto samples = pushed_samples(pushes(skin.places(), two), 10, 4ms);
  Felt::Wrenches a, b;
  CHECK(skin.receive(*m, samples, 0ns, 8ms, 1, &a) == plain.receive(*other, samples, 0ns, 8ms, 1, &b));
  CHECK(a == b);
  CHECK(skin.wrenches(*m) == plain.wrenches(*other));
  REQUIRE(skin.contacts(*m).size() == 2);
  CHECK(skin.left_out(*m) == 0);
  for (const auto& c : skin.contacts(*m)) {
    CHECK(c.link == forearm);
    CHECK(c.began == 8ms);
    CHECK(c.pushed == doctest::Approx(c.place.x < -0.2 ? 12 : 8).epsilon(0.12));  // thresholds take a little
  }
  CHECK(skin.pressed(*m).size() == 2);
  // They stay while they are held, and end with the push.
  const auto id = skin.contacts(*m)[0].id;
  press(skin, *m, two, 8ms, 16ms);
  REQUIRE(skin.contacts(*m).size() == 2);
  CHECK((skin.contacts(*m)[0].id == id || skin.contacts(*m)[1].id == id));
  CHECK(skin.contacts(*m)[0].began == 8ms);
  press(skin, *m, {}, 16ms, 24ms);
  CHECK(skin.contacts(*m).empty());
  CHECK(skin.pressed(*m).size() == 0);
}

TEST_CASE("ContactSkin: an arm that is grasped around is one contact, and pushed from several sides") {
  const Felt skin(fine_skin());
  auto m = std::make_unique<Felt::Memory>(skin.start(0ns));
  std::vector<Pressing> ring;
  for (int k = 0; k < 6; ++k) ring.push_back(push_at(0, k * M_PI / 3, 10));
  press(skin, *m, ring, 0ns, 8ms);
  REQUIRE(skin.contacts(*m).size() == 1);
  const auto& c = skin.contacts(*m)[0];
  CHECK(c.pushed > 50);
  CHECK(std::sqrt(dot(c.force, c.force)) < 0.2 * c.pushed);
  CHECK(std::abs(std::sqrt(dot(c.normal, c.normal)) - 1) < 1e-5);
  // Limits see the sides, not their sum that cancels.
  double pushed = 0, most = 0;
  for (const auto& a : skin.pressed(*m)) {
    pushed += a.pushed;
    most = std::max(most, std::sqrt(dot(a.force, a.force)));
  }
  CHECK(pushed == doctest::Approx(c.pushed));
  CHECK(skin.pressed(*m).size() >= 3);
  CHECK(most > 10);
}

TEST_CASE("ContactSkin: a region has its force, and above its limit the guard hears of it") {
  const S plain = fine_skin();
  Region region{.name = "elbow", .cells = {}, .weight = 2, .force_limit = 15};
  const auto places = plain.places();
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].link == forearm && places[i].place.x > -0.2) region.cells.push_back(std::uint32_t(i + 1));
  Region all{.name = "forearm", .cells = {}};
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].link == forearm) all.cells.push_back(std::uint32_t(i + 1));
  const Felt skin(plain, Regions{region, all});
  CHECK(skin.regions().mask("forearm") == 2);
  CHECK_THROWS_AS((void)skin.regions().mask("knee"), ConfigurationError);
  auto m = std::make_unique<Felt::Memory>(skin.start(0ns));
  CHECK_FALSE(press(skin, *m, {push_at(0.08, 0, 6)}, 0ns, 8ms).has(Reason::contact_force));
  CHECK(skin.region_force(*m, 0) == doctest::Approx(2 * skin.region_force(*m, 1)));
  CHECK(skin.region_force(*m, 0) == doctest::Approx(12).epsilon(0.12));
  REQUIRE(skin.contacts(*m).size() == 1);
  CHECK(skin.contacts(*m)[0].regions == 3);
  CHECK(press(skin, *m, {push_at(0.08, 0, 10)}, 8ms, 16ms).has(Reason::contact_force));
  CHECK_FALSE(press(skin, *m, {push_at(-0.08, 0, 10)}, 16ms, 24ms).has(Reason::contact_force));
  CHECK(skin.contacts(*m)[0].regions == 2);
  CHECK_THROWS_AS((Felt(plain, Regions{{.name = "x", .cells = {261}}})), ConfigurationError);
}

TEST_CASE("ContactSkin: limits of a scene see each side of a squeezed arm, and each of two contacts on it") {
  const ContactSkin skin(ur5_skin<260>(CellGains{30, 0}, {.force = EventGate<>::dead_band(0.002)}));
  const auto scene =
      Cycle(by_position(ur5::Model{}, RobotConfiguration<6>{.limits = limits_of<ur5::Description>(15.0),
                                                            .period = 8ms,
                                                            .delay = 8ms,
                                                            .virtual_damping = 4}),
            skin, SkinJointControl{} + GravityControl{})
          .with(LinkContact<forearm>{
              .region = {.force = 60, .blow = 100, .first = 500ms, .stiffness = 5e4, .mass = 4},
              .reach = 0.45,
              .reaction_time = 20ms,
              .cells = skin.places()});
  const auto stops = [&](const std::vector<Pressing>& bodies) {
    const auto m = std::make_unique<decltype(scene)::Memory>();
    State<6> state;
    state.q = JointPosition<6>{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
    scene.start(*m, state);
    Status seen;
    for (int k = 1; k < 4; ++k) {
      decltype(scene)::Input input;
      input.now = k * Nanoseconds(8ms), input.measured = state, input.measured.time = input.now;
      const auto samples = pushed_samples(pushes(skin.places(), bodies), 30, input.now - 1ms);
      input.samples = samples;
      const auto out = scene.step(*m, input);
      seen |= out.status;
      state.q = out.planned.position, state.dq = out.planned.velocity;
    }
    return seen.has(Reason::contact_force);
  };
  CHECK_FALSE(stops({push_at(0, 0, 50)}));
  CHECK_FALSE(stops({push_at(0, 0, 50), push_at(0, M_PI, 50)}));
  CHECK(stops({push_at(0, 0, 130), push_at(0, M_PI, 130)}));    // their sum is nothing
  CHECK(stops({push_at(-0.08, 0, 65), push_at(0.08, 0, 65)}));  // of one side: they add up
  CHECK_FALSE(stops({push_at(-0.08, 0, 65), push_at(0.08, M_PI, 65)}));
}
