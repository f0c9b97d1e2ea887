// One run of the hand's job: connect, hold, give way, close, open, servo off.
#pragma once

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "examples/simulated_allegro/body.hpp"
#include "examples/support/job.hpp"

namespace adapters::allegro {
class Palm;
}

namespace compliant_allegro {

using PerJoint = std::array<double, 16>;
using adapters::allegro::Gears;
using adapters::allegro::Generation;
using adapters::allegro::Side;

/// One step of the task.
struct Goal {
  double at = 0;        ///< [s] after the first cycle
  PerJoint q{};         ///< [rad]
  double duration = 2;  ///< [s]
  const char* name = "";
};

struct Settings {
  Generation generation = Generation::v5_sense;
  std::optional<Side> side;  ///< none: as a real hand says; the simulated one is a right hand
  std::string can;           ///< real: interface (can0) or tty of an slcan adapter (/dev/ttyACM0)
  std::string udp;           ///< real: address of a V5 Sense
  std::uint16_t udp_port = 7000;
  bool simulate_udp = false;   ///< the simulated hand speaks UDP
  double speed = 0;            ///< of the simulation: 0 as fast as commands come, 1 real time
  unsigned hand = 0;           ///< its number on the bus
  double full_torque = 0.7;    ///< V4: at 1200 PWM [N m]
  std::optional<bool> geared;  ///< V5: gears in joints 1, 5 and 9; none: see `adapters::allegro::gears`
  double duration = 17;        ///< [s]
  double stiffness = 0.8;      ///< of every joint [N m/rad]
  double damping = 0.02;       ///< [N m s/rad]
  double force_gain = 1.5;     ///< of the tactile cells [N] per unit of reading
  double threshold = 0.06;     ///< on the sum of a cell's three (equal) readings
  double grip_level = 0.6;     ///< reading from which a cell counts while the hand holds something
  bool quiet = false;
  std::string report, json;  ///< files; empty: none
  std::vector<Goal> task;
  /// V5 Sense: where the palm's readings go to, for an arm that carries it; the job ends when the arm's has.
  adapters::allegro::Palm* palm = nullptr;
  simulated_allegro::PlantConfig plant;
  simulated_allegro::Faults faults;
};

/// The task and the world of the default run: open, two touches, close on a ball, open.
void default_task(Settings& settings);

/// One cycle, for the plots.
struct LogEntry {
  double time = 0;
  std::array<float, 16> q{}, target{}, torque{};
  std::array<float, 16> cell{};  ///< readings, 0 to 1
  std::uint64_t status = 0;
};
struct TouchSummary {
  double start = 0, end = 0;
  std::size_t cell = 0;
  double reading = 0;       ///< largest
  double moved = 0;         ///< farthest that the touched cell went away along its normal [m]
  double after = -1;        ///< from the touch until it had moved 1 mm [s]; -1: never
  double return_error = 0;  ///< of the cell 1 s after the touch [m]
};
struct Fact {
  std::string name, value;
};
struct RunLog {
  std::string title, reason;
  std::vector<Goal> task;
  std::vector<LogEntry> entries;
  std::vector<TouchSummary> touches;
  std::vector<Fact> facts;
  std::array<double, 4> squeeze{};  ///< mean torque of each finger's flexing joints while closed [N m]
  std::array<double, 4> ball{};     ///< simulated: force of each finger on the ball while closed [N]
  double median_us = 0, p99_us = 0, max_us = 0;
  std::uint64_t cycles = 0, silent = 0, missed = 0, incomplete = 0, duplicates = 0;
  std::string status;                ///< the reasons that occurred, in words
  simulated_allegro::Snapshot last;  ///< of the simulated hand, after the end
};

/// Runs against the hand of the settings, or a simulated one in this process.
examples::job::Exit run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log);

/// A self-contained HTML page with plots.
std::string report(const RunLog& log);

}  // namespace compliant_allegro
