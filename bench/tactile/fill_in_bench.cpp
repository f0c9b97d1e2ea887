// What silent cells cost a trusted skin that fills them in: a cycle without a sample, all other cells
// pressed.
#include <memory>
#include <vector>

#include "bench/support/bench.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;

namespace {

/// `percent` of the cells never speak, the others in every second cycle.
template <std::size_t Cells>
void cycle(benchmark::State& state, int percent, bool two_rings) {
  const auto skin = ur5_skin<Cells>({10, 3});
  TrustSettings trust;
  trust.lone_force = {0.0};
  trust.find_faults = false;
  const CellGraph graph(skin.places());
  const TrustedSkin trusted(skin, trust, two_rings ? FillIn(graph, skin.places()) : FillIn(graph));
  const auto memory = std::make_unique<typename decltype(trusted)::Memory>(trusted.start(0ns));
  auto random = testing::seeded(1);
  std::vector<CellSample> samples;
  for (std::uint32_t id = 1; id <= Cells; ++id)
    if (testing::uniform(random, 0.0, 100.0) >= percent)
      samples.push_back({.cell = id, .force = {0.1f, 0.1f, 0.1f}, .proximity = 0.5f});
  typename decltype(skin)::Wrenches means;
  Nanoseconds now{};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    state.PauseTiming();
    for (CellSample& s : samples) s.time = now + 3ms;
    trusted.receive(*memory, samples, now, now + 4ms, 1, &means);
    now += 4ms;
    state.ResumeTiming();
    benchmark::DoNotOptimize(trusted.receive(*memory, {}, now, now + 4ms, 1, &means));
    benchmark::DoNotOptimize(means);
    now += 4ms;
  }
}

const int registered = [] {
  for (const int percent : {0, 10, 30, 50})
    for (const bool two_rings : {false, true})
      benchmark::RegisterBenchmark(("tactile/fill_in/ur5-1260-silent-" + std::to_string(percent) +
                                    (two_rings ? "/skinctl/double" : "/mean_of_neighbours/double"))
                                       .c_str(),
                                   [=](benchmark::State& s) { cycle<1260>(s, percent, two_rings); });
  return 0;
}();

}  // namespace
