// compliant_arm_and_hand: a UR5 by velocity and an Allegro hand by torque in one process.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "examples/adapters/allegro/palm.hpp"
#include "examples/compliant_allegro/run.hpp"
#include "examples/compliant_arm_and_hand/carried.hpp"
#include "examples/compliant_arm_and_hand/pair.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "examples/support/machine_watch.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"

namespace {

using arm_and_hand::End;
using arm_and_hand::Exit;

int run(int argc, char** argv) {
  compliant_ur5::Settings arm;
  compliant_allegro::Settings hand;
  compliant_allegro::default_task(hand);
  arm.scenario = COMPLIANT_UR5_SCENARIO;
  arm.interface = skinctl::Interface::velocity;
  arm.compare = false;
  CLI::App app{
      "A UR5 by velocity with its skin, and an Allegro hand by torque, each in its own loop at its own rate. "
      "Without "
      "addresses both are simulated. When one ends badly, both stop. The arm's controller is told the hand's "
      "weight, "
      "and with --palm-gain the palm of a V5 Sense is a cell of the arm's skin: without it the arm does not "
      "move then."};
  app.footer(examples::job::exit_help());
  using adapters::allegro::Generation;
  const std::map<std::string, Generation> generations{
      {"v4", Generation::v4}, {"v5", Generation::v5}, {"v5_sense", Generation::v5_sense}};
  std::string robot;
  bool simulate = false, quiet = false;
  double duration = 10, speed = 1, palm_touch = -1, palm_gain = 0;
  app.add_flag("--simulate", simulate, "both simulated (the default)");
  app.add_option("--robot", robot, "a real UR5: its address");
  app.add_option("--can", hand.can, "a real hand: CAN interface or tty of an slcan adapter");
  app.add_option("--udp", hand.udp, "a real V5 Sense on Ethernet: its IPv4 address");
  app.add_option("--generation", hand.generation, "v4, v5 or v5_sense")
      ->transform(CLI::CheckedTransformer(generations, CLI::ignore_case));
  app.add_option(
         "--geared", hand.geared,
         "V5: gears in joints 1, 5 and 9, yes or no; not said: the smaller torque. A V5 Sense has them")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"yes", true}, {"no", false}}));
  app.add_option("--duration", duration, "[s]")->check(CLI::Range(0.1, 1e6));
  app.add_option("--rate", arm.rate, "of the arm [1/s]")->check(CLI::Range(1.0, 500.0));
  app.add_option("--speed", speed, "of simulated devices: 1 real time, 0 as fast as each goes")
      ->check(CLI::IsMember({0.0, 1.0}));
  app.add_option(
         "--palm-gain", palm_gain,
         "of the arm's law [N] per unit of each of the palm's three readings; 0: it does not count. At 5, "
         "3 N for a second move the simulated arm by 34 mm. Nobody else is the palm's witness: its force "
         "counts whole")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--palm-touch-at", palm_touch,
                 "simulated: a second's press of 3 N on the palm at this time [s]");
  app.add_option("--hand-unplugged-at", hand.faults.unplug_at,
                 "simulated: the hand's link goes at this time [s]");
  app.add_flag("--quiet", quiet, "print errors and assumptions only");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  if (simulate && !(robot.empty() && hand.can.empty() && hand.udp.empty()))
    throw skinctl::ConfigurationError("--simulate and a real device's address: one of them");
  if (!robot.empty()) arm.robot = robot;
  compliant_ur5::read_scenario(arm.scenario, arm);
  arm.speed = hand.speed = speed;
  arm.cycles = static_cast<std::uint64_t>(duration * arm.rate);
  hand.duration = duration;
  arm.quiet = hand.quiet = true;
  adapters::allegro::Palm palm;
  // As fast as each goes, their clocks say nothing to each other.
  const bool feels = hand.generation == Generation::v5_sense && palm_gain > 0 && speed == 1;
  arm.hand = arm_and_hand::carried(hand.side.value_or(skinctl::allegro::Side::right), hand.plant.start,
                                   feels ? palm_gain : 0, feels ? &palm : nullptr);
  if (feels) {
    hand.palm = &palm;
    hand.duration = duration + 10;  // a palm that falls silent stops the arm: the arm ends first
  }
  if (palm_touch >= 0)
    hand.plant.touches.push_back({.cell = 0, .start = palm_touch, .duration = 1, .force = 3});

  const examples::job::StopSignals signals;
  compliant_ur5::RunLog arm_log;
  compliant_allegro::RunLog hand_log;
  examples::MachineWatch machine;
  const auto ran = arm_and_hand::run_both(
      [&](const std::atomic<bool>& stop) {
        struct Leave {
          adapters::allegro::Palm& palm;
          ~Leave() { palm.leave(); }
        } when_it_ends{palm};
        // A hand takes its time until it speaks; an arm that starts before would call its palm silent.
        for (int ms = 0; feels && !palm.heard() && ms < 20000; ms += 5) {
          if (stop) return Exit::interrupted;
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return static_cast<Exit>(static_cast<int>(compliant_ur5::run(arm, stop, arm_log)));
      },
      [&](const std::atomic<bool>& stop) { return compliant_allegro::run(hand, stop, hand_log); },
      signals.asked());
  machine.stop();

  if (!quiet) {
    const auto say = [](const char* who, const End& end, std::size_t cycles, std::size_t touches,
                        const std::string& why) {
      std::printf("%-5s %6zu cycles, %zu touches: %s%s%s\n", who, cycles, touches,
                  end.stopped_with_other ? "stopped with the other one" : examples::job::words(end.exit),
                  why.empty() && end.words.empty() ? "" : ": ", (why.empty() ? end.words : why).c_str());
    };
    say("arm", ran.arm, arm_log.entries.size(), arm_log.touches.size(), "");
    for (const auto& touch : arm_log.touches)
      std::printf("      %s pressed at %.2f s: the arm gave way by %.1f mm\n",
                  touch.cell == compliant_ur5::palm_cell ? "palm" : "skin", touch.start,
                  1e3 * touch.deflection);
    std::printf("      carries %.2f kg, %.0f mm beyond its flange\n", arm.hand->mass,
                1e3 * arm.hand->centre[2]);
    for (const auto& fact : arm_log.result)
      std::printf("      %-40s %s\n", fact.name.c_str(), fact.value.c_str());
    say("hand", ran.hand, hand_log.entries.size(), hand_log.touches.size(), hand_log.reason);
    for (const auto& fact : hand_log.facts)
      std::printf("      %-40s %s\n", fact.name.c_str(), fact.value.c_str());
  }
  if (!quiet && speed == 1) {
    const auto us = [&](double p) {
      return 1e-3 * static_cast<double>(machine.late().percentile(p).count());
    };
    std::printf(
        "machine a thread without work, woken each millisecond: %.0f us late in the median, %.0f p99, %.0f "
        "p99.9; "
        "more than 1 ms late %llu of %llu times\n",
        us(0.5), us(0.99), us(0.999), static_cast<unsigned long long>(machine.by_a_millisecond()),
        static_cast<unsigned long long>(machine.late().count()));
  }
  return examples::job::ended("compliant_arm_and_hand", ran.exit(),
                              hand_log.reason.empty() ? "" : "the hand: " + hand_log.reason);
}

}  // namespace

int main(int argc, char** argv) {
  return examples::job::main_of("compliant_arm_and_hand", run, argc, argv);
}
