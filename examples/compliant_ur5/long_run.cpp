// ur5_long_run: hours' worth of cycles of a law, a driver and a simulated UR5 in lock-step: what leaks, what
// drifts, which state was missed. `ur5_long_run 8` is a working day: 3.6 million cycles at 125 Hz.
//
// Promise: a working day leaks nothing, drifts nowhere, misses nothing
// Tried: 3.6 million cycles of law, driver and simulated UR5 in lock-step: heap in use 182 kB after ten
// seconds and 191 at the end, 6.1 and 6.2 MB resident, no allocation in the loop, no state missed or
// repeated, 0.07 mrad between virtual and real arm. Also: program `ur5_long_run 8`,
// `examples/compliant_ur5/long_run`

#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"

namespace {

using namespace skinctl;
namespace job = examples::job;

/// Of the whole process, the simulated robot included.
struct Memory {
  double resident = 0;  ///< [MB]
  double in_use = 0;    ///< of the heap [kB]
};
Memory memory_now() {
  Memory m;
  long pages = 0, resident = 0;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(f, "%ld %ld", &pages, &resident) == 2)
      m.resident = 1e-6 * static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
    std::fclose(f);
  }
  m.in_use = 1e-3 * static_cast<double>(mallinfo2().uordblks);
  return m;
}

