// Promise: a dry step before a state is due changes no command
// Tried: 150 cycles at 2 ms
//
// Promise: a robot's clock that stands or goes back ages its states by this computer's clock
// Tried: the command is at rest when the state is stale

#include "skinctl/hardware/loop.hpp"

#include <doctest/doctest.h>

#include "skinctl/recording/recording.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Scene = decltype(reaching_scene());

/// A robot of stiff joints whose clock runs as fast as it is asked.
struct FastRobot {
  StiffJoints<> joints{home_position(), 8ms, 4ms};
  Nanoseconds now{};
  int lost_after = 1 << 30, silent_from = 1 << 30, silent_to = 1 << 30, refuses_after = 1 << 30;
  int waits = 0, sends = 0, stops = 0;

  Heard wait(State<6>& state) noexcept {
    if (++waits > lost_after) return Heard::lost;
    now += 8ms;
    if (waits >= silent_from && waits < silent_to) return Heard::silent;
    state = joints.run_to(now);
    return Heard::state;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    joints.command(command.time, command.position);
    return ++sends <= refuses_after;
  }
  void stop() noexcept { ++stops; }
};

struct OneTouch {
  CellSample sample;
  FastRobot* robot;
  std::span<const CellSample> poll() noexcept {
    const double t = seconds<double>(robot->now);
    const auto f = static_cast<float>(t > 0.5 && t < 1 ? 0.2 : 0);
    sample = {.time = robot->now - 1ms, .cell = 60, .force = {f, f, f}};
    return {&sample, 1};
  }
};

struct Run {
  FastRobot robot;
  LoopReport<Scene> report;
};
Run run(FastRobot robot, LoopOptions options) {
  Run out;
  out.robot = robot;
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  OneTouch skin{{}, &out.robot};
  out.report = run_loop(
      scene, *memory, out.robot, skin, options, [](auto&, auto&) { return true; },
      [](const auto&, const auto&, const auto&) {});
  return out;
}

}  // namespace

static_assert(RobotDriver<FastRobot, PositionCommand<6>, 6, double>);
static_assert(SkinSource<OneTouch> && SkinSource<NoSkin>);

TEST_CASE(
    "loop: runs as many cycles as asked, times each stage, stops the robot, and keeps the worst cycle") {
  const auto done = run({}, {.cycles = 500});
  CHECK(done.report.ended == LoopEnd::finished);
  CHECK(done.report.cycles == 500);
  CHECK(done.report.samples == 500);
  CHECK(done.robot.stops == 1);
  CHECK(done.report.whole.count() == 500);
  for (const auto& stage : done.report.stages) CHECK(stage.count() == 500);
  CHECK(done.report.whole.max() > 0ns);
  // The worst cycle can be run again from what was kept.
  const auto& worst = *done.report.worst;
  CHECK(worst.cycle > 0);
  const auto scene = reaching_scene();
  const auto [out, next] = scene(worst.memory, worst.input);
  CHECK(out.command.valid);
  CHECK(out.command.time == worst.input.now);
}

TEST_CASE("loop: a robot that falls silent brakes the scene, one that comes back goes on") {
  FastRobot robot;
  robot.silent_from = 100;
  robot.silent_to = 160;
  const auto done = run(robot, {.cycles = 300});
  CHECK(done.report.silent == 60);
  CHECK(done.report.cycles == 300);
  CHECK(done.report.ended == LoopEnd::finished);
}

TEST_CASE(
    "loop: a lost robot, a command that cannot be sent, an interruption: each ends it and stops the robot") {
  FastRobot lost;
  lost.lost_after = 50;
  CHECK(run(lost, {}).report.ended == LoopEnd::lost);
  FastRobot never;
  never.lost_after = 0;
  const auto none = run(never, {});
  CHECK(none.report.ended == LoopEnd::no_state);
  CHECK(none.robot.stops == 1);
  FastRobot refuses;
  refuses.refuses_after = 20;
  const auto refused = run(refuses, {});
  CHECK(refused.report.ended == LoopEnd::lost);
  CHECK(refused.robot.stops == 1);
  const std::atomic<bool> stop = true;
  const auto interrupted = run({}, {.stop = &stop});
  CHECK(interrupted.report.ended == LoopEnd::interrupted);
  CHECK(interrupted.robot.stops == 1);
}

