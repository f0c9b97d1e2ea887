// The shape of patches of skin from gravity: errors after rigid alignment beside the Procrustes chain's,
// consistency of the covariances, time, and what is reported when the poses do not show all.
//
//   skin_reconstruction [seeds, 8]
//
// Accelerometers of a BMA250 (bias 40 mg, scale 1.5 %, noise 9 mg, steps of 1/256 g, 0.3 % across axes), a
// hundred samples in each of eight poses, joined ports 0.1 mm off. Each pair of numbers: median and worst
// over the seeds. "bound": the rms error that the covariances predict, which no estimator from the same
// readings and priors undercuts in the mean (Bayesian Cramer-Rao).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "bench/studies/median_and_worst.hpp"
#include "skinctl/calibration/reconstruction.hpp"
#include "skinctl/testing/skin_at_rest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double deg = 0.0174532925;

// Of this program alone: others may use the processor as well.
double now() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 8;
  std::printf("%-26s %13s %13s %13s %13s %13s %13s %11s %11s %9s\n", "cells, misalignment", "chain [mm]",
              "chain [deg]", "fit [mm]", "bound [mm]", "fit [deg]", "bound [deg]", "NEES / 6", "time [s]",
              "steps");
  struct Row {
    std::size_t cells;
    double radius, length, misalignment;
  };
  for (const Row row : {Row{500, 0.06, 0.97, 0.2}, Row{20, 0.04, 0.12, 0.2}, Row{20, 0.04, 0.12, 0.7},
                        Row{100, 0.05, 0.3, 0.7}, Row{500, 0.06, 0.97, 0.7}}) {
    MedianAndWorst chain_p, chain_r, p, r, bound_p, bound_r, consistency, time, steps;
    for (int seed = 1; seed <= seeds; ++seed) {
      auto rng = seeded(std::uint64_t(seed));
      SimulatedAccelerometer sensor;
      sensor.prior.misalignment = row.misalignment * deg;
      const auto patch = tube(row.radius, row.length, row.cells, sensor, rng);
      if (patch.cells.size() != row.cells) std::printf("%zu cells\n", patch.cells.size());
      const auto y = rest_readings(patch, cube_corners(rng), sensor, rng);
      ReconstructionSettings s;
      s.prior = sensor.prior;
      const auto chain = shape_error(procrustes_chain(patch.graph, y, s), patch);
      const double from = now();
      const auto found = reconstruct(patch.graph, y, s);
      time.values.push_back(now() - from);
      const auto e = shape_error(found, patch);
      if (e.known != row.cells) std::printf("seed %d: %zu cells known\n", seed, e.known);
      chain_p.values.push_back(1e3 * chain.place), chain_r.values.push_back(chain.turn / deg);
      p.values.push_back(1e3 * e.place), r.values.push_back(e.turn / deg);
      double place = 0, angle = 0;
      for (const auto& cell : found.cells) {
        place += cell.covariance.topLeftCorner<3, 3>().trace();
        angle += cell.covariance.bottomRightCorner<3, 3>().trace();
      }
      bound_p.values.push_back(1e3 * std::sqrt(place / double(found.cells.size())));
      bound_r.values.push_back(std::sqrt(angle / double(found.cells.size())) / deg);
      consistency.values.push_back(e.nees), steps.values.push_back(found.steps);
    }
    std::printf("%4zu, %.1f deg             ", row.cells, row.misalignment);
    chain_p.print(" %6.2f %6.2f"), chain_r.print(" %6.2f %6.2f"), p.print(" %6.3f %6.3f"),
        bound_p.print(" %6.3f %6.3f"), r.print(" %6.2f %6.2f"), bound_r.print(" %6.2f %6.2f");
    consistency.print(" %5.2f %5.2f"), time.print(" %5.2f %5.2f"), steps.print(" %4.0f %4.0f");
    std::printf("\n");
    std::fflush(stdout);
  }

  // A turn of a sensor in its cell looks like a turn of the cell: only loops of connectors tell them apart,
  // and twenty cells have few. "exact": the bound of readings without cross-axis errors, 0.9 mg, between
  // ports that meet to 0.01 mm.
  std::printf("\nTwenty cells of 0.7 deg by the loops between them, rms over 200 seeds\n");
  std::printf("%-12s %6s %10s %10s %17s %10s %10s %17s %12s\n", "tube [mm]", "loops", "fit [deg]",
              "bound [deg]", "exact [deg]", "fit [mm]", "bound [mm]", "exact [mm]", "below 1.1 deg");
  for (const double radius : {0.045, 0.04, 0.0375, 0.03}) {
    double sums[6] = {}, below = 0;
    std::size_t loops = 0;
    for (int seed = 1; seed <= 200; ++seed) {
      auto rng = seeded(std::uint64_t(seed));
      SimulatedAccelerometer sensor;
      sensor.prior.misalignment = 0.7 * deg;
      const auto patch = tube(radius, 0.12, 20, sensor, rng);
      loops = patch.graph.joints.size() + 1 - patch.cells.size();
      const auto y = rest_readings(patch, cube_corners(rng), sensor, rng);
      ReconstructionSettings s;
      s.prior = sensor.prior;
      for (const int exact : {0, 1}) {
        if (exact) s.reading = 9e-4, s.gap = 1e-5;
        const auto found = reconstruct(patch.graph, y, s);
        if (!exact) {
          const auto e = shape_error(found, patch);
          sums[0] += e.turn * e.turn / 200, sums[1] += e.place * e.place / 200, below += e.turn < 1.1 * deg;
        }
        for (const auto& cell : found.cells) {
          sums[2 + 2 * exact] += cell.covariance.bottomRightCorner<3, 3>().trace() / 20 / 200;
          sums[3 + 2 * exact] += cell.covariance.topLeftCorner<3, 3>().trace() / 20 / 200;
        }
      }
    }
    for (double& x : sums) x = std::sqrt(x);
    std::printf("%-12.1f %6zu %10.3f %10.3f %17.3f %10.3f %10.3f %17.3f %8.0f of 200\n", 1e3 * radius, loops,
                sums[0] / deg, sums[2] / deg, sums[4] / deg, 1e3 * sums[1], 1e3 * sums[3], 1e3 * sums[5],
                below);
    std::fflush(stdout);
  }

  std::printf("\nA tube of 100 cells whose axis stays near gravity in all poses (misalignment 0.7 deg)\n");
  std::printf("%-34s %13s %13s %15s %13s\n", "axis within, of gravity", "known", "fit [mm]",
              "fit, worst [deg]", "unknown to [deg]");
  for (const double within : {30.0, 10.0, 3.0, 0.0}) {
    MedianAndWorst known, p, r, said;
    for (int seed = 1; seed <= seeds; ++seed) {
      auto rng = seeded(std::uint64_t(seed));
      const SimulatedAccelerometer sensor;
      const auto patch = tube(0.05, 0.3, 100, sensor, rng);
      std::vector<Eigen::Vector3d> up;
      for (int k = 0; k < 8; ++k) {
        const double angle = 0.785398163 * k;
        up.push_back(turn(within * deg * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)).col(2) *
                     (k % 2 ? 1 : -1));
      }
      const auto found = reconstruct(patch.graph, rest_readings(patch, up, sensor, rng));
      const auto e = shape_error(found, patch);
      double worst = 0;
      for (const auto& u : found.unobservable) worst = std::max(worst, u.deviation / deg);
      known.values.push_back(double(e.known)), p.values.push_back(1e3 * e.place);
      r.values.push_back(e.worst_turn / deg), said.values.push_back(worst);
    }
    std::printf("%4.0f deg                          ", within);
    known.print(" %6.0f %6.0f"), p.print(" %6.2f %6.2f"), r.print(" %7.2f %7.2f"), said.print(" %6.0f %6.0f");
    std::printf("\n");
  }
  return 0;
}
