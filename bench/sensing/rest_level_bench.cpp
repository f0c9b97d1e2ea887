// What the rest level of a cell costs a scan, untouched and with a tenth of the cells frozen, and a cell at
// its own times. Rows of a scan are the time of all cells.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "bench/support/bench.hpp"
#include "skinctl/sensing/evidence.hpp"
#include "skinctl/sensing/rest_level.hpp"

using namespace skinctl;

namespace {

void scan(benchmark::State& state, std::size_t cells, bool touched) {
  const RestLevel rest;
  const std::size_t blocks = cells / RestRow::cells, frames = 8;
  std::mt19937_64 random(1);
  std::normal_distribution<float> noise(0, 0.7f);
  std::vector<RestRow> rows(blocks);
  std::vector<RestLevelsRow> levels(blocks);
  std::vector<std::vector<float>> x(frames, std::vector<float>(16 * blocks));
  const std::vector<float> evidence(16 * blocks, 0.0f);
  for (std::size_t b = 0; b < blocks; ++b)
    for (std::size_t i = 0; i < 16; ++i) {
      levels[b].freeze[i] = 1, levels[b].touch[i] = 80;
      RestLevel::put(rows[b], i, rest.start(100.0f).cell);
      // Contacts cover neighbours: whole rows.
      const float press = touched && b % 10 == 0 ? 200.0f : 0.0f;
      for (auto& frame : x) frame[16 * b + i] = std::round(100 + press + noise(random));
    }
  const auto step = rest.step(4ms);
  std::size_t frame = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const std::size_t next = (frame + 1) % frames;
    for (std::size_t b = 0; b < blocks; ++b)
      RestLevel::scan(rows[b], &x[frame][16 * b], &x[next][16 * b], &evidence[16 * b], levels[b], step);
    frame = next;
    benchmark::DoNotOptimize(rows.data());
    benchmark::ClobberMemory();
  }
}

const bool registered = [] {
  for (const std::size_t cells : {std::size_t{1264}, std::size_t{10000}, std::size_t{100000}})
    for (const bool touched : {false, true})
      benchmark::RegisterBenchmark(("sensing/rest-level-scan-" + std::string(touched ? "touched" : "calm") +
                                    "/" + std::to_string(cells) + "-cells/skinctl/float")
                                       .c_str(),
                                   [=](benchmark::State& state) { scan(state, cells, touched); });
  benchmark::RegisterBenchmark("sensing/rest-level-take/sample/skinctl/float", [](benchmark::State& state) {
    const RestLevel rest;
    auto memory = rest.start(100.0f);
    float x = 100;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      x = 201 - x;
      rest.take(memory, x, 4ms, 0.0f, RestLevels{});
      benchmark::DoNotOptimize(memory);
    }
  });
  benchmark::RegisterBenchmark("sensing/patch-median/1264-cells/skinctl/float", [](benchmark::State& state) {
    std::vector<RestRow> rows(79);
    std::mt19937_64 random(1);
    std::normal_distribution<float> noise(0, 5);
    for (auto& row : rows)
      for (float& r : row.above) r = noise(random);
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      float median = patch_median(rows.data(), 0, 1264);
      benchmark::DoNotOptimize(median);
    }
  });
  return true;
}();

}  // namespace
