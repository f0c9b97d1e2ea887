// ur5_senses: what the arm of the main job feels by its skin, by the sensor in its wrist and by its motors,
// side by side.
//
//   ur5_senses [position | velocity]
#include <cstdio>
#include <cstring>

#include "examples/compliant_ur5/fault_runs.hpp"
#include "examples/compliant_ur5/summary.hpp"

using namespace compliant_ur5;
using skinctl::Interface;

namespace {

constexpr Sense senses[] = {Sense::skin, Sense::wrist, Sense::motors};
constexpr int tool = 257, forearm = 170;  // cells that a finger presses

std::string finger(int cell, double start) {
  return "[[touch]]\ncell = " + std::to_string(cell) + "\nstart = " + std::to_string(start) +
         "\nstiffness = 1000\ndamping = 20\ntremor = 0.02\napproach_speed = 0.06\ntravel = 0.06\nhold = "
         "0.6\n";
}
/// A force that grows by 4 N/s from the start on, whatever the arm does.
std::string growing(int cell, const std::string& file) {
  return "[[touch]]\ncell = " + std::to_string(cell) + "\nprofile = \"" + file + "\"\nimpose_force = true\n";
}
constexpr double growth = 4, lasts = 14,
                 ramp_begins = 0.5;  // [N/s], [s]: a recorded press comes for half a second

/// When a link has moved by 1 mm from where it was at the start [s]; negative: never.
double moved_at(const RunLog& log) {
  for (const LogEntry& e : log.entries) {
    RunLog first, now;
    first.entries = {log.entries.front()}, now.entries = {e};
    if (farthest_apart(first, now) > 1e-3) return e.time;
  }
  return -1;
}
double farthest(const RunLog& log) {
  RunLog still;
  still.entries.assign(log.entries.size(), log.entries.front());
  return 1e3 * farthest_apart(log, still);
}

/// Prints a row, a cell for each sense: what `cell` writes.
template <class F>
void row_of(const char* name, F&& cell) {
  std::printf("| %s |", name);
  for (const Sense sense : senses) std::printf(" %s |", cell(sense).c_str()), std::fflush(stdout);
  std::printf("\n");
}

int print_table(Interface interface) {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  read_scenario(s.scenario, s);
  const auto run = [&](Sense sense, double duration, const std::string& more, bool believed = false,
                       const std::string& faults = {}) {
    const auto r = run_with_faults(s, {.interface = interface,
                                       .faults = faults,
                                       .duration = duration,
                                       .sense = sense,
                                       .more = more,
                                       .trust_all_cells = believed});
    if (r.outcome != Outcome::fine) throw std::runtime_error(r.log.words);
    return r.log;
  };
  std::printf("| by %s | skin | wrist sensor | motors |\n|---|---|---|---|\n",
              interface == Interface::position ? "position" : "velocity");
  for (const auto& [cell, name] : {std::pair{tool, "finger on wrist 3"}, {forearm, "finger on the forearm"}})
    row_of(name, [&](Sense sense) {
      const RunLog log = run(sense, 8, finger(cell, 1));
      const double way = farthest(log);
      return way < 1 ? text("%.0f N, not noticed", log.peak_force)
                     : text("%.0f N", log.peak_force) + text(", gives way by %.0f mm", way);
    });
  const auto profile =
      std::filesystem::temp_directory_path() / ("skinctl_ramp_" + std::to_string(getpid()) + ".csv");
  std::ofstream(profile) << "0,0\n" << lasts << "," << lasts * growth << "\n";
  for (const auto& [cell, name] :
       {std::pair{tool, "least force that moves it 1 mm: wrist 3"}, {forearm, "on the forearm"}})
    row_of(name, [&](Sense sense) {
      const double t = moved_at(run(sense, lasts, growing(cell, profile.string())));
      return t < 0 ? text("above %.0f N", (lasts - ramp_begins) * growth)
                   : text("%.1f N", (t - ramp_begins) * growth);
    });
  std::filesystem::remove(profile);
  const auto biased = [&](const char* name, const std::string& more, const std::string& cells) {
    row_of(name, [&](Sense sense) {
      const std::string faults = sense == Sense::skin ? cells : std::string();
      if (sense == Sense::skin && cells.empty()) return std::string("-");
      return text("%.0f mm", farthest(run(sense, 12, more, false, faults))) +
             text(" (believed %.0f)", farthest(run(sense, 12, more, true, faults)));
    });
  };
  row_of("untouched for 10 s", [&](Sense sense) { return text("%.1f mm", farthest(run(sense, 10, ""))); });
  biased(
      "a bias of 4 N, 12 N m at the elbow, or two cells",
      "[force_sensor]\nforce_bias = [0, 0, 4]\nbias_from = 1\n[motors]\ntorque_bias = [0, 0, 12, 0, 0, 0]\n",
      "stuck:170@1=0.08,stuck:171@1=0.08");
  biased("a bias that grows by 0.5 N/s, or by 1.5 N m/s at the elbow",
         "[force_sensor]\nforce_creep = [0, 0, 0.5]\nbias_from = 1\n[motors]\ntorque_creep = [0, 0, 1.5, 0, "
         "0, 0]\n",
         "");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* by = argc > 1 ? argv[1] : "position";
  for (const auto& [name, interface] :
       {std::pair{"position", Interface::position}, {"velocity", Interface::velocity}})
    if (std::strcmp(by, name) == 0) try {
        return print_table(interface);
      } catch (const std::exception& e) {
        std::fprintf(stderr, "ur5_senses: %s\n", e.what());
        return 1;
      }
  std::fprintf(stderr, "ur5_senses: '%s' is neither position nor velocity\n", by);
  return 2;
}
