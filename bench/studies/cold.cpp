// What a cycle costs a loop that waits for its robot: `cold [seconds]`; `cold cycles SCENE COUNT` runs so
// many of the README's (0) or the main job's (1), for callgrind.
//
// A UR5 with 260 cells, as in the README and as in the main job, in a loop that sleeps until its next state
// is due, at 125, 500 and 1000 Hz: the time of a cycle whose code and data others have pushed out of the
// caches meanwhile (cold), of one with a dry step before it (`LoopOptions::warm`), of one right after another
// (hot), and of an empty loop that reads the clock as often.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/limits/skin_watch.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/skin_of.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t samples_a_cycle = 17;  // 6.5 % of 260 cells

/// States at its pace by this computer's clock, of an arm that stands; `period` 0: at once.
struct Paced {
  Nanoseconds period{}, next{}, now{};

  Heard wait(State<6>& state) noexcept {
    now += period.count() > 0 ? period : Nanoseconds(8ms);
    if (period.count() > 0) {
      if (next.count() == 0) next = Stopwatch::now();
      next += period;
      std::this_thread::sleep_until(std::chrono::steady_clock::time_point(next));
      if (Stopwatch::now() - next > 10 * period) next = Stopwatch::now();  // the machine was elsewhere
    }
    state = {};
    state.time = now;
    state.q = home_position();
    return Heard::state;
  }
  bool send(const PositionCommand<6>&) noexcept { return true; }
  void stop() noexcept {}
};
struct Cells {
  explicit Cells(const Paced* paced) : robot(paced) {}
  const Paced* robot;
  std::array<CellSample, samples_a_cycle> samples{};
  std::uint32_t first = 0;
  std::span<const CellSample> poll() noexcept {
    for (auto& s : samples) {
      first = (first + 7) % 260;
      s = {.time = robot->now - 1ms, .cell = 1 + first, .force = {reading(), reading(), reading()}};
    }
    return samples;
  }

 private:
  /// At rest: 0.004 and noise of 0.0003, in steps of 1/1024 / 4; a cell without noise would count as faulty.
  float reading() noexcept {
    float sum = 0;
    for (int k = 0; k < 4; ++k)
      sum += static_cast<float>((random = random * 1664525 + 1013904223) >> 8) * 0x1p-24f - 0.5f;
    return std::round((0.004f + 0.0005f * sum) * 4096) / 4096;
  }
  std::uint32_t random = 1;
};

struct Times {
  double median, p99, p999;
};
template <class Scene>
Times measure(const Scene& scene, Nanoseconds period, Nanoseconds warm, double seconds_long) {
  Paced robot;
  robot.period = period;
  Cells cells(&robot);
  auto memory = std::make_unique<typename Scene::Memory>();
  const auto cycles =
      period.count() > 0 ? static_cast<std::uint64_t>(seconds_long * 1e9 / double(period.count())) : 100000;
  const auto report = run_loop(
      scene, *memory, robot, cells,
      {.cycles = cycles, .period = period.count() > 0 ? period : Nanoseconds(8ms), .warm = warm},
      [](auto&, auto&) { return true; }, [](const auto&, const auto&, const auto&) {});
  const auto us = [&](double share) {
    return 1e-3 * static_cast<double>(report.whole.percentile(share).count());
  };
  return {us(0.5), us(0.99), us(0.999)};
}
/// An empty cycle: the clock is read as often.
Times empty(Nanoseconds period, double seconds_long) {
  Paced robot;
  robot.period = period;
  Histogram whole;
  State<6> state;
  for (auto k = static_cast<std::uint64_t>(seconds_long * 1e9 / double(period.count())); k > 0; --k) {
    robot.wait(state);
    Stopwatch watch;
    watch.begin();
    watch.end(CycleStage::sense), watch.end(CycleStage::resolve), watch.end(CycleStage::guard);
    whole.record(watch.total());
  }
  const auto us = [&](double share) { return 1e-3 * static_cast<double>(whole.percentile(share).count()); };
  return {us(0.5), us(0.99), us(0.999)};
}

