// Scenes with cells of several kinds: each receives its own samples, a run replays bit for bit.
#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "skinctl/recording/recording.hpp"
#include "skinctl/skinctl.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/sensor_kinds.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

Transform<Link<5>, Cell> beside(double x) {
  return Transform<Link<5>, Cell>::translation_xyz(x, 0, 0.05);
}
auto fingertip() {
  return Skin<ur5::Model, double, Patch<5, 3, Uskin>>(
      Patch<5, 3, Uskin>({{1001, beside(0.04)}, {1002, beside(0.045)}, {1003, beside(0.05)}}));
}
auto eyes() {
  return Skin<ur5::Model, double, Patch<5, 2, Nearness>>(
      Patch<5, 2, Nearness>({{2001, beside(0.06)}, {2002, beside(0.07)}}, {{20}}));
}
template <class Touch>
auto scene_with(const Touch& touch) {
  return Cycle(
      by_position(
          ur5::Model{},
          {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4},
          EnergyTank{}),
      touch, SkinJointControl{} + GravityControl{});
}

}  // namespace

TEST_CASE(
    "Kinds: hexagons, taxels and eyes on one link push together, and are recorded and replayed bit for bit") {
  const auto scene = scene_with(ur5_skin<260>({.force = 20}) + ToldSkin(fingertip()) + eyes());
  using Scene = std::remove_cvref_t<decltype(scene)>;
  auto memory = std::make_unique<Scene::Memory>();
  State<6> state{0ms, home, {}};
  scene.start(*memory, state);
  Recording<Scene> recording(std::size_t(8) << 20);
  recording.start(state);
  Random rng = seeded(4);
  Status seen;
  JointPosition<6> at = home;
  for (int k = 1; k <= 1000; ++k) {
    std::vector<CellSample> hexagons;
    std::vector<SensorSample<Uskin>> taxels;
    std::vector<SensorSample<Nearness>> near;
    Scene::Input input;
    input.now = k * 8ms;
    const bool pressed = k % 100 >= 50;
    for (std::uint32_t id = 1; id <= 260; ++id)
      if (k % 20 == 0) hexagons.push_back({.time = input.now - 2ms, .cell = id});
    for (std::uint32_t id = 1001; id <= 1003; ++id)
      for (const Nanoseconds late : {5ms, 1ms})
        taxels.push_back(
            {input.now - late,
             id,
             {static_cast<float>(uniform(rng, -5.0, 5.0)), static_cast<float>(uniform(rng, -5.0, 5.0)),
              pressed ? static_cast<float>(uniform(rng, 1.0, 6.0)) : 0.0f, 25}});
    near.push_back({input.now - 1ms, 2001, {pressed ? 0.1f : 0.0f}});
    near.push_back({input.now - 1ms, 2002, {k % 77 == 0 ? 0.3f : 0.0f}});  // now and then out of its range
    input.samples = hexagons;
    taxels_of<Uskin>(input.sensed) = taxels;
    taxels_of<Nearness>(input.sensed) = near;
    state = {input.now, at, {}};
    input.measured = state;
    const auto out = scene.step(*memory, input);
    recording.add(input, out.planned);
    seen |= out.status;
    if (out.command.valid) at = out.command.position;
  }
  CHECK(seen.has(Reason::sample_out_of_range));
  CHECK_FALSE(seen.has(Reason::sample_unknown));
  double moved = 0;
  for (std::size_t i = 0; i < 6; ++i) moved += std::abs(at[i] - home[i]);
  CHECK(moved > 0.05);
  const auto again = replay(scene, recording);
  CHECK(again.cycles == 1000);
  CHECK(again.different == 0);
  // A scene with cells of another kind has other bytes, and says so by its kind.
  using Other = decltype(scene_with(ur5_skin<260>({.force = 20}) + eyes()));
  CHECK(CycleBytes<Scene>::kind() != CycleBytes<Other>::kind());
  using Plain = decltype(scene_with(ur5_skin<260>({.force = 20})));
  CHECK(CycleBytes<Plain>::kind()[1] == 0);
}

TEST_CASE("Kinds: the id of a taxel among the samples of hexagons is unknown, and an id of both is refused") {
  const auto touch = ur5_skin<260>({.force = 20}) + fingertip();
  using Touch = std::remove_cvref_t<decltype(touch)>;
  auto memory = std::make_unique<Touch::Memory>(touch.start(0ns));
  const State<6> state;
  Touch::Wrenches mean;
  const auto status = [&](std::vector<CellSample> hexagons, std::vector<SensorSample<Uskin>> taxels,
                          Nanoseconds from) {
    KindInput<Uskin> sensed;
    sensed.taxels = taxels;
    return touch.receive(*memory, hexagons, sensed, state, from, from + 8ms, 1, &mean);
  };
  CHECK_FALSE(status({{.time = 3ms, .cell = 5}}, {{3ms, 1001, {}}}, 0ms).has(Reason::sample_unknown));
  CHECK(status({{.time = 11ms, .cell = 1001}}, {}, 8ms).has(Reason::sample_unknown));
  CHECK(status({}, {{19ms, 5, {}}}, 16ms).has(Reason::sample_unknown));
  CHECK(touch.size() == 263);
  CHECK(touch.index(1002) == 261);
  using P = Patch<5, 1, Uskin>;
  const Skin<ur5::Model, double, P> twice(P({{5, beside(0.04)}}));
  CHECK_THROWS_WITH_AS(static_cast<void>(ur5_skin<260>({.force = 20}) + twice),
                       doctest::Contains("in one of both"), ConfigurationError);
}

TEST_CASE("Kinds: wrappers of a touch take taxels: contacts, weights") {
  const auto skin = ContactSkin(fingertip());
  const WeightedSkin weighted(skin);
  using Touch = std::remove_cvref_t<decltype(weighted)>;
  auto memory = std::make_unique<Touch::Memory>(weighted.start(0ns));
  const State<6> state;
  Touch::Sensed sensed;
  sensed.patch_weights.force[0] = 0.5f;
  Touch::Wrenches mean;
  for (Nanoseconds from{}; from < 400ms; from += 8ms) {
    const std::vector<SensorSample<Uskin>> taxels = {{from + 5ms, 1001, {1, 0, 4, 20}},
                                                     {from + 5ms, 1002, {1, 0, 4, 20}}};
    taxels_of<Uskin>(sensed) = taxels;
    weighted.receive(*memory, std::span<const CellSample>(), sensed, state, from, from + 8ms, 1, &mean);
  }
  REQUIRE(weighted.contacts(*memory).size() == 1);
  CHECK(weighted.contacts(*memory)[0].cells == 2);
  CHECK(weighted.contacts(*memory)[0].pushed == doctest::Approx(7.6).epsilon(1e-3));
  CHECK(mean.data[0][0] == doctest::Approx(0.5 * 2).epsilon(1e-2));
  CHECK(mean.data[0][2] == doctest::Approx(-0.5 * 7.6).epsilon(1e-2));
}
