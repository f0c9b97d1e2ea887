// Promise: a threshold from 2 s of noise, two samples in a row, is not touched by noise
// Tried: 1000 cells, an hour of 250 Hz, sigma 0.5 to 3 steps: Gaussian 0.15 % of cells with one sample,
// 1e-9 % with two; a hundredth of samples half as much again wider: 22 and 1e-5 %; three times as wide:
// 96 and 2.5 %; drift of 3 sigma in the 2 s, proximity, a press: the file's level stays and the finding
// says why

#include "skinctl/sensing/noise.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "examples/worlds/cell_noise.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using testing::NoisyCell;

namespace {
constexpr double lsb = 1.0 / 1024;
const CellNoise file{.rest = 0.012, .margin = 0.08};

std::vector<NoiseReading> two_seconds(NoisyCell cell, double period = 0.004, double proximity = 0.01) {
  std::vector<NoiseReading> out;
  for (double t = 0; t < 2; t += period) out.push_back({nanoseconds(t), cell(t), proximity});
  return out;
}
/// Shares of cells with a false touch within an hour of 250 Hz: one sample above the threshold, two in a row.
struct Share {
  double one = 0, two = 0;
};
Share false_touches(const NoisyCell::Settings& s, std::uint64_t cells) {
  Share sum;
  for (std::uint64_t k = 1; k <= cells; ++k) {
    NoisyCell cell(s, k);
    auto readings = two_seconds(cell);
    const auto noise = cell_noise(readings, file);
    if (noise.finding != NoiseFinding::good) continue;
    const double p = cell.above(noise.threshold()), hour = 3600 * 250;
    sum.one -= std::expm1(hour * std::log1p(-p));
    sum.two -= std::expm1(hour * std::log1p(-p * p));
  }
  return {sum.one / double(cells), sum.two / double(cells)};
}
struct Front {
  TwoInARow::Memory* memory;
  CellCounts reading(std::size_t i, const CellSample& s) const {
    return TwoInARow::take(memory[i], counts(s));
  }
  template <class Revise>
  void settle(Revise&&) const {}
};
}  // namespace

TEST_CASE("cell_noise: rest, sigma and margin of known readings") {
  // 0 and 2 steps by turns, one peak of 9; half of the readings are 2 or more.
  std::vector<NoiseReading> r;
  for (int k = 0; k < 500; ++k) r.push_back({k * 4ms, (k == 250 ? 9 : k % 2 * 2) * lsb, 0.0});
  const auto n = cell_noise(r, file);
  CHECK(n.finding == NoiseFinding::good);
  CHECK(n.rest == doctest::Approx(509 / 500.0 * lsb).epsilon(0.01));
  CHECK(n.sigma == doctest::Approx(std::sqrt(1 + 64 / 500.0 + 1 / 12.0) * lsb).epsilon(0.01));
  CHECK(n.margin == doctest::Approx(1.5 * 7 * lsb));
  // A quiet cell: two steps.
  for (auto& x : r) x = {x.time, 0.01, 0};
  std::sort(r.begin(), r.end(), [](auto& a, auto& b) { return a.time < b.time; });
  const auto quiet = cell_noise(r, file);
  CHECK(quiet.sigma == doctest::Approx(lsb / std::sqrt(12.0)));
  CHECK(quiet.margin == 2 * lsb);
  CHECK(quiet.threshold() == doctest::Approx(0.01 + 2 * lsb));
}

TEST_CASE("cell_noise: a cell that sends only changes has the noise of one that sends all") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto all = two_seconds(NoisyCell({.sigma = 0.0006}, seed));
    std::vector<NoiseReading> changes;
    for (const auto& r : all)
      if (changes.empty() || r.value != changes.back().value || r.time - changes.back().time >= 100ms)
        changes.push_back(r);
    CHECK(changes.size() < all.size());
    const auto a = cell_noise(all, file), b = cell_noise(changes, file);
    CHECK(b.finding == NoiseFinding::good);
    CHECK(b.rest == doctest::Approx(a.rest).epsilon(0.01));
    CHECK(b.sigma == doctest::Approx(a.sigma).epsilon(0.03));
    CHECK(b.margin == doctest::Approx(a.margin).epsilon(0.03));
  }
}

