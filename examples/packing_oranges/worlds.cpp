// The same oranges in worlds of both kinds, with what goes wrong in them.
#include <algorithm>

#include "examples/packing_oranges/run.hpp"
#include "examples/support/text.hpp"

namespace packing {
using examples::text;

std::string table_of_worlds(const RunSettings& settings, int runs,
                            const std::function<Outcome(const RunSettings&)>& run, bool& well) {
  struct Row {
    const char* words;
    int ghosts = 0;
    double bias = 0, friction = 0.8;
  };
  constexpr Row rows[] = {{"nothing else"},
                          {"one ghost", 1},
                          {"three ghosts", 3},
                          {"the camera is off by 25 mm", 0, 0.025},
                          {"friction 0.3", 0, 0, 0.3},
                          {"friction 0.15", 0, 0, 0.15},
                          {"friction 0.15, three ghosts, 25 mm", 3, 0.025, 0.15}};
  std::string out = text(
      "| of %d oranges (%d runs) | world | right | lost | left | takes of nothing | questions | s a run | "
      "largest force |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      runs * settings.supply.oranges, runs);
  well = true;
  for (const Row& row : rows)
    for (const bool honest : {false, true}) {
      if (!honest && row.ghosts > 0) continue;  // a detector that numbers oranges has no number for a ghost
      int right = 0, lost = 0, left = 0, empty = 0, asked = 0;
      double time = 0, force = 0;
      for (int n = 0; n < runs; ++n) {
        RunSettings s = settings;
        s.honest = honest;
        s.seed = settings.seed + static_cast<std::uint64_t>(n);
        s.detector.ghosts = row.ghosts;
        s.detector.bias = row.bias;
        s.world.friction = row.friction;
        const Outcome o = run(s);
        right += o.right(), lost += o.lost(), left += o.left(), time += o.time / runs;
        force = std::max(force, o.worst_force());
        for (const auto& a : o.arm) empty += a.empty_takes, asked += a.asked;
        well = well && (!honest || o.over);
      }
      out += text("| %s | %s | %d | %d | %d | %d | %d | %.1f | %.1f N |\n", row.words,
                  honest ? "honest" : "ideal", right, lost, left, empty, asked, time, force);
    }
  return out;
}

}  // namespace packing
