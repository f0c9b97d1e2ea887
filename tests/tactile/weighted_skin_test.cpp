// Promise: patches count as much as the scene says: a masked patch sees nothing, and what is pressed
// stays pressed
// Tried: force and proximity apart, ramps; in a cycle, replayed

#include "skinctl/tactile/weighted_skin.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/recording/recording.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
auto two_links() {
  return open_skin(Patch<2, 1>({cell_at<2>(1, {-0.2, 0, 0.06}, {0, 0, 1})}, open_gains),
                   Patch<5, 1>({cell_at<5>(2, {0.05, 0, 0.05}, {1, 0, 0})}, open_gains));
}
using Plain = decltype(two_links());
using Weighted = WeightedSkin<Plain>;

std::array<CellSample, 2> touched(Nanoseconds time) {
  std::array<CellSample, 2> s;
  for (std::size_t i = 0; i < 2; ++i) {
    s[i].cell = static_cast<std::uint32_t>(i + 1);
    s[i].time = time;
    for (float& f : s[i].force) f = 0.1f;
    s[i].proximity = 0.5f;
  }
  return s;
}
auto scene() {
  const RobotConfiguration<6> robot{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 6};
  return Cycle(by_position(ur5::Model{}, robot), Weighted(two_links(), 50ms),
               SkinJointControl{} + GravityControl{});
}
}  // namespace

TEST_CASE("WeightedSkin: force and proximity of each link count by their weights, within the ramp") {
  const auto plain = two_links();
  const Weighted skin(plain, 50ms);
  static_assert(Weighted::count == 2 && Weighted::slot(5) == 1);
  auto a = plain.start(0ns);
  auto b = skin.start(0ns);
  Weighted::Sensed sensed;
  sensed.patch_weights.force = {0.25f, 1};
  sensed.patch_weights.proximity = {1, 0};
  float last = 1;
  for (auto t = 8ms; t <= 80ms; t += 8ms) {
    Plain::Touch apart[2];
    Plain::Wrenches means[2];
    const auto samples = touched(t - 1ms);
    static_cast<void>(plain.receive(a, samples, t - 8ms, t, 2, apart));
    CHECK_FALSE(skin.receive(b, samples, sensed, State<6>{}, t - 8ms, t, 2, means).any());
    const float now = b.weights.force[0];
    CHECK(last - now <= 0.161f);
    const float force = last + 0.75f * (now - last),
                proximity = b.weights.proximity[1] + 0.25f * (t <= 48ms ? 0.16f : 0);
    for (std::size_t r = 0; r < 6; ++r) {
      CHECK(means[1].data[0][r] ==
            doctest::Approx(double(force) * apart[1].force.data[0][r] + apart[1].proximity.data[0][r])
                .epsilon(1e-5));
      if (t <= 48ms || t > 56ms)
        CHECK(means[1].data[1][r] ==
              doctest::Approx(apart[1].force.data[1][r] + double(proximity) * apart[1].proximity.data[1][r])
                  .epsilon(1e-5));
    }
    last = now;
  }
  CHECK(b.weights.force == std::array<float, 2>{0.25f, 1});
  CHECK(b.weights.proximity == std::array<float, 2>{1, 0});
  // What is pressed stays pressed, and what a law starts from is weighed as well.
  CHECK(skin.pressed(b).size() == plain.pressed(a).size());
  for (std::size_t r = 0; r < 6; ++r)
    CHECK(skin.wrenches(b).data[1][r] == doctest::Approx(plain.touch(a).force.data[1][r]));
}

TEST_CASE("WeightedSkin: weights beyond their range are cut off, what is no number changes nothing") {
  const Weighted skin(two_links(), 1ms);
  auto m = skin.start(0ns);
  Plain::Wrenches means[1];
  Weighted::Sensed sensed;
  sensed.patch_weights.force = {-3, 7};
  sensed.patch_weights.proximity = {0.5f, std::numeric_limits<float>::quiet_NaN()};
  CHECK(skin.receive(m, {}, sensed, State<6>{}, 0ms, 8ms, 1, means).has(Reason::sample_not_finite));
  CHECK(m.weights.force == std::array<float, 2>{0, 1});
  CHECK(m.weights.proximity == std::array<float, 2>{0.5f, 1});
  CHECK_THROWS_AS(Weighted(two_links(), 0ns), ConfigurationError);
}

TEST_CASE(
    "WeightedSkin: in a cycle, an arm does not flee from what a patch shall not see; and it is replayed") {
  const auto cycle = scene();
  using Scene = std::remove_const_t<decltype(cycle)>;
  const auto run = [&](float proximity, Recording<Scene>& recording) {
    auto memory = std::make_unique<Scene::Memory>();
    State<6> x;
    x.q = {0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
    cycle.start(*memory, x);
    recording.start(x);
    const auto from = x.q;
    for (auto t = 8ms; t <= 1600ms; t += 8ms) {
      auto samples = touched(t - 1ms);
      for (auto& s : samples)
        for (float& f : s.force) f = 0;
      if (t < 400ms) samples[0].proximity = samples[1].proximity = 0;
      Scene::Input input;
      input.now = x.time = t;
      input.measured = x;
      input.samples = samples;
      input.sensed.patch_weights.proximity = {proximity, proximity};
      const auto out = cycle.step(*memory, input);
      recording.add(input, out.planned);
      x.q = out.command.position;
      x.dq = out.planned.velocity;
    }
    double way = 0;
    for (std::size_t i = 0; i < 6; ++i) way = std::max(way, std::abs(x.q[i] - from[i]));
    return way;
  };
  Recording<Scene> recording(4 << 20);
  CHECK(run(1, recording) > 0.05);
  CHECK(run(0, recording) < 1e-9);
  CHECK(run(0.5f, recording) > 0.02);
  const auto again = replay(cycle, recording);
  CHECK((again.cycles == 200 && again.different == 0));
}
