// What one sample costs a skin that keeps its sums event by event, and what a cycle costs in which none came.
#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "bench/support/rows.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;

namespace {

/// What the cells say: under the thresholds, as an untouched skin; or another press each time.
enum class Readings { at_rest, pressed };

/// `events` samples of different cells in a cycle of 2 ms. With `events` > 0 the row is the time of one
/// event, the time of an empty cycle included in proportion; else the time of the cycle. All cells take their
/// turn, in another order each time: they keep alive, and none fades.
template <std::size_t Cells, class T>
void receive(benchmark::State& state, std::size_t events, Readings readings, std::size_t substeps) {
  const auto skin = ur5_skin<Cells, T>({10, 3});
  using S = std::remove_cvref_t<decltype(skin)>;
  const auto memory = std::make_unique<typename S::Memory>(skin.start(0ns));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> reading(0.0f, 1.0f);
  constexpr std::size_t rounds = 64;
  std::vector<CellSample> samples(rounds * events);
  std::vector<std::uint32_t> ids(Cells);
  for (std::size_t i = 0; i < Cells; ++i) ids[i] = static_cast<std::uint32_t>(i + 1);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k % Cells == 0) std::shuffle(ids.begin(), ids.end(), random);
    CellSample& s = samples[k];
    s.cell = ids[k % Cells];
    s.force = {0.004f, 0.003f, 0.005f};
    s.proximity = 0.01f;
    if (readings == Readings::pressed) {
      s.force = {reading(random), reading(random), reading(random)};
      s.proximity = reading(random);
    }
  }
  typename S::Wrenches means[8];
  Nanoseconds now{};
  std::size_t round = 0;
  const bench::CountAllocations counted(state);
  const auto cycle = [&] {
    const auto batch = std::span(samples).subspan(events * (round++ % rounds), events);
    const Nanoseconds from = now;
    now += 2ms;
    for (CellSample& s : batch) s.time = now - 1ms;
    benchmark::DoNotOptimize(skin.receive(*memory, batch, from, now, substeps, means));
    benchmark::DoNotOptimize(means);
  };
  if (events == 0) {
    for (auto _ : state) cycle();
  } else {
    while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(events))) cycle();
  }
}

template <std::size_t Cells, class T>
void rows() {
  const std::string end = std::string("/skinctl/") + bench::scalar_name<T>;
  const std::string scene = "/ur5-" + std::to_string(Cells);
  const auto row = [&](const std::string& name, std::size_t events, Readings readings, std::size_t substeps) {
    benchmark::RegisterBenchmark(
        (name + end).c_str(), [=](benchmark::State& s) { receive<Cells, T>(s, events, readings, substeps); });
  };
  // 13 % of 250 samples a second and cell, in 2 ms.
  const std::size_t usual = Cells * 65 / 1000;
  row("tactile/event" + scene, usual, Readings::pressed, 1);
  row("tactile/event" + scene + "-at-rest", usual, Readings::at_rest, 1);
  row("tactile/event" + scene + "-all-cells", Cells, Readings::pressed, 1);
  row("tactile/event" + scene + "-four-substeps", usual, Readings::pressed, 4);
  row("tactile/cycle-without-event" + scene, 0, Readings::at_rest, 1);
}

const bool registered = [] {
  rows<260, double>();
  rows<1260, double>();
  rows<10000, double>();
  rows<1260, float>();
  return true;
}();

}  // namespace
