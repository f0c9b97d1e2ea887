#include "examples/compliant_ur5/summary.hpp"

#include <cstdio>

#include "examples/compliant_ur5/noted.hpp"
#include "examples/support/text.hpp"

namespace compliant_ur5 {

std::string text(const char* format, double value) {
  return examples::text(format, value);
}

void print(const Settings& s, const RunLog& log) {
  if (s.quiet) return;
  std::printf("\r%78s\r", "");
  for (const Fact& f : log.scenario) std::printf("  %-34s %s\n", f.name.c_str(), f.value.c_str());
  std::printf("\n  touch   at [s]  link  cell  peak [N]  gave way [mm]  after [ms]  return error [mm]\n");
  int k = 0;
  for (const TouchSummary& t : log.touches) {
    char after[16] = "never";
    if (t.give_way >= 0) std::snprintf(after, sizeof after, "%.0f", 1000 * t.give_way);
    std::printf("  %5d %8.2f %5d %5u %9.1f %14.1f %11s %18.2f\n", ++k, t.start, t.link, t.cell,
                t.true_peak_force >= 0 ? t.true_peak_force : t.peak_force, 1000 * t.deflection, after,
                1000 * t.return_error);
  }
  std::printf("\n  time of a cycle [us]     median      p99    p99.9      max\n");
  for (const StageTimes& t : log.times)
    std::printf("  %-20s %10.2f %8.2f %8.2f %8.2f\n", t.stage.c_str(), t.median, t.p99, t.p999, t.max);
  std::printf("\n");
  for (const Fact& f : log.result) std::printf("  %-34s %s\n", f.name.c_str(), f.value.c_str());
  const auto reasons = noted(log);
  if (reasons.empty()) return;
  std::printf("\n  first [s]  cycles  effect  noted after the first reading (start: %zu cycles)\n",
              cycles_of_start(log));
  for (const Noted& n : reasons)
    std::printf("  %9.2f %7zu  %-6s  %s\n", n.first, n.cycles, name(n.reaction), describe(n.reason));
}

}  // namespace compliant_ur5