int run(int argc, char** argv) {
  double hours = 0.1;
  bool simulate = false, quiet = false;
  CLI::App app{
      "Runs a UR5 by velocity between two poses for hours of its own time, in lock-step with a simulated "
      "one, and says "
      "what leaks, drifts or is missed."};
  app.footer(job::exit_help());
  app.add_option("hours", hours, "of the robot's time")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_flag("--simulate", simulate, "a simulated UR5 (there is no other)");
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;

  simulated_ur5::Config simulated;
  simulated.ports = {0, 0, 0, 0, 0};
  simulated.controller.powered = true;
  simulated.speed = 0;
  simulated_ur5::SimulatedUr5 robot(simulated);
  robot.start();
  adapters::ur5::DriverConfig config;
  config.rtde_port = robot.ports().rtde;
  config.script_port = robot.ports().secondary;
  config.dashboard_port = robot.ports().dashboard;
  config.interface = Interface::velocity;
  config.real_time = false;
  config.silence = config.give_up = adapters::Timeout(5000);
  adapters::ur5::Driver driver(config);
  driver.connect();

  const JointLimits<6> limits = limits_of<ur5::Description>(15.0);
  const auto arm = by_velocity(
      ur5::Model{}, {.limits = limits, .period = 8ms, .delay = 8ms, .lag = 8ms, .virtual_damping = 4});
  auto tracking = tracking_settings(arm);
  tracking.lambda = 12;
  tracking.K_c = 2;
  tracking.K_i1 = tracking.K_i2 = 0;
  tracking.tb = {};
  const Cycle scene(arm, SplineJoint<6>(tracking) + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();

  const JointPosition<6> poses[2] = {{0.0, -1.2, 1.4, -1.8, -1.57, 0.3}, {0.5, -1.0, 1.2, -1.7, -1.57, 0.3}};
  constexpr std::uint64_t per_visit = 1250;  // ten seconds to a pose, and there
  const auto planned = static_cast<std::uint64_t>(hours * 3600 * 125);
  const std::uint64_t per_row = std::max<std::uint64_t>(planned / 8, 1);

  job::Progress progress(quiet, 60);
  struct {
    std::span<const CellSample> poll() noexcept { return {}; }
  } skin;
  std::uint64_t cycles = 0, jumped = 0, states = 0;
  Nanoseconds first{}, last{}, worst{};
  double first_error = -1, error = 0, first_gap = -1, gap = 0;
  Memory early{}, now{};
  std::printf(
      "| cycles | hours | resident [MB] | heap in use [kB] | beside its pose [mrad] | virtual beside real "
      "arm [mrad] | states missed |\n"
      "|---|---|---|---|---|---|---|\n");
  const auto before = [&](Scene::Input& input, Scene::Memory&) {
    if (cycles % per_visit == 0) input.goal = {poses[(cycles / per_visit) % 2], 6s};
    return true;
  };
  const auto after = [&](const Scene::Input& input, const Scene::Output&, const Stopwatch&) {
    const Nanoseconds t = input.measured.time;
    if (cycles == 0) first = last = t;
    // Each state is 8 ms after the one before: what is more was missed.
    if (t > last) {
      ++states;
      jumped += static_cast<std::uint64_t>((t - last + 4ms) / 8ms) - 1;
    }
    last = t;
    const Nanoseconds beside = t - first - static_cast<std::int64_t>(cycles) * 8ms;
    if (beside > worst || -beside > worst) worst = beside < 0ns ? -beside : beside;
    if (cycles % per_visit == per_visit - 1) {
      error = gap = 0;
      for (std::size_t i = 0; i < 6; ++i) {
        error = std::max(error, std::abs(input.measured.q[i] - poses[(cycles / per_visit) % 2][i]));
        gap = std::max(gap, std::abs(scene.resolver().state(memory->robot).q[i] - input.measured.q[i]));
      }
      if (first_error < 0) first_error = error, first_gap = gap;
    }
    ++cycles;
    if (cycles == per_visit) early = memory_now();
    if (cycles % per_row == 0) {
      now = memory_now();
      std::printf("| %llu | %.2f | %.1f | %.0f | %.3f | %.3f | %llu |\n",
                  static_cast<unsigned long long>(cycles), seconds<double>(t - first) / 3600, now.resident,
                  now.in_use, 1e3 * error, 1e3 * gap, static_cast<unsigned long long>(jumped));
      std::fflush(stdout);
    }
    if (progress.due(seconds<double>(t - first)))
      progress.show("%.2f of %.2f h", seconds<double>(t - first) / 3600, hours);
  };
  LoopOptions options;
  options.cycles = planned;
  options.period = 8ms;
  options.stop = &signals.asked();
  options.warm = 0us;
  const auto report = run_loop(scene, *memory, driver, skin, options, before, after);
  progress.clear();
  now = memory_now();

  const auto allocations = testing::unexpected_real_time_allocations();
  std::printf("\nheap in use, %.0f kB at the end, %.0f kB after ten seconds; resident %.1f and %.1f MB\n",
              now.in_use, early.in_use, now.resident, early.resident);
  std::printf("allocations in the loop: %llu\n", static_cast<unsigned long long>(allocations));
  std::printf("the robot's clock against counted cycles: %.3f ms at most\n", milliseconds(worst));
  std::printf("beside its pose: %.3f mrad at the first visit, %.3f at the last\n", 1e3 * first_error,
              1e3 * error);
  std::printf("virtual beside real arm: %.3f and %.3f mrad\n", 1e3 * first_gap, 1e3 * gap);
  std::printf("states: %llu of %llu cycles, missed %llu, repeated or late %llu, nonsense %llu\n",
              static_cast<unsigned long long>(states), static_cast<unsigned long long>(report.cycles),
              static_cast<unsigned long long>(jumped), static_cast<unsigned long long>(driver.stood()),
              static_cast<unsigned long long>(driver.nonsense()));
  if (report.ended == LoopEnd::interrupted) return job::code(job::Exit::interrupted);
  if (report.ended != LoopEnd::finished) {
    std::fprintf(stderr, "ur5_long_run: %s\n", driver.error().c_str());
    return job::code(job::Exit::lost);
  }
  const bool kept = allocations == 0 && now.in_use - early.in_use < 100 &&
                    now.resident - early.resident < 8 && jumped == 0 && driver.stood() == 0 && worst < 1ms &&
                    error < 1e-3 && gap < first_gap + 1e-3;
  std::printf("no leak, no drift, no state missed: %s\n", kept ? "yes" : "NO");
  return job::code(kept ? job::Exit::fine : job::Exit::broken);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "ur5_long_run: %s\n", e.what());
    return job::code(job::Exit::lost);
  }
}
