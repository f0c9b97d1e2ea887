// How long a cycle takes at worst: `worst_case [cycles]`. Ten million cycles of a UR5 with 260 cells that
// reaches and is touched, without and with a governor; stage by stage, and the slowest one run again.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "skinctl/hardware/histogram.hpp"
#include "skinctl/hardware/scheduling.hpp"
#include "skinctl/hardware/stopwatch.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::test;

namespace {

void row(const char* name, const Histogram& h) {
  std::printf("%-9s %8.0f", name, h.mean());
  for (const double p : {0.5, 0.99, 0.999, 0.9999, 0.99999})
    std::printf(" %9lld", (long long)h.percentile(p));
  std::printf(" %10lld\n", (long long)h.max());
}

template <class Scene>
void study(const char* name, const Scene& scene, long cycles) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  const auto before = std::make_unique<typename Scene::Memory>(),
             worst_memory = std::make_unique<typename Scene::Memory>();
  typename Scene::Input worst_input;
  std::array<CellSample, 16> worst_samples;
  State<6> state;
  state.q = home_position();
  scene.start(*memory, state);
  oracle::Random random(1);
  std::array<Histogram, stage_count> stages;
  Histogram whole;
  std::array<CellSample, 16> samples;
  double sum = 0;
  for (long k = 1; k <= cycles; ++k) {
    typename Scene::Input input;
    input.now = k * 8_ms;
    input.measured = state;
    input.measured.time = input.now;
    for (auto& s : samples)
      s = {.time = input.now - 1_us * random.index(8000),
           .cell = static_cast<std::uint32_t>(1 + random.index(260)),
           .force = {static_cast<float>(random.index(3) == 0 ? random.uniform(0, 0.3) : 0), 0, 0}};
    input.samples = samples;
    if (random.index(2000) == 0) {
      input.has_goal = true;
      for (auto& x : input.goal.q_g) x = random.uniform(-1.5, 1.5);
      input.goal.duration = nanoseconds(random.uniform(2, 8));
    }
    std::memcpy(static_cast<void*>(before.get()), memory.get(), sizeof *memory);
    Stopwatch watch;
    const auto out = scene.step(*memory, input, watch);
    for (std::size_t s = 0; s < stage_count; ++s) stages[s].record(watch[static_cast<Stage>(s)]);
    if (watch.total() > whole.max() && k > 1000) {
      *worst_memory = *before;
      worst_input = input;
      worst_samples = samples;
    }
    if (k > 1000) whole.record(watch.total());
    state.q = out.command.position;
    state.dq = out.command.velocity;
    sum += state.q[0];
  }
  std::printf("\n%s, %ld cycles, ns\n%-9s %8s %9s %9s %9s %9s %9s %10s\n", name, cycles, "stage", "mean",
              "p50", "p99", "p99.9", "p99.99", "p99.999", "worst");
  for (std::size_t s = 0; s < stage_count; ++s) row(skinctl::name(static_cast<Stage>(s)), stages[s]);
  row("whole", whole);
  worst_input.samples = worst_samples;
  Histogram again;
  for (int k = 0; k < 1000; ++k) {
    *memory = *worst_memory;
    Stopwatch watch;
    sum += scene.step(*memory, worst_input, watch).command.position[0];
    again.record(watch.total());
  }
  std::printf(
      "the worst cycle, from its memory and input, 1000 times again: median %lld, worst %lld (checksum %g)\n",
      (long long)again.percentile(0.5), (long long)again.max(), sum);
}

}  // namespace

int main(int argc, char** argv) {
  const long cycles = argc > 1 ? std::atol(argv[1]) : 10'000'000;
  std::printf("%s", request_real_time().report.c_str());
  const auto plain = reaching_scene();
  study("without governor", plain, cycles);
  const auto limits = ur5_test_limits<double>();
  LinkContact<2> contact{
      .region = {.force = 100, .blow = 200, .first = 0.5, .stiffness = 5e4, .mass = 4, .power = 80},
      .reach = 0.5,
      .reaction = 0.02};
  const auto governor =
      make_governor(limits, contact_limits(ur5::Model{}, contact),
                    ToolSpeed<ur5::Model, 5>(ur5::Model{}, limits, {.speed = 1, .reach = 1.3}),
                    JerkLimits<6>(limits, JointJerk<6>::constant(500)));
  study("with contact limits, tool speed and jerk",
        Cycle(plain.resolver(), plain.law(), plain.skin(), plain.guard(), governor), cycles);
}
