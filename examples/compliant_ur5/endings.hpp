// How the main job ends: one table, from which the program, its `--help` and its README take reaction, time
// and words.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "examples/adapters/ur5/fault.hpp"

namespace compliant_ur5 {

/// Ends that the job finds itself; those of the robot's connection are `adapters::ur5::Fault`.
enum class Ending : unsigned char {
  finished,
  interrupted,
  refused,
  displaced,     ///< at the start
  skin_unheard,  ///< never
  skin_silent,   ///< no longer
  skin_deaf,     ///< no cell of a patch counts, though the sender lives
  not_tared,     ///< the wrist sensor, at the start
  sense_silent,  ///< wrist sensor or motors give no numbers
  stuck,         ///< a joint that is told to move stands, and nothing touches the skin
  late,          ///< the arm follows later than declared
  distant,       ///< the network has become slower than it was at the start
  broken,
  count
};

/// As `adapters::ur5::FaultRow`.
struct EndingRow {
  Ending ending;
  const char *name, *seen, *reaction;
  int rest_ms;
  examples::job::Exit exit;
  const char *words, *way_back;
};

inline constexpr std::array<EndingRow, static_cast<std::size_t>(Ending::count)> endings{{
    {Ending::finished, "finished", "all cycles have run", "the robot is told to stop", 1000,
     examples::job::Exit::fine, "finished", "-"},
    {Ending::interrupted, "interrupted", "a signal", "the robot is told to stop", 1000,
     examples::job::Exit::interrupted, "interrupted", "start again"},
    {Ending::refused, "refused", "an option, file or number", "nothing is moved", 0,
     examples::job::Exit::refused, "a setting is wrong", "see the words"},
    {Ending::displaced, "displaced", "the first state", "nothing is moved", 0,
     examples::job::Exit::not_following, "the arm stands too far from where it was told to be",
     "let it stand free; start again"},
    {Ending::skin_unheard, "skin_unheard",
     "a patch of which no cell counts for skin_patience (2 s) from the start", "nothing has moved", 0,
     examples::job::Exit::blind, "the skin was never heard",
     "see the sender's address and port; start again"},
    {Ending::skin_silent, "skin_silent", "no datagram for 100 ms",
     "brakes (30 rad/s^2) and holds 0.5 s; then the robot is told to stop", 700, examples::job::Exit::blind,
     "the skin has fallen silent", "mend the skin; start again"},
    {Ending::skin_deaf, "skin_deaf", "no cell of a patch counts",
     "brakes (30 rad/s^2) and holds 0.5 s; then the robot is told to stop", 700, examples::job::Exit::blind,
     "the skin is blind, though its sender lives", "mend the skin; start again"},
    {Ending::not_tared, "not_tared",
     "readings of 0.5 s at rest that differ by more than half of their threshold", "nothing has moved", 0,
     examples::job::Exit::blind, "the wrist sensor cannot be tared",
     "let go of the tool; see the sensor's noise; start again"},
    {Ending::sense_silent, "sense_silent",
     "wrench or motor torques that are no numbers, or beyond what a sensor measures, for 100 ms",
     "brakes and holds 0.5 s; then the robot is told to stop", 700, examples::job::Exit::blind,
     "the sensor has fallen silent", "see the sensor's state at the panel; start again"},
    {Ending::stuck, "stuck",
     "a joint stands beside its commands for 0.3 s, untouched; by torque beside its target for 3 s, or 0.3 s "
     "under twice its friction",
     "brakes and holds 0.5 s; then the robot is told to stop", 2500, examples::job::Exit::not_following,
     "a joint does not follow its commands", "free the joint; start again"},
    {Ending::late, "late", "the measured lag exceeds the declared one by 40 ms",
     "under a touch gives way for at most 2 s more; brakes and holds 0.5 s; then the robot is told to stop",
     3500, examples::job::Exit::not_following, "the arm follows later than declared",
     "measure with identify_robot; declare [control] delay and lag"},
    {Ending::distant, "distant",
     "for 0.25 s (by torque 0.1 s) the round trip to the robot's program exceeds that of the start by "
     "delay_margin (15 ms; by torque 8 ms)",
     "under a touch gives way for at most 2 s more; brakes and holds 0.5 s; then the robot is told to stop",
     1500, examples::job::Exit::not_following, "the way to the robot and back has become longer",
     "mend the network; start again, which measures it"},
    {Ending::broken, "broken", "the limits of every command, and allocations", "the run is not believed", 0,
     examples::job::Exit::broken, "a promise was broken: see the figures above", "report it"},
}};
static_assert(
    [] {
      for (std::size_t k = 0; k < endings.size(); ++k)
        if (endings[k].ending != static_cast<Ending>(k) || endings[k].name == nullptr) return false;
      return true;
    }(),
    "endings: one row for each, in the order of the enumeration");

[[nodiscard]] constexpr const EndingRow& row(Ending ending) noexcept {
  return endings[ending < Ending::count ? static_cast<std::size_t>(ending) : 0];
}

/// Both tables in the README's form.
[[nodiscard]] inline std::string endings_as_markdown() {
  std::string out =
      "| end | seen by | reaction | at rest within | exit code | way back |\n|---|---|---|---|---|---|\n";
  const auto add = [&](const auto& r) {
    out += std::string("| ") + r.words + " | " + r.seen + " | " + r.reaction + " | " +
           (r.rest_ms > 0 ? std::to_string(r.rest_ms) + " ms" : std::string("-")) + " | " +
           std::to_string(examples::job::code(r.exit)) + " | " + r.way_back + " |\n";
  };
  for (const EndingRow& r : endings) add(r);
  for (const auto& r : adapters::ur5::faults)
    if (r.fault != adapters::ur5::Fault::none) add(r);
  return out;
}

}  // namespace compliant_ur5
