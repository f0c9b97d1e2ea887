// A trusted skin on recorded grasps (SKINCTL_DATA_DIR/icub_grasp_tactile): false masks, and filling in.
//
//   skin_grasps [every n-th recording, 1] [seconds that each grasp is held, 10]
//
// The recordings have no proximity and no noise of single samples: both are made up. 2 % of the taxels are
// blind. A tap of 6 ms on a taxel, that its neighbours feel by 40 %, comes every 2 s.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "bench/studies/worlds/recorded_grasps.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/testing/skin_signals.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t taxels = RecordedGrasp::taxels;
using Hand = Skin<ur5::Model, double, Patch<0, 12>, Patch<1, 12>, Patch<2, 12>, Patch<3, 12>, Patch<4, 12>>;

/// Twelve taxels of a finger, 4 x 3, 6 mm apart.
template <std::size_t I>
Patch<I, 12> finger() {
  std::vector<PlacedCell<I>> cells;
  for (std::size_t k = 0; k < 12; ++k)
    cells.push_back(
        {static_cast<std::uint32_t>(1 + 12 * I + k),
         Transform<Link<I>, Cell>::translation_xyz(0.006 * double(k % 4), 0.006 * double(k / 4), 0)});
  return Patch<I, 12>(cells, {.force = 10});
}
const auto fingers = std::tuple{finger<0>(), finger<1>(), finger<2>(), finger<3>(), finger<4>()};
/// All taxels of a finger know each other.
CellGraph of_fingers() {
  std::vector<std::vector<CellGraph::Index>> lists(taxels);
  for (std::size_t i = 0; i < taxels; ++i)
    for (std::size_t k = 0; k < 12; ++k)
      if (const auto j = static_cast<CellGraph::Index>(i / 12 * 12 + k); j != i) lists[i].push_back(j);
  return CellGraph(lists);
}

struct FalseMasks {
  std::size_t masks = 0, of[cell_faults] = {};
  double cell_seconds = 0;
};
void play(const RecordedGrasp& grasp, double held, std::uint64_t seed, FalseMasks& out) {
  constexpr double step = 1.0 / 255, sigma = 0.7;
  const Hand skin = std::apply([](const auto&... p) { return Hand(p...); }, fingers);
  TrustSettings trust;
  trust.lone_force = {1.0};
  trust.health.step = step;
  trust.noise.clear();
  for (std::size_t i = 0; i < taxels; ++i)
    trust.noise.push_back({.force = float(sigma), .proximity = float(sigma), .rest = float(grasp.rest[i])});
  const TrustedSkin trusted(skin, trust, FillIn(of_fingers()));
  auto m = std::make_unique<typename decltype(trusted)::Memory>(trusted.start(0ns));
  Normal normal(seed);
  std::array<bool, taxels> blind{}, masked{};
  for (bool& b : blind) b = normal.between(0.0, 1.0) < 0.02;
  const double length = grasp.lasts() + held;
  std::vector<CellSample> samples(taxels);
  std::size_t tapped = 0;
  double tap_at = 1;
  const auto n = static_cast<int>(length / 0.004);
  for (int k = 1; k <= n; ++k) {
    const double t = 0.004 * k;
    if (t > tap_at + 0.006) tap_at += 2, tapped = normal.bits()() % taxels;
    for (std::size_t i = 0; i < taxels; ++i) {
      CellSample& s = samples[i];
      s.cell = static_cast<std::uint32_t>(i + 1), s.time = nanoseconds(t);
      double x = grasp.reading(i, t);
      if (t >= tap_at && i / 12 == tapped / 12) x += (i == tapped ? 1.0 : 0.4) * 60;
      for (float& f : s.force)
        f = static_cast<float>(std::clamp(std::round(x + sigma * normal()), 0.0, 255.0) * step);
      // It sees what will touch it within 0.3 s, and did.
      const double soon =
          std::max({grasp.reading(i, t + 0.3), grasp.reading(i, t + 0.15), x, grasp.reading(i, t - 0.3)});
      const double p = blind[i] ? 0.01 : 0.9 * std::clamp((soon - grasp.rest[i]) / 20, 0.0, 1.0);
      s.proximity =
          static_cast<float>(std::clamp(std::round(p / step + sigma * normal()), 0.0, 255.0) * step);
      for (float& a : s.acceleration) a = static_cast<float>(0.05 * normal());
    }
    typename Hand::Wrenches w;
    trusted.receive(*m, samples, nanoseconds(t - 0.004), nanoseconds(t), 1, &w);
    for (std::size_t i = 0; i < taxels; ++i) {
      const bool is = trusted.mask(*m, i) > 0.5f;
      if (is && !masked[i]) {
        ++out.masks;
        for (std::size_t f = 0; f < cell_faults; ++f)
          out.of[f] += trusted.faults(*m, i).has(static_cast<CellFault>(f)) ? 1u : 0u;
      }
      masked[i] = is;
    }
  }
  out.cell_seconds += length * double(taxels);
}

/// Mean error of the force on a finger, as a share of it, with `share` of all taxels masked.
void fill_in(const std::vector<RecordedGrasp>& grasps) {
  const CellGraph graph = of_fingers();
  const FillIn mean(graph);
  std::printf("\nmasked   left out   mean of the finger   [error of the force on a finger]\n");
  for (const double share : {0.1, 0.3}) {
    Normal normal(5);
    double left_out = 0, by_mean = 0, all = 0;
    for (const RecordedGrasp& g : grasps) {
      std::array<bool, taxels> masked{};
      for (bool& x : masked) x = normal.between(0.0, 1.0) < share;
      for (std::size_t f = 0; f < g.frames.size(); f += 5) {
        const auto reading = [&](std::size_t j) { return g.frames[f][j] - g.rest[j]; };
        const auto counts = [&](std::size_t j) { return !masked[j]; };
        for (std::size_t finger = 0; finger < 5; ++finger) {
          double force = 0, error[2] = {};
          for (std::size_t i = 12 * finger; i < 12 * finger + 12; ++i) {
            force += reading(i);
            if (!masked[i]) continue;
            error[0] -= reading(i);
            error[1] += mean.filled(i, reading, counts) - reading(i);
          }
          if (force < 60) continue;  // not touched
          left_out += std::abs(error[0]), by_mean += std::abs(error[1]);
          all += force;
        }
      }
    }
    std::printf("%5.0f %%   %7.1f %%   %17.1f %%\n", 100 * share, 100 * left_out / all, 100 * by_mean / all);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t every = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 1;
  const double held = argc > 2 ? std::atof(argv[2]) : 10;
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  const auto grasps = data ? read_recorded_grasps(data) : std::vector<RecordedGrasp>{};
  if (grasps.empty()) {
    std::printf("SKINCTL_DATA_DIR holds no icub_grasp_tactile: nothing to play\n");
    return 0;
  }
  FalseMasks sum;
  std::size_t played = 0;
  for (std::size_t k = 0; k < grasps.size(); k += every > 0 ? every : 1, ++played)
    play(grasps[k], held, k + 1, sum);
  std::printf("%zu recorded grasps at 250 Hz, %.3g cell-seconds: %zu false masks", played, sum.cell_seconds,
              sum.masks);
  for (std::size_t f = 0; f < cell_faults; ++f)
    if (sum.of[f] > 0) std::printf(", %s %zu", name(static_cast<CellFault>(f)), sum.of[f]);
  std::printf("\n");
  fill_in(grasps);
  return 0;
}
