// Each fault at each step of the plan.
#include "examples/packing_oranges/run.hpp"
#include "examples/support/text.hpp"

namespace packing {
using examples::text;

Met how_met(const Outcome& o) {
  if (!o.over) return Met::not_over;
  Met met = Met::went_on;
  const auto at_least = [&](Met m) { met = met < m ? m : met; };
  for (const Done& d : o.arm[0].done) {
    if (d.to < o.fault_begins) continue;
    if (d.asks) at_least(Met::asked);
    if (d.back) at_least(Met::went_back);
    if (d.why != skinctl::StepFailure::none) at_least(Met::tried_again);
  }
  return met;
}

std::string table_of_faults(const RunSettings& settings,
                            const std::function<Outcome(const RunSettings&)>& run, bool& all_over) {
  constexpr const char* words[] = {"goes on", "tries again", "goes back", "asks", "DOES NOT END"};
  constexpr Fault all[] = {Fault::slip, Fault::no_detector, Fault::box_blocked, Fault::touch_held};
  std::string out =
      "| when the first arm begins to | slip | no_detector | box_blocked | touch_held, 30 N |\n"
      "|---|---|---|---|---|\n";
  int lost = 0, runs = 0, right = 0, oranges = 0;
  all_over = true;
  for (std::uint8_t step = 0; step < step::count; ++step) {
    out += text("| %s%s |", name_of(pack_oranges, step), step == step::drop ? " a bad one" : "");
    for (const Fault fault : all) {
      RunSettings s = settings;
      s.supply.oranges = 4;
      s.supply.share = step >= step::lift_bad && step <= step::drop ? 0 : 1;
      s.touch_every = 0;
      s.touch_force = 30;
      s.work.executor.max_place_wait = std::chrono::seconds(4);
      s.fault = fault;
      s.fault_step = step;
      const Outcome o = run(s);
      const Met met = how_met(o);
      all_over = all_over && met != Met::not_over;
      out += text(" %s |", words[static_cast<std::size_t>(met)]);
      lost += o.lost(), right += o.right(), oranges += o.oranges, ++runs;
    }
    out += '\n';
  }
  return out + text("%d runs: %d of %d oranges where they belong, %d lost\n", runs, right, oranges, lost);
}

}  // namespace packing