template <class Make>
void table(const char* name, Make&& make, double seconds_long) {
  std::printf(
      "\n%s\n\n| rate | hot | cold | p99 | p99.9 | warmed | p99 | p99.9 | empty loop | p99.9 "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n",
      name);
  for (const Nanoseconds period : {Nanoseconds(8ms), Nanoseconds(2ms), Nanoseconds(1ms)}) {
    const auto scene = make(period);
    const Times hot = measure(scene, 0ns, 0ns, 0), cold = measure(scene, period, 0ns, seconds_long),
                warm = measure(scene, period, 300us, seconds_long), none = empty(period, seconds_long);
    std::printf("| %.0f Hz | %.2f us | %.2f | %.1f | %.1f | %.2f | %.1f | %.1f | %.2f | %.1f |\n",
                1e9 / double(period.count()), hot.median, cold.median, cold.p99, cold.p999, warm.median,
                warm.p99, warm.p999, none.median, none.p999);
    std::fflush(stdout);
  }
}

auto readme_scene(Nanoseconds period) {
  return Cycle(by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0),
                                          .period = period,
                                          .delay = 8ms,
                                          .virtual_damping = 4}),
               ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
}
/// The main job's: goals, trust in cells, damping of contacts that ring, a watch over the skin.
auto main_job_scene(Nanoseconds period) {
  std::vector<SkinPatch> patches;
  const auto add = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& patch) {
    SkinPatch& to = patches.emplace_back(SkinPatch{I, {.force = 40}, {}});
    for (const auto& cell : patch.any()) to.cells.push_back({.id = cell.id, .X_LC = cell.X_LC});
  };
  std::apply([&](const auto&... patch) { (add(patch), ...); }, ur5::skin_patches<260>());
  using UrSkin = SkinOf<ur5::Model, double, 512>;
  SkinSettings settings;
  settings.force = EventGate<>::dead_band(0.068);
  const UrSkin skin(patches, settings);
  TrustSettings trust;
  trust.lone_force = {0.0};
  trust.noise = {{.force = 0.4f, .rest = static_cast<float>(0.004 / trust.health.step)}};
  trust.health.delta = 2;
  trust.witness_share = 0.05;
  const TrustedSkin trusted(skin, trust);
  const auto arm = by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(30.0),
                                              .period = period,
                                              .delay = 8ms,
                                              .lag = 38ms,
                                              .virtual_damping = 4,
                                              .viscous_friction = JointTorque<6>::constant(1),
                                              .dead_band = JointPosition<6>::constant(0.02)});
  auto tracking = tracking_settings(arm);
  tracking.lambda = 12;
  tracking.K_c = 2;
  tracking.K_i1 = 0.2, tracking.K_i2 = 0.02;
  tracking.tb = {};
  return Cycle(arm, trusted, SplineJoint<6>(tracking) + SkinJointControl{} + GravityControl{})
      .with(SkinWatch{.unheard = SkinReaction::report,
                      .blind = SkinReaction::report,
                      .incomplete = SkinReaction::report});
}
template <class Scene>
void run_cycles(const Scene& scene, std::uint64_t cycles) {
  Paced robot;
  Cells cells(&robot);
  const auto memory = std::make_unique<typename Scene::Memory>();
  static_cast<void>(run_loop(
      scene, *memory, robot, cells, {.cycles = cycles, .warm = 0ns}, [](auto&, auto&) { return true; },
      [](const auto&, const auto&, const auto&) {}));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) {
    const auto cycles = static_cast<std::uint64_t>(std::atoll(argv[3]));
    if (argv[2][0] == '0') {
      run_cycles(readme_scene(8ms), cycles);
    } else {
      run_cycles(main_job_scene(8ms), cycles);
    }
    return 0;
  }
  const double seconds_long = argc > 1 ? std::atof(argv[1]) : 20;
  table("The README's scene", [](Nanoseconds period) { return readme_scene(period); }, seconds_long);
  table("The main job's scene", [](Nanoseconds period) { return main_job_scene(period); }, seconds_long);
  return 0;
}
