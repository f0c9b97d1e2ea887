// What it costs to plan a retreat from obstacles: once a cycle, while a robot has nothing else to do.
#include "bench/support/bench.hpp"
#include "skinctl/clearance/retreat.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/ur5_clearance.hpp"

using namespace skinctl;

namespace {

constexpr std::size_t most = 8;

/// Balls at 0.3 m/s, a little beside the forearm, at `home` and poses around it.
void plan(benchmark::State& state, std::size_t obstacles) {
  const JointPosition<6> home{0.1, -1.2, 1.2, -1.0, -1.5, 0.3};
  const Retreat<ur5::Model, most> retreat(ur5::Model{}, testing::ur5_clearance<most>(), home);
  auto random = testing::seeded(1);
  std::array<JointPosition<6>, 64> poses;
  std::array<Surroundings<most, Base, double>, 64> around;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (std::size_t i = 0; i < 6; ++i) poses[k][i] = home[i] + testing::uniform(random, -0.3, 0.3);
    const auto X = link_poses(ur5::Model{}, poses[k]);
    for (std::size_t o = 0; o < obstacles; ++o) {
      const Xyz<double> aside{testing::uniform(random, -0.2, 0.2), testing::uniform(random, -0.2, 0.2), 0.2};
      const Xyz<double> at = X.get<2>().origin() + aside;
      around[k].add({{at, at, 0.04}, 0.3});
    }
  }
  std::size_t k = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(retreat(poses[k], around[k]));
    k = (k + 1) % poses.size();
  }
}

const int registered = [] {
  for (const std::size_t obstacles : {0u, 1u, 2u, 8u})
    benchmark::RegisterBenchmark(
        ("tactile/retreat/ur5-obstacles-" + std::to_string(obstacles) + "/skinctl/double").c_str(),
        [=](benchmark::State& s) { plan(s, obstacles); });
  return 0;
}();

}  // namespace
