// The faults of a skin's cells against a trusted skin: torque, time to find, false masks, motion; neighbours
// that fail in one moment; hands.
//
//   skin_faults [runs of each kind, 3; 0: neighbours and hands alone]
//   skin_faults only NAME [runs, 3]: neighbours whose fault's name has this text in it
//   skin_faults hour [seconds, 3600]: touches by hands that tremble by 2 %, on healthy cells
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "bench/studies/worlds/skin_fault_run.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Neighbours of which all sensors read something else from one sample to the next.
struct Together {
  const char* name;
  std::size_t cells;
  std::function<double(double)> reads;  ///< by the time since then [s]; empty: `fault`
  double noise;                         ///< of each force sensor [steps]
  CellFault fault = CellFault::stuck;
};
auto constant(double x) {
  return [x](double) { return x; };
}
/// A loose contact: 0.6 for 0.9 s of every 2 s, with edges of 100 ms.
double loose(double t) {
  const double u = std::fmod(t, 2.0);
  return 0.02 + 0.6 * std::clamp(10 * std::min(u, 1.1 - u), 0.0, 1.0);
}
void print_neighbours(std::uint64_t seeds, const char* only = "") {
  const std::vector<Together> rows = {
      {"2 stuck at 0.9", 2, constant(0.9), 0},
      {"2 stuck at 0.9, noise", 2, constant(0.9), 0.7},
      {"1 stuck at 0.3, noise", 1, constant(0.3), 0.7},
      {"9 stuck at 0.2, noise", 9, constant(0.2), 0.7},
      {"9 stuck at 0.9, noise", 9, constant(0.9), 0.7},
      {"9 drift by 0.02 a second", 9, [](double t) { return 0.02 + std::min(0.9, 0.02 * t); }, 0.7},
      {"3 loose, edges of 100 ms", 3, loose, 0.7},
      {"3 noisy", 3, {}, 0, CellFault::noisy},
      {"2 saturated", 2, {}, 0, CellFault::saturated},
      {"2 blinking", 2, {}, 0, CellFault::blinking}};
  std::printf(
      "\nneighbours that fail in one moment: largest distance of the wrist from that of an arm with a "
      "healthy "
      "skin [mm], of %d places;\nhands are springs of 400 N/m and 25 N that tremble by 2 %%\n\n"
      "%-25s %-8s | %9s %9s %9s | %8s %8s %8s %6s\n",
      int(seeds), "fault", "", "untouched", "elsewhere", "there", "found", "median s", "last s", "false");
  for (const Together& row : rows)
    for (const bool changes : {false, true}) {
      if (std::strstr(row.name, only) == nullptr) continue;
      std::printf("%-25s %-8s |", row.name, changes ? "changes" : "streams");
      std::size_t found = 0, of = 0, masks = 0;
      SkinFaultResult all;
      for (int touch = 0; touch < 3; ++touch) {
        double motion = 0;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
          SkinFaultRun one;
          one.fault.fault = row.fault, one.reads = row.reads, one.noise = row.noise;
          one.together = row.cells, one.changes = changes, one.moves = true, one.seed = seed;
          one.touched = touch > 0, one.there = touch == 2;
          one.hand_stiffness = 400, one.hand_force = 25, one.tremor = 0.02;
          one.begins = 1500ms, one.length = one.begins + 6s;
          const SkinFaultResult r = run(one);
          motion = std::max(motion, r.motion), found += r.found, of += r.faulty, masks += r.false_masks;
          all.time_to_find.insert(all.time_to_find.end(), r.time_to_find.begin(), r.time_to_find.end());
        }
        std::printf(" %9.1f", motion);
      }
      std::sort(all.time_to_find.begin(), all.time_to_find.end());
      std::printf(" | %4zu/%3zu %8.2f %8.2f %6zu\n", found, of, all.percentile(0.5), all.percentile(1),
                  masks);
      std::fflush(stdout);
    }
}
void print_hands(std::uint64_t seeds) {
  std::printf(
      "\nthree hands, healthy cells: against an arm that believes all of them\n\n%-28s %-8s | %6s %10s | "
      "%14s %6s\n",
      "hands", "", "peak N", "believed N", "apart, way mm", "masked");
  for (const double stiffness : {150.0, 400.0, 2000.0, 8000.0})
    for (const double force : {25.0, 60.0}) {
      if (stiffness >= 2000 && force > 25)
        continue;  // such a spring without mass shakes an arm that answers late
      for (const double tremor : {0.02, 0.005})
        for (const bool changes : {false, true}) {
          SkinFaultResult all;
          for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            SkinFaultRun one;
            one.fault.fault = CellFault::unheard, one.there = false;
            one.begins = 5s, one.length = 4s, one.moves = true, one.seed = seed, one.changes = changes;
            one.hand_stiffness = stiffness, one.hand_force = force, one.tremor = tremor;
            one.believes_all = true;
            const SkinFaultResult r = run(one);
            all.peak = std::max(all.peak, r.peak),
            all.healthy_peak = std::max(all.healthy_peak, r.healthy_peak);
            all.motion = std::max(all.motion, r.motion), all.way = std::max(all.way, r.way);
            all.false_masks += r.false_masks;
          }
          std::printf("%5.0f N/m, %2.0f N, tremor %.1f %% %-8s | %6.1f %10.1f | %6.1f %7.1f %6zu\n",
                      stiffness, force, 100 * tremor, changes ? "changes" : "streams", all.peak,
                      all.healthy_peak, all.motion, all.way, all.false_masks);
          std::fflush(stdout);
        }
    }
}

