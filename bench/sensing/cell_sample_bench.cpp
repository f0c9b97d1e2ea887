// What it costs to believe a sample: the check, the counts, the gates.
#include <random>
#include <vector>

#include "bench/support/bench.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/event_gate.hpp"

using namespace skinctl;

namespace {

const std::vector<CellSample>& samples() {
  static const std::vector<CellSample> pool = [] {
    std::vector<CellSample> all(1024);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<float> reading(0.0f, 1.0f);
    for (CellSample& s : all) {
      s.force = {reading(random), reading(random), reading(random)};
      s.proximity = reading(random);
    }
    return all;
  }();
  return pool;
}

template <class F>
void row(const char* name, F evaluate) {
  benchmark::RegisterBenchmark(name, [evaluate](benchmark::State& state) {
    const auto& pool = samples();
    std::size_t k = 0;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      auto result = evaluate(pool[k++ % 1024]);
      benchmark::DoNotOptimize(result);
    }
  });
}

const bool registered = [] {
  row("sensing/check/sample/skinctl/float", [](const CellSample& s) { return check(s).bits(); });
  row("sensing/counts/sample/skinctl/float", [](const CellSample& s) { return counts(s); });
  const auto gate = EventGate<>::dead_band(0.08).counted(CellCounts::force_unit);
  row("sensing/check-counts-gate/sample/skinctl/float",
      [gate](const CellSample& s) { return check(s).any() ? 0 : gate.pass(counts(s).force, false); });
  return true;
}();

}  // namespace
