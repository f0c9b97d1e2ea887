// The main job with a faulty skin: how far its arm moves from the way of one whose skin is healthy.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "examples/compliant_ur5/run.hpp"
#include "skinctl/io/formatted.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

namespace compliant_ur5 {

/// A run at rest, in step with the simulation.
struct FaultRun {
  skinctl::Interface interface = skinctl::Interface::position;
  std::string faults{};     ///< as for `--skin-faults`; empty: a healthy skin
  bool streams = false;     ///< cells send all that they read; else changes, and keep-alives every 100 ms
  int touched = -1;         ///< cell that a finger of the scenario presses from `touched_at` on; -1: none
  double touched_at = 2.5;  ///< [s]
  double duration = 6;      ///< [s]
  Sense sense = Sense::skin;
  std::string more{};            ///< further tables of the scenario
  bool trust_all_cells = false;  ///< what sensors read is believed
};
struct FaultRunResult {
  Outcome outcome = Outcome::fine;
  RunLog log;
};

/// Runs the scenario of the settings without its touches.
inline FaultRunResult run_with_faults(Settings s, const FaultRun& r) {
  std::ostringstream text;
  text << std::ifstream(s.scenario).rdbuf();
  std::string scenario = text.str();
  scenario.resize(std::min(scenario.size(), scenario.find("[[touch]]")));
  const std::string skin = "[skin]\n";
  skinctl::require(scenario.find(skin) != std::string::npos, "FaultRun: tables [skin] of the scenario", 0,
                   "1");
  if (r.streams) scenario.insert(scenario.find(skin) + skin.size(), "force_delta = 0\n");
  if (r.touched >= 0)
    scenario +=
        "[[touch]]\ncell = " + std::to_string(r.touched) +
        "\nstart = " + skinctl::formatted("%f", r.touched_at) +
        "\nstiffness = 3000\ndamping = 20\ntremor = 0.02\napproach_speed = 0.06\ntravel = 0.06\nhold = 0.6\n";
  scenario += r.more;
  const auto file =
      std::filesystem::temp_directory_path() / ("skinctl_fault_run_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << scenario;
  s.scenario = file.string();
  s.task.clear();
  read_scenario(s.scenario, s);
  s.quiet = true;
  s.compare = false;
  s.interface = r.interface;
  s.sense = r.sense;
  s.trust_all_cells = r.trust_all_cells;
  s.rate = r.interface == skinctl::Interface::torque || r.sense != Sense::skin ? 500 : 125;
  s.cycles = static_cast<std::uint64_t>(r.duration * s.rate);
  s.skin_faults = r.faults;
  FaultRunResult out;
  out.outcome = run(s, false, out.log);
  std::filesystem::remove(file);
  return out;
}

/// The largest distance between a link of one arm and that of the other at the same time [m].
inline double farthest_apart(const RunLog& a, const RunLog& b) {
  const auto origins = [](const LogEntry& e) {
    skinctl::JointPosition<6> q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = static_cast<double>(e.q[i]);
    const auto poses = skinctl::link_poses(skinctl::ur5::Model{}, q);
    return std::array{poses.get<2>().origin(), poses.get<3>().origin(), poses.get<5>().origin()};
  };
  double most = 0;
  for (std::size_t k = 0; k < std::min(a.entries.size(), b.entries.size()); ++k) {
    const auto one = origins(a.entries[k]), other = origins(b.entries[k]);
    for (std::size_t l = 0; l < one.size(); ++l) {
      const auto way = one[l] - other[l];
      most = std::max(most, std::sqrt(dot(way, way)));
    }
  }
  return most;
}

/// The same fault of several cells, as `--skin-faults` has it.
inline std::string faults_of(const std::string& fault, const std::vector<std::uint32_t>& cells, double at) {
  std::string out;
  for (const std::uint32_t cell : cells)
    out += (out.empty() ? "" : ",") + fault + ":" + std::to_string(cell) + "@" + std::to_string(at);
  return out;
}

}  // namespace compliant_ur5
