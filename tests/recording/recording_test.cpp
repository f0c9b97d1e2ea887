// Promise: a recording replays bit for bit, and one that was not begun where its scene was started says
// so
// Tried: with the program that recorded it; begun by `run_loop`, also of a robot that droops; through the
// scene or the same one compiled `Apart`. Also: `cycle/apart_test.cpp`, `hardware/loop_test.cpp`

#include "skinctl/recording/recording.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Scene = decltype(reaching_scene());

/// A run with touches, goals, a stop, a gap, and nonsense now and then.
Recording<Scene> recorded_run(const Scene& scene, std::size_t bytes = std::size_t(8) << 20) {
  Recording<Scene> recording(bytes);
  auto memory = std::make_unique<Scene::Memory>();
  oracle::Random random(5);
  StiffJoints<> robot(home_position(), 8ms, 4ms);
  scene.start(*memory, robot.state());
  recording.start(robot.state());
  std::array<CellSample, 3> samples;
  const AllocationGuard guard;
  std::uint64_t allocated = 0;
  for (int k = 1; k <= 2000; ++k) {
    if (k % 97 == 0) continue;
    Scene::Input input;
    input.now = k * 8ms;
    input.measured = robot.run_to(input.now);
    if (k % 300 == 0) input.measured.q[2] = std::numeric_limits<double>::quiet_NaN();
    for (auto& s : samples)
      s = {.time = input.now - 1ms * random.index(8),
           .cell = static_cast<std::uint32_t>(random.index(261)),
           .force = {static_cast<float>(random.uniform(0, 0.4)), 0, 0}};
    input.samples = std::span(samples).first(static_cast<std::size_t>(k % 4));
    if (k % 500 == 0) {
      input.goal = {home_position(), 0s};
      input.goal->q_g[0] += 0.2;
    }
    input.request = k == 1200 ? CycleRequest::stop : k == 1300 ? CycleRequest::resume : CycleRequest::none;
    const auto before = guard.count();
    const auto out = scene.step(*memory, input);
    recording.add(input, out.planned);
    allocated += guard.count() - before;
    robot.command(input.now, out.command.position);
  }
  CHECK(allocated == 0);
  return recording;
}

}  // namespace

TEST_CASE("recording: the start of a robot that stands beside where it was told to be is part of it") {
  const auto scene = reaching_scene();
  Recording<Scene> recording(1 << 20);
  auto memory = std::make_unique<Scene::Memory>();
  StiffJoints<> robot(home_position(), 8ms, 4ms);
  const auto drooping = [&](State<6> s) {
    s.q[1] -= 0.04;
    return s;
  };
  scene.start(*memory, drooping(robot.state()), home_position());
  recording.start(drooping(robot.state()), home_position());
  for (int k = 1; k <= 200; ++k) {
    Scene::Input input;
    input.now = k * 8ms;
    input.measured = drooping(robot.run_to(input.now));
    const auto out = scene.step(*memory, input);
    recording.add(input, out.planned);
    robot.command(input.now, out.command.position);
  }
  const auto path = (std::filesystem::temp_directory_path() / "skinctl_recording_told_test.bin").string();
  recording.save(path);
  for (const auto& copy : {recording, Recording<Scene>::load(path)}) {
    const auto again = replay(scene, copy);
    CHECK(again.cycles == 200);
    CHECK(again.different == 0);
  }
  std::filesystem::remove(path);
}

