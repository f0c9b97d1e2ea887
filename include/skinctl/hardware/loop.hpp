// SPDX-License-Identifier: BSD-3-Clause
// The loop that runs a cycle with a robot and a skin, and measures its times.
#pragma once

#include <atomic>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "skinctl/cycle/cycle.hpp"
#include "skinctl/cycle/stopwatch.hpp"
#include "skinctl/guard/budget.hpp"
#include "skinctl/guard/packet_watch.hpp"
#include "skinctl/hardware/histogram.hpp"
#include "skinctl/hardware/robot.hpp"
#include "skinctl/sensing/wrench_sample.hpp"
#include "skinctl/tactile/kind_input.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The reason for which a loop ended.
enum class LoopEnd : unsigned char {
  finished,     ///< the number of cycles was reached, or the user's function ended it
  interrupted,  ///< the stop flag was set
  lost,         ///< the robot's connection is gone, or a command could not be sent
  no_state,     ///< no state arrived at the beginning
  displaced     ///< at first the robot stood too far from its commanded position, at a NaN, or elsewhere than
                ///< a state before (`start_refused`); a run that is begun again starts where it stands
};

/// The times of a run, per stage of the cycle; `whole` is all stages.
template <class C>
struct LoopReport {
  LoopEnd ended = LoopEnd::finished;
  std::uint64_t cycles = 0;
  std::uint64_t silent = 0;  ///< cycles without a new state
  std::uint64_t frozen_stamps =
      0;                     ///< cycles whose state came, but brought no later time for more than 1.5 periods
  std::uint64_t missed = 0;  ///< cycles that began more than 1.5 periods after the one before
  std::uint64_t samples = 0;        ///< number of samples from the skin
  std::uint64_t warmed_cycles = 0;  ///< cycles before which the caches were warmed
  std::array<Histogram, stage_count> stages;
  Histogram whole;
  Histogram period;  ///< times between the beginnings of cycles, by this computer's clock
  Histogram load;    ///< times from a state's arrival until its command was sent and `after` returned
  std::uint64_t overruns = 0;      ///< cycles whose load was above the budget
  std::uint64_t lost_packets = 0;  ///< number of lost packets, of a robot that numbers them

  /// The slowest cycle: its number, memory and input; `cycle(memory, input)` runs it again.
  struct Worst {
    std::uint64_t cycle = 0;
    typename C::Memory memory;
    typename C::Input input;
    std::vector<CellSample> samples;
    std::vector<WrenchSample> wrenches;
    TaxelStore<decltype(C::Input::sensed)> taxels;
  };
  std::unique_ptr<Worst> worst;
};

/// Options of a loop.
struct LoopOptions {
  std::uint64_t cycles = 0;        ///< number of cycles to run; 0: until it is stopped
  Nanoseconds period = 8ms;        ///< planned period; a state later than 1.5 periods is a miss
  std::size_t max_samples = 8192;  ///< samples of a cycle that the copy of the worst cycle keeps, at most
  std::optional<TimeBudget> budget = {};  ///< budget of the load; see `TimeBudget` for the reactions
  PacketWatch packets{};                  ///< watch for gaps in the packets of a robot that numbers them
  /// Time before a state is due at which the loop calls `Cycle::warm`; it sleeps until then. 0: it never
  /// does. Nor does it for a robot whose states come within three times this time after a cycle, or that is
  /// silent: cycles that it owes run at once.
  Nanoseconds warm = 300us;
  const std::atomic<bool>* stop = nullptr;  ///< set by a signal handler: the loop ends and stops the robot
};

