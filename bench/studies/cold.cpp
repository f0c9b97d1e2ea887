// What a cycle costs a loop that waits for its robot: `cold [seconds]`.
//
// A UR5 with 260 cells in a loop that sleeps until its next state is due, at 125, 500 and 1000 Hz: the time of a cycle
// whose code and data others have pushed out of the caches meanwhile (cold), of one with a dry step before it
// (`LoopOptions::warm`), of one right after another (hot), and of an empty loop that reads the clock as often.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/tactile/ur5_skin.hpp"
#include "skinctl/testing/robot_table.hpp"
#include "skinctl/testing/scene.hpp"

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
  bool send(const JointCommand<6>&) noexcept { return true; }
  void stop() noexcept {}
};
struct Cells {
  const Paced* robot;
  std::array<CellSample, samples_a_cycle> samples{};
  std::uint32_t first = 0;
  std::span<const CellSample> poll() noexcept {
    for (auto& s : samples) {
      first = (first + 7) % 260;
      s = {.time = robot->now - 1ms, .cell = 1 + first, .force = {0.01f, 0.02f, 0}};
    }
    return samples;
  }
};

struct Times {
  double median, p99, p999;
};
template <class Scene>
Times measure(const Scene& scene, Nanoseconds period, Nanoseconds warm, double seconds_long) {
  Paced robot;
  robot.period = period;
  Cells cells{&robot};
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

}  // namespace

int main(int argc, char** argv) {
  const double seconds_long = argc > 1 ? std::atof(argv[1]) : 20;
  table(
      "The README's scene",
      [](Nanoseconds period) {
        return Cycle(by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0),
                                                .period = period,
                                                .delay = 8ms,
                                                .virtual_damping = 4}),
                     ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
      },
      seconds_long);
  return 0;
}