/// Hands of any stiffness from 150 to 8000 N/m, three at a time, for 2 to 20 s.
int print_hour(double seconds) {
  double passed = 0, farthest = 0, ratio = 0;
  std::size_t hands = 0, masks = 0, masked_runs = 0;
  for (std::uint64_t seed = 1; passed < seconds; ++seed) {
    Normal normal(seed + 1000);
    SkinFaultRun one;
    const double length = 2 * std::pow(10, normal.between(0.0, 1.0));
    one.length = nanoseconds(length), one.begins = one.length + 1s;  // nothing fails
    one.fault.fault = CellFault::unheard, one.there = false;
    one.moves = true, one.believes_all = true, one.changes = seed % 2 == 0, one.seed = seed;
    one.radius = normal.between(1.0, 3.0), one.tremor = 0.02;
    one.hand_stiffness = 150 * std::pow(8000.0 / 150, normal.between(0.0, 1.0));
    one.hand_force = normal.between(8, 25);
    const SkinFaultResult r = run(one);
    passed += length, hands += 3, masks += r.false_masks, masked_runs += r.false_masks > 0;
    farthest = std::max(farthest, r.motion);
    if (r.healthy_peak > 0) ratio = std::max(ratio, r.peak / r.healthy_peak);
    if (r.false_masks > 0)
      std::printf("seed %d: %zu masked; %.0f N/m, %.0f N, radius %.1f, %.1f s, %s\n", int(seed),
                  r.false_masks, one.hand_stiffness, one.hand_force, one.radius, length,
                  one.changes ? "changes" : "streams");
    std::fflush(stdout);
  }
  std::printf(
      "%.0f s, %zu hands that tremble by 2 %%: %zu healthy cells masked, in %zu runs; peak force at most "
      "%.2f times that of an arm that believes all, %.1f mm from its way\n",
      passed, hands, masks, masked_runs, ratio, farthest);
  return masks == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "hour") == 0) return print_hour(argc > 2 ? std::atof(argv[2]) : 3600);
  if (argc > 2 && std::strcmp(argv[1], "only") == 0) {
    const int seeds = argc > 3 ? std::atoi(argv[3]) : 3;
    print_neighbours(static_cast<std::uint64_t>(std::max(1, seeds)), argv[2]);
    return 0;
  }
  const int runs = argc > 1 ? std::atoi(argv[1]) : 3;
  const auto seeds = static_cast<std::uint64_t>(runs > 0 ? runs : 3);
  print_neighbours(seeds), print_hands(seeds);
  if (runs == 0) return 0;
  std::printf(
      "torques [N m] mean over 4 s from the fault on; 'settled' from 2 s after it; motion: largest way of "
      "the wrist\n"
      "from that of an arm with a healthy skin, and the way of that one [mm]; false: healthy cells masked\n\n"
      "%-11s %6s %-9s | %7s %7s %7s %7s | %9s %6s %6s | %6s | %7s %7s\n",
      "fault", "share", "", "healthy", "plain", "trusted", "settled", "found", "median", "95 %", "false",
      "motion", "way");
  double healthy = 0;
  std::size_t masks = 0;
  for (std::size_t k = 0; k < cell_faults; ++k) {
    for (const double share : {0.0, 0.01, 0.1, 0.3}) {
      for (const bool touched : {false, true}) {
        SkinFaultResult sum;
        for (int n = 0; n < runs; ++n) {
          SkinFaultRun one;
          one.fault.fault = static_cast<CellFault>(k);
          one.share = share, one.touched = touched, one.moves = true, one.seed = std::uint64_t(n + 1);
          const SkinFaultResult r = run(one);
          const double w = 1.0 / runs;
          sum.torque += w * r.torque, sum.plain += w * r.plain, sum.error += w * r.error,
              sum.settled += w * r.settled;
          sum.faulty += r.faulty, sum.found += r.found, sum.false_masks += r.false_masks;
          sum.cell_seconds += r.cell_seconds, sum.motion = std::max(sum.motion, r.motion),
                                              sum.way = std::max(sum.way, r.way);
          sum.time_to_find.insert(sum.time_to_find.end(), r.time_to_find.begin(), r.time_to_find.end());
        }
        std::sort(sum.time_to_find.begin(), sum.time_to_find.end());
        std::printf(
            "%-11s %5.0f%% %-9s | %7.2f %7.2f %7.2f %7.2f | %4zu/%4zu %6.2f %6.2f | %6zu | %7.2f %7.0f\n",
            name(static_cast<CellFault>(k)), 100 * share, touched ? "touched" : "untouched", sum.torque,
            sum.plain, sum.error, sum.settled, sum.found, sum.faulty, sum.percentile(0.5),
            sum.percentile(0.95), sum.false_masks, sum.motion, sum.way);
        healthy += sum.cell_seconds, masks += sum.false_masks;
      }
    }
  }
  std::printf("\nshare 0: one cell. %zu healthy cells masked in %.2g cell-seconds beside faulty ones\n",
              masks, healthy);
  return 0;
}
