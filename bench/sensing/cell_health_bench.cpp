// What the fault rules cost: the scan of all cells, and a trusted skin beside one that believes its cells.
// Rows are the time of all cells.
#include <memory>
#include <vector>

#include "bench/support/bench.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/sensing/cell_health.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/testing/skin_signals.hpp"

using namespace skinctl;

namespace {

template <std::size_t Cells>
void scan(benchmark::State& state) {
  using Health = CellHealth<Cells>;
  const Health health;
  auto memory = std::make_unique<typename Health::Memory>();
  testing::Normal normal(1);
  std::vector<CellSample> samples(Cells);
  for (CellSample& s : samples) {
    for (float& f : s.force) f = static_cast<float>(std::round(20 + 0.7 * normal()) / 1024);
    s.acceleration[0] = static_cast<float>(normal());
  }
  Nanoseconds t{};
  for (std::size_t i = 0; i < Cells; ++i) health.take(*memory, i, samples[i]);
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    health.scan(*memory, t += 4ms, [](std::size_t) { return typename Health::Witness{}; });
    benchmark::ClobberMemory();
  }
}

/// A cycle of 8 ms in which every cell sends two samples; a tenth of them is touched.
template <class S, class Start>
void receive(benchmark::State& state, const S& skin, const Start& start) {
  testing::SkinSignals signals(cell_places(ur5::skin_patches<260>()));
  signals.touches.push_back(
      {.link = 2, .place = signals.cells()[150].place, .radius = 0.08, .from = 10ms, .until = 60s});
  std::vector<std::vector<CellSample>> sent(32);
  for (std::size_t k = 0; k < sent.size(); ++k)
    signals.samples(8ms * static_cast<std::int64_t>(k + 1), sent[k]);
  auto memory = std::make_unique<typename S::Memory>(start);
  typename S::Wrenches w;
  std::size_t k = 0;
  Nanoseconds t{};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    if (k == sent.size()) {
      state.PauseTiming();
      *memory = start, k = 0, t = 0ns;
      state.ResumeTiming();
    }
    skin.receive(*memory, sent[k++], t, t + 8ms, 1, &w);
    t += 8ms;
    benchmark::DoNotOptimize(w);
  }
}

const bool registered = [] {
  benchmark::RegisterBenchmark("sensing/cell-health-scan/1264-cells/skinctl/float", scan<1264>);
  benchmark::RegisterBenchmark("sensing/cell-health-scan/10000-cells/skinctl/float", scan<10000>);
  benchmark::RegisterBenchmark("sensing/cell-health-scan/100000-cells/skinctl/float", scan<100000>);
  benchmark::RegisterBenchmark("tactile/receive-520-samples/260-cells/skinctl/double",
                               [](benchmark::State& state) {
                                 const auto skin = ur5_skin<260>();
                                 receive(state, skin, skin.start(0ns));
                               });
  benchmark::RegisterBenchmark("tactile/receive-520-samples-trusted/260-cells/skinctl/double",
                               [](benchmark::State& state) {
                                 TrustSettings trust;
                                 trust.lone_force = {5.0};
                                 trust.noise = {{.rest = 20.5f}};
                                 const TrustedSkin skin(ur5_skin<260>(), trust);
                                 receive(state, skin, skin.start(0ns));
                               });
  return true;
}();

}  // namespace
