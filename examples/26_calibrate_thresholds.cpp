// 26 Thresholds: each cell's from two seconds of its own noise, so that a quiet cell feels half a newton.
//
//   rest, sigma   mean and standard deviation of a cell's force reading while nobody touches it
//   threshold     rest + max(6 sigma, 1.5 (max - median), 2 steps); without them 0.08 above rest for all
//   felt          the smaller one of two samples in a row, where it is above the threshold
//   drawn         a quiet, a noisy and a drifting cell, each pressed with its threshold beside it, in thousandths
#include <cstdio>

#include "examples/worlds/cell_noise.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/sensing/noise.hpp"
#include "support/curves.hpp"

using namespace examples;
using namespace skinctl;

namespace {

constexpr std::size_t cells = 260, quiet = 130, noisy = 150, drifting = 200, approached = 60, dead = 40;
constexpr double newtons_per_reading = 20;
constexpr Nanoseconds period = 4ms;

/// The simulated skin: noise differs from cell to cell, one drifts, a hand hovers over one, one is dead.
std::vector<testing::NoisyCell> simulated_cells() {
  std::vector<testing::NoisyCell> out;
  for (std::size_t i = 0; i < cells; ++i) {
    testing::NoisyCell::Settings s{
        .rest = 0.012, .sigma = 0.0005 + 0.00001 * double(i % 100), .tail = 0.01, .tail_sigma = 2};
    if (i == quiet) s.sigma = 0.0005;
    if (i == noisy) s.sigma = 0.004;
    if (i == drifting) s.drift = 0.004;
    out.emplace_back(s, i + 1);
  }
  return out;
}
/// A press on the quiet cell, then on the others [N].
double press(std::size_t i, double t) {
  if (i == quiet) return t > 4 && t < 5 ? 0.5 : 0;
  if (i == noisy || i == drifting) return t > 6 && t < 7 ? 1.5 : 0;
  return 0;
}
CellSample sample_of(testing::NoisyCell& cell, std::size_t i, Nanoseconds now) {
  const double t = seconds<double>(now), sum = cell(std::min(t, 10.0)) + press(i, t) / newtons_per_reading;
  const auto third = static_cast<float>(std::max(0.0, sum) / 3);
  return {.time = now,
          .cell = std::uint32_t(i + 1),
          .force = {third, third, third},
          .proximity = i == approached ? 0.2f : 0.01f};
}

}  // namespace

int main(int argc, char** argv) {
  auto skin = simulated_cells();
  const CellNoise file{.rest = 0.012, .margin = 0.08};  // so far, for all cells

  // Two seconds in which nobody touches the arm.
  NoiseCalibration calibration(std::vector<CellNoise>(cells, file));
  Curve readings[3] = {{"reading"}, {"reading"}, {"reading"}},
        thresholds[3] = {{"threshold"}, {"threshold"}, {"threshold"}};
  for (Curve& c : thresholds) c.dashed = true;
  const std::size_t shown[3] = {quiet, noisy, drifting};
  const auto show = [&](std::size_t i, double t, const CellSample& s, double threshold) {
    for (std::size_t k = 0; k < 3; ++k)
      if (shown[k] == i) readings[k].add(t, 3e3 * double(s.force[0])), thresholds[k].add(t, 1e3 * threshold);
  };
  Nanoseconds now{};
  for (; now < 2s; now += period)
    for (std::size_t i = 0; i < cells; ++i) {
      if (i == dead) continue;
      const CellSample sample = sample_of(skin[i], i, now);
      calibration.add(i, sample);
      show(i, seconds<double>(now), sample, file.threshold());
    }
  const std::vector<CellNoise> noise = calibration.result();
  std::size_t kept = 0;
  double mean = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    mean += noise[i].margin / double(cells);
    if (noise[i].finding == NoiseFinding::good) continue;
    std::printf("cell %3zu keeps the file's level: %s\n", i, describe(noise[i].finding));
    ++kept;
  }
  std::printf(
      "margin above rest: %.1f thousandths for the quiet cell, %.1f for the noisy one, %.1f on average; 80 "
      "before\n",
      1e3 * noise[quiet].margin, 1e3 * noise[noisy].margin, 1e3 * mean);

  // Two minutes of use.
  std::vector<TwoInARow::Memory> rows(cells);
  std::size_t single = 0, twice = 0, felt = 0, felt_before = 0;
  for (; now < 122s; now += period)
    for (std::size_t i = 0; i < cells; ++i) {
      if (i == dead) continue;
      const CellSample sample = sample_of(skin[i], i, now);
      if (now < 10s) show(i, seconds<double>(now), sample, noise[i].threshold());
      const double t = seconds<double>(now), unit = CellCounts::force_unit, threshold = noise[i].threshold();
      const double reading = counts(sample).force * unit;
      const double both = TwoInARow::take(rows[i], counts(sample)).force * unit;
      if (press(i, t) > 0 && i == quiet) {
        felt += both > threshold;
        felt_before += reading > file.threshold();
      }
      if (press(i, t) > 0 || press(i, t - 0.05) > 0 || i == drifting) continue;
      single += reading > threshold;
      twice += both > threshold;
    }
  std::printf("half a newton on the quiet cell: felt in %zu of 249 samples, %zu before\n", felt, felt_before);
  std::printf("false touches of %zu cells in two minutes: %zu by one sample, %zu by two in a row\n", cells,
              single, twice);
  const std::vector<plotting::Band> pressed{
      {0, 2, "2 s of noise", ""}, {4, 5, "0.5 N, quiet one", ""}, {6, 7, "1.5 N on the others", ""}};
  return draw(argc, argv, "26_calibrate_thresholds.svg",
              "Thresholds: each cell's from two seconds of its own noise",
              {Panel("quiet cell [1/1000]", {readings[0], thresholds[0]}),
               Panel("noisy cell [1/1000]", {readings[1], thresholds[1]}),
               Panel("drifting cell [1/1000]", {readings[2], thresholds[2]})},
              pressed) ||
         kept != 3 || felt < 240 || felt_before != 0 || twice != 0;
}
