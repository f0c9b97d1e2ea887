#include "skinctl/cycle/apart.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <memory>

#include "skinctl/hardware/loop.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/apart_scene.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

static_assert(detail::StartsTold<Apart<ReachingScene>> && !detail::StartsTold<Apart<TwoGains>>);
static_assert(std::is_same_v<Apart<ReachingScene>::Memory, ReachingScene::Memory>);

/// A robot of stiff joints and its skin, on which a hand lies from 0.5 s to 1 s.
struct TouchedRobot {
  StiffJoints<> joints{home_position(), 8ms, 4ms};
  Nanoseconds now{};
  CellSample sample{};

  Heard wait(State<6>& state) noexcept {
    now += 8ms;
    state = joints.run_to(now);
    return Heard::state;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    joints.command(command.time, command.position);
    return true;
  }
  void stop() noexcept {}
  std::span<const CellSample> poll() noexcept {
    const float reading = now > 500ms && now < 1s ? 0.2f : 0.0f;
    sample = {.time = now - 1ms, .cell = 2, .force = {reading, reading, reading}};
    return {&sample, 1};
  }
};

/// A run whose goal, stop and configuration come in the same cycles for every scene of these types.
template <class C>
Recording<C> recorded_run(const C& cycle) {
  Recording<C> recording(std::size_t(1) << 20);
  TouchedRobot robot;
  auto memory = std::make_unique<typename C::Memory>();
  int k = 0;
  const auto before = [&](typename C::Input& input, auto&) {
    ++k;
    if constexpr (requires { input.configuration; }) input.configuration = k < 80 ? 0 : 1;
    if constexpr (std::is_same_v<typename C::Goal, ReachingScene::Goal>)
      if (k == 20) {
        input.goal = {home_position(), 0s};
        input.goal->q_g[0] += 0.2;
      }
    input.request = k == 200 ? CycleRequest::stop : k == 220 ? CycleRequest::resume : CycleRequest::none;
    return true;
  };
  const auto after = [](const auto&, const auto&, const auto&) {};
  const auto report =
      run_loop(cycle, *memory, robot, robot, {.cycles = 300, .warm = 0ns}, before, after, recording);
  CHECK(report.ended == LoopEnd::finished);
  CHECK(report.whole.max() > 0ns);
  double moved = 0;
  for (std::size_t i = 0; i < 6; ++i)
    moved = std::max(moved, std::abs(robot.joints.state().q[i] - home_position()[i]));
  CHECK(moved > 0.01);
  // What the report keeps of the slowest cycle runs again.
  const auto again = cycle(report.worst->memory, report.worst->input);
  CHECK(again.first.command.valid);
  return recording;
}

template <class Scene>
void same_as(const Scene& scene, const Apart<Scene>& apart) {
  const auto of_scene = recorded_run(scene);
  const auto of_apart = recorded_run(apart);
  CHECK(of_scene.cycles() == 300);
  CHECK(of_scene.bytes() == of_apart.bytes());

  // A file that either of them recorded replays through the other.
  const auto path = (std::filesystem::temp_directory_path() / "skinctl_apart_test.bin").string();
  of_scene.save(path);
  CHECK(replay(apart, Recording<Apart<Scene>>::load(path)).different == 0);
  of_apart.save(path);
  const auto back = replay(scene, Recording<Scene>::load(path));
  CHECK(back.cycles == 300);
  CHECK(back.different == 0);
  std::filesystem::remove(path);
}

}  // namespace

TEST_CASE("apart: a loop over it commands and records what it does over the scene, to the bit") {
  same_as(reaching_scene(), reaching_scene_apart());
}

TEST_CASE("apart: configurations go into it as a cycle does") {
  same_as(two_gains(), two_gains_apart());
}

TEST_CASE("apart: a start beside where the robot was told to be, a step without times and a warmed step") {
  const auto scene = reaching_scene();
  const auto apart = reaching_scene_apart();
  State<6> measured;
  measured.q = home_position();
  JointPosition<6> told = measured.q;
  told[1] += 0.03;
  auto of_scene = std::make_unique<ReachingScene::Memory>(),
       of_apart = std::make_unique<ReachingScene::Memory>(),
       scratch = std::make_unique<ReachingScene::Memory>();
  scene.start(*of_scene, measured, told);
  apart.start(*of_apart, measured, told);
  const AllocationGuard guard;
  const auto allocated = guard.count();
  int different = 0;
  for (int k = 1; k <= 100; ++k) {
    ReachingScene::Input input;
    input.now = measured.time = k * 8ms;
    input.measured = measured;
    const auto a = scene.step(*of_scene, input);
    Stopwatch watch;
    apart.warm(*scratch, *of_apart, input, 8ms, watch);
    const auto b = apart.step(*of_apart, input);
    for (std::size_t i = 0; i < 6; ++i)
      different += std::bit_cast<std::uint64_t>(a.command.position[i]) !=
                   std::bit_cast<std::uint64_t>(b.command.position[i]);
    CHECK(watch.total() > 0ns);
  }
  CHECK(different == 0);
  CHECK(guard.count() == allocated);
  CHECK(apart.start(measured).robot.command().position == scene.start(measured).robot.command().position);
  CHECK(apart.scene().skin().cells == scene.skin().cells);
}