namespace {
/// Its clock stands, or goes back, from a cycle on; its states come at the pace of this computer's.
struct StandingRobot {
  FastRobot robot;
  int stands_from = 60;
  Nanoseconds back{}, stamp{};
  JointPosition<6> sent{}, last{};  ///< the last command, and by how much it differs from the one before
  Heard wait(State<6>& state) noexcept {
    const Heard heard = robot.wait(state);
    if (robot.waits < stands_from) {
      stamp = state.time;
    } else {
      const Nanoseconds until = Stopwatch::now() + 2ms;
      while (Stopwatch::now() < until) {
      }
      state.time = stamp - back;
    }
    return heard;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    for (std::size_t i = 0; i < 6; ++i) last[i] = command.position[i] - sent[i];
    sent = command.position;
    return robot.send(command);
  }
  void stop() noexcept { robot.stop(); }
};
}  // namespace

TEST_CASE(
    "loop: states whose clock stands or goes back grow old by this computer's clock, and the arm rests") {
  for (const Nanoseconds back : {Nanoseconds(0), Nanoseconds(40s)}) {
    StandingRobot robot;
    robot.back = back;
    const auto scene = reaching_scene();
    auto memory = std::make_unique<Scene::Memory>();
    OneTouch skin{{}, &robot.robot};
    Status last;
    double fastest = 0;
    const auto report = run_loop(
        scene, *memory, robot, skin, {.cycles = 260, .period = 2ms},
        [](auto& input, auto&) {
          if (input.now <= 24ms) input.goal = {home_position() + JointPosition<6>::constant(0.5), 2s};
          return true;
        },
        [&](const auto&, const auto& out, const auto&) {
          last = out.status;
          for (std::size_t i = 0; i < 6; ++i) fastest = std::max(fastest, std::abs(out.planned.velocity[i]));
        });
    CHECK(report.frozen_stamps > 150);
    CHECK(fastest > 0.05);
    CHECK(last.has(Reason::state_stale));
    for (std::size_t i = 0; i < 6; ++i) CHECK(robot.last[i] == 0);
  }
}

namespace {
/// Droops by `droop` at its first joint, and says where it was told to be.
struct DroopingRobot {
  FastRobot robot;
  double droop = 0.03;
  JointPosition<6> sent{};
  Heard wait(State<6>& state) noexcept {
    const Heard heard = robot.wait(state);
    state.q[0] -= droop;
    return heard;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    if (robot.sends == 0) sent = command.position;
    return robot.send(command);
  }
  void stop() noexcept { robot.stop(); }
  [[nodiscard]] JointPosition<6> told() const noexcept { return home_position(); }
};
}  // namespace

TEST_CASE("loop: a robot that droops is told to stay where it was told to be; one too far off is not moved") {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  NoSkin skin;
  const auto go = [&](DroopingRobot& robot) {
    return run_loop(
        scene, *memory, robot, skin, {.cycles = 50}, [](auto&, auto&) { return true; },
        [](const auto&, const auto& out, const auto&) { CHECK_FALSE(out.status.has(Reason::displaced)); });
  };
  DroopingRobot robot;
  CHECK(go(robot).ended == LoopEnd::finished);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(robot.sent[i] - home_position()[i]) < 1e-9);
  DroopingRobot far;
  far.droop = 0.16;
  CHECK(go(far).ended == LoopEnd::displaced);
  CHECK(far.robot.sends == 0);
  CHECK(far.robot.stops == 1);
}

namespace {
/// Its first state is `first`; then it stands at home.
struct LeapingRobot {
  FastRobot robot;
  JointPosition<6> first;
  Heard wait(State<6>& state) noexcept {
    const Heard heard = robot.wait(state);
    if (robot.waits == 1) state.q = first;
    return heard;
  }
  bool send(const PositionCommand<6>& command) noexcept { return robot.send(command); }
  void stop() noexcept { robot.stop(); }
};
}  // namespace