TEST_CASE("recording: a replay gives every command bit for bit, also from the file") {
  const auto scene = reaching_scene();
  const auto recording = recorded_run(scene);
  CHECK(recording.cycles() == 1980);
  CHECK_FALSE(recording.full());
  const auto again = replay(scene, recording);
  CHECK(again.cycles == 1980);
  CHECK(again.different == 0);

  const auto path = (std::filesystem::temp_directory_path() / "skinctl_recording_test.bin").string();
  recording.save(path);
  const auto loaded = Recording<Scene>::load(path);
  CHECK(loaded.bytes() == recording.bytes());
  CHECK(replay(scene, loaded).different == 0);

  SUBCASE("another configuration is noticed at the first cycle that differs") {
    SceneSettings other;
    other.force_gain = 41;
    const auto differs = replay(reaching_scene(other), recording);
    CHECK(differs.different > 0);
    CHECK(differs.first_different < differs.cycles);
    CHECK(differs.started_at == 0ms);
    CHECK(differs.first_state_at == 8ms);
    CHECK(in_words(differs).find("run_loop") == std::string::npos);
  }
  SUBCASE("damaged files are refused") {
    const auto all = recording.bytes();
    const auto refused = [&](std::uintmax_t size) {
      std::filesystem::resize_file(path, size);
      CHECK_THROWS_AS(static_cast<void>(Recording<Scene>::load(path)), ConfigurationError);
    };
    const auto whole = std::filesystem::file_size(path);
    refused(whole - 1);
    refused(whole / 2);
    refused(20);
    refused(0);
    CHECK_THROWS_AS(static_cast<void>(Recording<Scene>::load("/nowhere/at/all")), ConfigurationError);
  }
  std::filesystem::remove(path);
}

TEST_CASE("recording: a replay says how the recorded start and the first state differ") {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  State<6> first{8ms, home_position(), {}}, elsewhere{0ms, home_position(), {}};
  elsewhere.q[3] += 0.25;
  scene.start(*memory, first);
  Recording<Scene> recording(1 << 20);
  recording.start(elsewhere);
  for (int k = 2; k < 100; ++k) {
    Scene::Input input;
    input.now = k * 8ms;
    input.measured = {input.now, home_position(), {}};
    recording.add(input, scene.step(*memory, input).planned);
  }
  const auto differs = replay(scene, recording);
  CHECK(differs.different == 98);
  CHECK(differs.first_step == doctest::Approx(0.25));
  CHECK(differs.first_step_joint == 4);
  CHECK(in_words(differs) ==
        "98 commands differ, the first in cycle 0; recorded start at 0.000000 s, first state at 0.016000 s, "
        "apart by "
        "at most 0.250000 (joint 4)");
}

TEST_CASE("recording: a difference in the middle is not put down to the start") {
  Replayed r{
      .cycles = 500, .different = 99, .first_different = 101, .started_at = 8ms, .first_state_at = 8ms};
  CHECK(in_words(r).find("no start of the scene") == std::string::npos);
  r.first_different = 0;
  CHECK(in_words(r).find("no start of the scene") != std::string::npos);
  r.first_different = 101, r.started_at = 9ms;
  CHECK(in_words(r).find("no start of the scene") != std::string::npos);
}

TEST_CASE("recording: without room it stops, and says so") {
  const auto scene = reaching_scene();
  const auto recording = recorded_run(scene, 100'000);
  CHECK(recording.full());
  CHECK(recording.cycles() > 10);
  CHECK(replay(scene, recording).different == 0);
}

TEST_CASE("recording: random bytes in a file are refused or replayed, never worse") {
  const auto scene = reaching_scene();
  const auto recording = recorded_run(scene, 60'000);
  const auto path = (std::filesystem::temp_directory_path() / "skinctl_recording_fuzz.bin").string();
  oracle::Random random(6);
  for (int k = 0; k < 50; ++k) {
    recording.save(path);
    {
      std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "r+b"), &std::fclose);
      for (int n = 0; n < 20; ++n) {
        std::fseek(file.get(), 40 + random.index(59'000), SEEK_SET);
        std::fputc(random.index(256), file.get());
      }
    }
    try {
      const auto damaged = Recording<Scene>::load(path);
      CHECK(replay(scene, damaged).cycles == damaged.cycles());
    } catch (const ConfigurationError&) {
    }
  }
  std::filesystem::remove(path);
}