/// Runs `cycle` with `robot` and `skin` until it ends. In every cycle: wait for a state, take the samples,
/// call `before(input, memory)`, which may set goals, requests and what other sensors read (`input.sensed`)
/// and ends the run by returning false, step, send, then `after(input, output, watch)`. However it ends, the
/// robot is stopped. Both functions read in `input.observed` whether to leave optional work out
/// (`work_skipped`).
///
/// `recorders` are what replays: a `Recording`, a `CycleThread`, or your own with `start(state)`,
/// `start(state, told)` for a robot that tells it, and `recorder(input, output, watch)`. The loop starts them
/// where it starts the scene, and hands them each cycle after `send`, before `after`.
///
/// All allocations (the report, the copy of the worst cycle) happen before the first cycle.
template <class C, class Robot, class Source, class Before, class After, class... Recorders>
LoopReport<C> run_loop(const C& cycle, typename C::Memory& memory, Robot& robot, Source& skin,
                       const LoopOptions& options, Before&& before, After&& after, Recorders&... recorders) {
  static_assert(RobotDriver<Robot, decltype(C::Output::command), C::joints, typename C::scalar>,
                "a robot has wait, stop, and send for the interface of the scene: see RobotDriver");
  static_assert(SkinSource<Source>, "a skin has poll: see SkinSource");
  LoopReport<C> report;
  report.worst = std::make_unique<typename LoopReport<C>::Worst>();
  report.worst->samples.reserve(options.max_samples);
  constexpr bool has_wrenches = SensesWrenches<decltype(C::Input::sensed)>;
  constexpr bool has_motors = SensesMotors<decltype(C::Input::sensed)>;
  if constexpr (has_wrenches) report.worst->wrenches.reserve(options.max_samples);
  report.worst->taxels.each(report.worst->input.sensed,
                            [&](auto&, auto& kept) { kept.reserve(options.max_samples); });
  const auto previous = std::make_unique<typename C::Memory>();

  BudgetMemory budget;
  PacketMemory packets;
  Status overrun;
  typename C::Input input;
  Heard heard = robot.wait(input.measured);
  while (heard == Heard::silent && !(options.stop && options.stop->load()))
    heard = robot.wait(input.measured);
  if (heard != Heard::state) {
    report.ended = heard == Heard::lost ? LoopEnd::no_state : LoopEnd::interrupted;
    robot.stop();
    return report;
  }
  if constexpr (TellsPosition<Robot, C>) {
    const auto told = robot.told();
    cycle.start(memory, input.measured, told);
    if (!memory.robot.started) {
      report.ended = LoopEnd::displaced;
      robot.stop();
      return report;
    }
    (recorders.start(input.measured, told), ...);
  } else {
    cycle.start(memory, input.measured);
    (recorders.start(input.measured), ...);
  }
  static_cast<void>(skin.poll());  // samples from before the start are old
  Nanoseconds heard_at = Stopwatch::now(), clock_moved_at = heard_at;

  const auto rehearsal = std::make_unique<typename C::Memory>();
  std::vector<CellSample> rehearsed;  // the last samples, as new ones
  rehearsed.reserve(options.max_samples);
  Stopwatch unseen;
  Nanoseconds pace = options.period, idle{};  // of the last cycle
  Nanoseconds done_at = heard_at;             // when the loop began to wait

  for (;;) {
    if (options.stop && options.stop->load()) {
      report.ended = LoopEnd::interrupted;
      break;
    }
    if (options.warm > 0ns && heard == Heard::state && idle > 3 * options.warm && report.cycles > 0) {
      const Nanoseconds left = heard_at + pace - options.warm - Stopwatch::now();
      if (left > 0ns) std::this_thread::sleep_for(left);
      rehearsed.assign(input.samples.begin(),
                       input.samples.begin() +
                           static_cast<std::ptrdiff_t>(std::min(input.samples.size(), options.max_samples)));
      for (CellSample& s : rehearsed) s.time += pace;
      const auto samples = std::exchange(input.samples, rehearsed);
      cycle.warm(*rehearsal, memory, input, pace, unseen);
      input.samples = samples;
      ++report.warmed_cycles;
    }
    heard = robot.wait(input.measured);
    if (heard == Heard::lost) {
      report.ended = LoopEnd::lost;
      break;
    }
    const Nanoseconds now = Stopwatch::now();
    idle = now - done_at;
    pace = std::min(options.period, now - heard_at);
    report.period.record(now - heard_at);
    if (2 * (now - heard_at) > 3 * options.period) ++report.missed;
    heard_at = now;
    if (heard == Heard::silent) {
      ++report.silent;
      input.now += options.period;  // the robot's clock goes on without a state
      clock_moved_at = now;
    } else if (report.cycles == 0 || input.measured.time > input.now) {
      input.now = input.measured.time;
      clock_moved_at = now;
    } else if (2 * (now - clock_moved_at) > 3 * options.period) {
      // Its clock stands or went back: by this computer's, so that the state grows old and the guard brakes.
      ++report.frozen_stamps;
      input.now += options.period;
      clock_moved_at += options.period;
    }
    input.samples = skin.poll();
    report.samples += input.samples.size();
    if constexpr (has_wrenches) {
      input.sensed.wrenches = {};
      if constexpr (TellsWrenches<Robot>) input.sensed.wrenches = robot.wrenches();
    }
    if constexpr (has_motors) {
      if constexpr (TellsMotorTorque<Robot, std::remove_cvref_t<decltype(input.sensed.motor_torque)>>)
        input.sensed.motor_torque = robot.motor_torque();
    }
    clear_requests(input);
    input.observed = overrun;
    if constexpr (NumbersPackets<Robot>) input.observed |= options.packets.step(packets, robot.packet());
    if (!before(input, memory)) break;

    std::memcpy(static_cast<void*>(previous.get()), &memory, sizeof memory);
    Stopwatch watch;
    const auto output = cycle.step(memory, input, watch);
    const bool sent = !output.command.valid || robot.send(output.command);
    ++report.cycles;
    for (std::size_t s = 0; s < stage_count; ++s) report.stages[s].record(watch[static_cast<CycleStage>(s)]);
    if (watch.total() > report.whole.max()) {
      auto& worst = *report.worst;
      worst.cycle = report.cycles;
      worst.memory = *previous;
      worst.input = input;
      const auto kept = std::min(input.samples.size(), options.max_samples);
      worst.samples.assign(input.samples.begin(), input.samples.begin() + static_cast<std::ptrdiff_t>(kept));
      worst.input.samples = worst.samples;
      if constexpr (has_wrenches) {
        const auto& wrenches = input.sensed.wrenches;
        const auto few = std::min(wrenches.size(), options.max_samples);
        worst.wrenches.assign(wrenches.begin(), wrenches.begin() + static_cast<std::ptrdiff_t>(few));
        worst.input.sensed.wrenches = worst.wrenches;
      }
      worst.taxels.each(worst.input.sensed, [&](auto& samples, auto& kept_taxels) {
        const auto few = std::min(samples.size(), options.max_samples);
        kept_taxels.assign(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(few));
        samples = kept_taxels;
      });
    }
    report.whole.record(watch.total());
    (recorders(input, output, watch), ...);
    after(input, output, watch);
    const Nanoseconds load = Stopwatch::now() - now;
    report.load.record(load);
    if (options.budget) overrun = options.budget->step(budget, load);
    report.overruns = budget.overruns;
    report.lost_packets = packets.lost;
    if (!sent) {
      report.ended = LoopEnd::lost;
      break;
    }
    if (output.status.has(Reason::start_refused)) {
      report.ended = LoopEnd::displaced;
      break;
    }
    if (options.cycles != 0 && report.cycles >= options.cycles) break;
    done_at = Stopwatch::now();
  }
  robot.stop();
  return report;
}

SKINCTL_END_NAMESPACE