TEST_CASE("loop: a robot that does not stand where its first state says is not moved, and the run says so") {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  NoSkin skin;
  auto no_number = home_position();
  no_number[2] = std::nan("");
  for (const auto& first : {JointPosition<6>(), no_number, home_position()}) {
    LeapingRobot robot{{}, first};
    const auto report = run_loop(
        scene, *memory, robot, skin, {.cycles = 50}, [](auto&, auto&) { return true; },
        [](const auto&, const auto&, const auto&) {});
    const bool here = first == home_position();
    CHECK(report.ended == (here ? LoopEnd::finished : LoopEnd::displaced));
    CHECK(robot.robot.sends == (here ? 50 : 0));
    CHECK(robot.robot.stops == 1);
  }
}

namespace {
/// Numbers its packets; every second one is lost on the way from the 100th to the 150th.
struct NumberedRobot : FastRobot {
  std::uint32_t number = 0;
  Heard wait(State<6>& state) noexcept {
    number += waits >= 100 && waits < 150 ? 2 : 1;
    return FastRobot::wait(state);
  }
  [[nodiscard]] std::uint32_t packet() const noexcept { return number; }
};
static_assert(RobotDriver<NumberedRobot, PositionCommand<6>, 6, double>);
}  // namespace

TEST_CASE("loop: cycles over their budget skip optional work, then stop until there is consent") {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  FastRobot robot;
  NoSkin skin;
  LoopOptions options{.cycles = 300};
  options.budget = TimeBudget({.cycle = 1s, .skip_after = 2, .stop_after = 4, .resume_work_after = 10});
  int cycle = 0, skipped = 0, waiting = 0;
  bool stopped_at_once = false, went_on = false;
  // No test should wait: what a slow cycle would leave is handed to the next one.
  const auto report = run_loop(
      scene, *memory, robot, skin, options,
      [&](Scene::Input& input, auto&) {
        ++cycle;
        BudgetMemory slow;
        if (cycle == 54) {
          for (int k = 0; k < 4; ++k) input.observed |= options.budget->step(slow, 2s);
        }
        if (cycle == 200) input.request = CycleRequest::resume;
        return true;
      },
      [&](const auto& input, const auto& output, const auto&) {
        skipped += input.observed.has(Reason::work_skipped);
        waiting += output.status.has(Reason::consent_awaited);
        if (cycle == 54) stopped_at_once = output.status.has(Reason::consent_awaited);
        if (cycle == 201) went_on = !output.status.has(Reason::stopping);
      });
  CHECK(report.cycles == 300);
  CHECK(report.overruns == 0);
  CHECK(report.load.count() == 300);
  CHECK(skipped == 1);
  CHECK(stopped_at_once);
  CHECK(waiting == 200 - 54);
  CHECK(went_on);
}

TEST_CASE("loop: a real overrun is seen by the cycles after it") {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  FastRobot robot;
  NoSkin skin;
  LoopOptions options{.cycles = 20};
  options.budget = TimeBudget({.cycle = 1ns, .skip_after = 1, .stop_after = 3});  // nobody keeps this one
  int cycle = 0, first_skipped = 0, first_stopped = 0;
  const auto report = run_loop(
      scene, *memory, robot, skin, options, [&](auto&, auto&) { return ++cycle > 0; },
      [&](const auto& input, const auto& output, const auto&) {
        if (first_skipped == 0 && input.observed.has(Reason::work_skipped)) first_skipped = cycle;
        if (first_stopped == 0 && output.status.has(Reason::budget_overrun)) first_stopped = cycle;
      });
  CHECK(report.overruns == 20);
  CHECK(first_skipped == 2);
  CHECK(first_stopped == 4);
}

TEST_CASE("loop: packets that never came brake the scene, and it goes on by itself") {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  NumberedRobot robot;
  NoSkin skin;
  int lost = 0, awaited = 0;
  bool last = true;
  const auto report = run_loop(
      scene, *memory, robot, skin, LoopOptions{.cycles = 400}, [](auto&, auto&) { return true; },
      [&](const auto&, const auto& output, const auto&) {
        last = output.status.has(Reason::packets_lost);
        lost += last;
        awaited += output.status.has(Reason::consent_awaited);
      });
  CHECK(report.lost_packets == 50);
  CHECK(lost > 50);
  CHECK(lost < 150);
  CHECK(awaited == 0);
  CHECK_FALSE(last);
}