TEST_CASE("cell_noise: what is no noise leaves the file's level, and says why") {
  const auto stays = [&](std::vector<NoiseReading> r, NoiseFinding why) {
    const auto n = cell_noise(r, file);
    CHECK(describe(n.finding) == std::string(describe(why)));
    if (why != NoiseFinding::good) CHECK((n.rest == file.rest && n.margin == file.margin));
  };
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    stays(two_seconds(NoisyCell({}, seed)), NoiseFinding::good);
    stays(two_seconds(NoisyCell({.sigma = 0.0001}, seed)), NoiseFinding::good);
    // Three sigma in two seconds.
    stays(two_seconds(NoisyCell({.drift = 0.0025}, seed)), NoiseFinding::drift);
    stays(two_seconds(NoisyCell({}, seed), 0.05), NoiseFinding::good);
  }
  stays(two_seconds(NoisyCell({}, 1), 0.004, 0.06), NoiseFinding::near);
  stays(two_seconds(NoisyCell({.rest = 0.3}, 1)), NoiseFinding::offset);
  stays({}, NoiseFinding::silent);
  stays({{1s, 0.01, 0}}, NoiseFinding::silent);
  stays({{1s, 0.01, 0}, {1s, 0.01, 0}}, NoiseFinding::silent);
  auto nan = two_seconds(NoisyCell({}, 1));
  nan[7].value = std::numeric_limits<double>::quiet_NaN();
  stays(nan, NoiseFinding::silent);
  std::vector<NoiseReading> none;
  CHECK_THROWS_AS(cell_noise(none, file, {.step = 0}), ConfigurationError);
  CHECK_THROWS_AS(cell_noise(none, file, {.near = 2}), ConfigurationError);
}

TEST_CASE("cell_noise: false touches within an hour, one sample against two in a row") {
  const std::uint64_t cells = testing::sanitized ? 50 : 1000;
  for (const double sigma : {0.5 * lsb, lsb, 3 * lsb}) {
    // Gaussian; a hundredth with half as much again; a hundredth with three times as much.
    const auto plain = false_touches({.sigma = sigma}, cells);
    const auto wider = false_touches({.sigma = sigma, .tail = 0.01, .tail_sigma = 1.5}, cells);
    const auto wild = false_touches({.sigma = sigma, .tail = 0.01}, cells);
    MESSAGE("sigma ", sigma / lsb, " steps, % of cells: ", 100 * plain.one, " and ", 100 * plain.two, "; ",
            100 * wider.one, " and ", 100 * wider.two, "; ", 100 * wild.one, " and ", 100 * wild.two);
    CHECK(plain.one <= 0.003);
    CHECK(plain.two <= 1e-9);
    CHECK(wider.two <= 1e-6);
    CHECK(wider.one > 10 * wider.two);
    CHECK(wild.two <= 0.03);
    CHECK(wild.one > 0.8);
  }
}

TEST_CASE(
    "TwoInARow: in front of a skin, one peak is no touch; a press is felt a sample later, its end at once") {
  const auto skin = ur5_skin<260>({.force = 40});
  auto memory = skin.start(0ns);
  std::vector<TwoInARow::Memory> cells(skin.cells);
  const std::size_t i = skin.index(130);
  const auto felt = [&](int k, float f) {
    const CellSample s{.time = k * 4ms, .cell = 130, .force = {f, f, f}};
    typename decltype(skin)::Wrenches means[1];
    static_cast<void>(
        skin.receive(memory, std::span(&s, 1), (k - 1) * 4ms, k * 4ms, 1, means, Front{cells.data()}));
    return skin.held(memory, i).force;
  };
  CHECK(felt(1, 0.0f) == 0);
  CHECK(felt(2, 0.2f) == 0);
  CHECK(felt(3, 0.0f) == 0);
  CHECK(felt(4, 0.2f) == 0);
  const auto pressed = felt(5, 0.3f);
  CHECK(pressed > 0);
  CHECK(felt(6, 0.3f) > pressed);
  CHECK(felt(7, 0.0f) == 0);
  CHECK(TwoInARow::settled({{7, 9}}) == CellCounts{7, 9});
}
