// The seven faults of a skin's cells against a trusted skin: torque, time to find, false masks, motion.
//
//   skin_faults [runs of each kind, 3]
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "bench/studies/worlds/skin_fault_run.hpp"

using namespace skinctl;
using namespace skinctl::testing;

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 3;
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