namespace {
/// A robot that keeps the loop waiting, by this computer's clock; keeps what it was sent.
struct PacedRobot {
  FastRobot robot;
  std::vector<JointPosition<6>> sent;
  Heard wait(State<6>& state) noexcept {
    const bool owed = robot.waits >= robot.silent_from && robot.waits < robot.silent_to;
    if (!owed) std::this_thread::sleep_for(2ms);
    return robot.wait(state);
  }
  bool send(const PositionCommand<6>& command) noexcept {
    sent.push_back(command.position);
    return robot.send(command);
  }
  void stop() noexcept { robot.stop(); }
};
std::pair<std::vector<JointPosition<6>>, std::uint64_t> paced(Nanoseconds warm, int silent = 0) {
  PacedRobot robot;
  robot.robot.silent_from = 50, robot.robot.silent_to = 50 + silent;
  robot.sent.reserve(200);
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  OneTouch skin{{}, &robot.robot};
  const auto report = run_loop(
      scene, *memory, robot, skin, {.cycles = 150, .period = 2ms, .warm = warm},
      [](auto&, auto&) { return true; }, [](const auto&, const auto&, const auto&) {});
  CHECK(report.cycles == 150);
  return {robot.sent, report.warmed_cycles};
}
}  // namespace

TEST_CASE("loop: a dry step before each state changes no command") {
  const auto [cold, none] = paced(0ns);
  const auto [warmed, most] = paced(200us);
  CHECK(none == 0);
  CHECK(most > 140);
  REQUIRE(cold.size() == warmed.size());
  for (std::size_t k = 0; k < cold.size(); ++k) CHECK(cold[k] == warmed[k]);
  CHECK_FALSE(cold.front() == cold.back());                  // it has been touched
  CHECK(run({}, {.cycles = 50}).report.warmed_cycles == 0);  // nobody waits for this robot
}

TEST_CASE("loop: before cycles that a silent robot owes it takes no time for a dry step") {
  constexpr int owed = 40;
  const auto warmed = paced(200us, owed).second;
  CHECK(warmed > 100);
  CHECK(warmed <= 150 - owed);
}

namespace {
/// Records a run with a touch, by the loop (`by_loop`), or from its first `before` on. A replay of the
/// recording.
template <class Robot>
Replayed recorded(Robot robot, FastRobot& joints, bool by_loop) {
  const auto scene = reaching_scene();
  auto memory = std::make_unique<Scene::Memory>();
  OneTouch skin{{}, &joints};
  Recording<Scene> recording, late;
  const auto report = run_loop(
      scene, *memory, robot, skin, {.cycles = 500},
      [&](auto& input, auto&) {
        if (late.bytes().empty()) late.start(input.measured);
        if (input.now > 2s && input.now < 2s + 10ms)
          input.goal = {home_position() + JointPosition<6>::constant(0.1), 0s};
        return true;
      },
      [&](const auto& input, const auto& out, const auto&) { late.add(input, out.planned); }, recording);
  CHECK(report.cycles == 500);
  CHECK(recording.cycles() == 500);
  return replay(scene, by_loop ? recording : late);
}
template <class Robot>
struct Reference {
  Robot& robot;
  Heard wait(State<6>& state) noexcept { return robot.wait(state); }
  bool send(const PositionCommand<6>& command) noexcept { return robot.send(command); }
  void stop() noexcept { robot.stop(); }
  [[nodiscard]] auto told() const noexcept
    requires requires(Robot& r) { r.told(); }
  {
    return robot.told();
  }
};
}  // namespace

TEST_CASE(
    "loop: what it records replays to the bit, also of a robot that droops; what is begun later says so") {
  FastRobot plain;
  CHECK(recorded(Reference<FastRobot>{plain}, plain, true).different == 0);
  DroopingRobot drooping;
  CHECK(recorded(Reference<DroopingRobot>{drooping}, drooping.robot, true).different == 0);

  FastRobot again;
  const auto late = recorded(Reference<FastRobot>{again}, again, false);
  CHECK(late.different > 400);
  CHECK(late.started_at == 16ms);
  CHECK(late.first_state_at == 16ms);
  const auto words = in_words(late);
  CHECK(words.find("let run_loop begin the recording") != std::string::npos);
}
