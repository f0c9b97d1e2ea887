// ur5_skin_faults: what each fault of the skin's cells does to the arm of the main job.
//
//   ur5_skin_faults [position | velocity | torque]
#include <cstdio>
#include <cstring>

#include "examples/compliant_ur5/fault_runs.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "skinctl/sensing/cell_fault.hpp"

using namespace compliant_ur5;
using skinctl::Interface;

namespace {

constexpr std::uint32_t middle = 170;        // of the forearm
constexpr int there = 170, elsewhere = 129;  // cells that the finger presses

/// The first `count` cells of a walk from the middle one, neighbours first.
std::vector<std::uint32_t> around(const Settings& s, std::size_t count) {
  const auto cells = observed_cells(skin_patches(s));
  const auto graph = skin_graph(s, skin_patches(s));
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (cells[i].id == middle) found.push_back(i);
  for (std::size_t k = 0; k < found.size() && found.size() < count; ++k)
    for (const std::size_t n : graph.neighbours(found[k]))
      if (found.size() < count && std::find(found.begin(), found.end(), n) == found.end()) found.push_back(n);
  std::vector<std::uint32_t> ids;
  for (const std::size_t i : found) ids.push_back(cells[i].id);
  return ids;
}

int print_table(Interface interface) {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  read_scenario(s.scenario, s);
  std::printf(
      "mm: farthest that a link is from where it would be with a healthy skin; N: largest force on the "
      "finger; exit: exit code.\nThe faults begin after 0.5 s, the finger comes after 2.5 s.\n\n"
      "| fault | cells | they send | untouched mm, exit | touched elsewhere mm, N, exit | touched there mm, "
      "N, exit |\n|---|---|---|---|---|---|\n");
  for (const bool streams : {true, false}) {
    FaultRunResult healthy[3];
    const int touched[3] = {-1, elsewhere, there};
    for (int k = 0; k < 3; ++k)
      healthy[k] = run_with_faults(s, {.interface = interface, .streams = streams, .touched = touched[k]});
    std::printf("| none | - | %s | - | %.1f N | %.1f N |\n", streams ? "all" : "changes",
                healthy[1].log.peak_force, healthy[2].log.peak_force);
    for (std::size_t fault = 0; fault < skinctl::cell_faults; ++fault)
      for (const std::size_t count : {1u, 2u, 9u}) {
        const char* name = skinctl::name(static_cast<skinctl::CellFault>(fault));
        std::printf("| %s | %zu | %s |", name, count, streams ? "all" : "changes");
        for (int k = 0; k < 3; ++k) {
          const auto r = run_with_faults(s, {.interface = interface,
                                             .faults = faults_of(name, around(s, count), 0.5),
                                             .streams = streams,
                                             .touched = touched[k]});
          const double mm = 1e3 * farthest_apart(r.log, healthy[k].log);
          const int exit = static_cast<int>(r.outcome);
          if (k == 0) std::printf(" %.1f, %d |", mm, exit);
          if (k > 0) std::printf(" %.1f, %.1f, %d |", mm, r.log.peak_force, exit);
        }
        std::printf("\n");
        std::fflush(stdout);
      }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* by = argc > 1 ? argv[1] : "position";
  for (const auto& [name, interface] : {std::pair{"position", Interface::position},
                                        {"velocity", Interface::velocity},
                                        {"torque", Interface::torque}})
    if (std::strcmp(by, name) == 0) try {
        return print_table(interface);
      } catch (const std::exception& e) {
        std::fprintf(stderr, "ur5_skin_faults: %s\n", e.what());
        return 1;
      }
  std::fprintf(stderr, "ur5_skin_faults: '%s' is no interface: position, velocity, torque\n", by);
  return 2;
}
