// What recognition and the execution of a plan cost in a cycle.
#include "bench/support/bench.hpp"
#include "examples/worlds/shown_words.hpp"
#include "skinctl/semantics/executor.hpp"
#include "skinctl/semantics/process.hpp"
#include "skinctl/semantics/resources.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// A packing that was recorded: the hand's samples, and pictures of six things.
struct Packing {
  std::vector<HandSample<>> hand;
  std::vector<Features> features;
};
const Packing& packing() {
  static const Packing all = [] {
    Packing out;
    auto random = seeded(1);
    const auto shows = shown(led_run(LedTask::packing, Person::any(random), 2), {}, 3);
    each_feature(shows, ShownBy{}.sigma, [&](const Features& f, const auto& x) {
      out.features.push_back(f);
      out.hand.push_back({x.time, x.X_WH, ShownBy{}.sigma, x.force});
    });
    return out;
  }();
  return all;
}

void features(benchmark::State& state) {
  const auto& p = packing();
  const FeatureExtractor<> extractor;
  const ObjectWorld<6> world({1, 2, 3, 4, 5, 6});
  auto objects = world.start();
  for (std::uint8_t i = 0; i < 6; ++i)
    static_cast<void>(world.detect(
        objects,
        {.object = i, .X_WO = ObjectPose<>::translation_xyz(0.1 * i, 0.2, 0), .sigma = 0.005, .time = 1ns}));
  FeatureExtractor<>::Memory m;
  std::size_t k = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    if (k == p.hand.size()) k = 0, m = {};
    benchmark::DoNotOptimize(extractor.step(m, world, objects, p.hand[k++]));
  }
}
void word(benchmark::State& state) {
  const auto& p = packing();
  const Recogniser recogniser = bench::prepared([] { return Recogniser(learnt_words(9000)); });
  Recogniser::Memory m;
  std::size_t k = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    if (k == p.features.size()) k = 0;
    benchmark::DoNotOptimize(recogniser.step(m, p.features[k++]));
  }
}
void detection(benchmark::State& state) {
  const ObjectWorld<6> world({1, 2, 3, 4, 5, 6});
  auto objects = world.start();
  std::uint8_t i = 0;
  Nanoseconds t{};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    i = i == 5 ? std::uint8_t(0) : static_cast<std::uint8_t>(i + 1);
    t += 1ms;
    benchmark::DoNotOptimize(world.detect(
        objects,
        {.object = i, .X_WO = ObjectPose<>::translation_xyz(0.1 * i, 0.2, 0), .sigma = 0.005, .time = t}));
  }
}

constexpr auto plan =
    task("take", {}, step_of<activity::Look>({.done = 1, .no = finish}),
         step_of<activity::ReachAbove>({.done = 2}), step_of<activity::Reach>({.done = 3}),
         step_of<activity::Take>({.done = 4}), step_of<activity::Put>({.place = 0, .done = 5}),
         step_of<activity::Release>({.place = 0, .done = 0}));
/// A skill that takes 100 cycles.
void execute(benchmark::State& state) {
  const auto executor = bench::prepared([] { return Executor(plan); });
  auto m = executor.start(0ns);
  StepInput in;
  int runs = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    in.now += 4ms;
    const auto out = executor.step(m, in);
    m = out.memory;
    if (out.request.kind == StepRequest::Kind::start) {
      in.skill = {out.request.ticket, SkillPhase::running, SkillFailure::none};
      runs = 0;
    } else if (++runs == 100) {
      in.skill.phase = SkillPhase::finished;
    }
    benchmark::DoNotOptimize(out);
  }
}
void share(benchmark::State& state) {
  const Resources<2, 2> shared;
  auto m = shared.start();
  std::array<PlaceRequest, 2> a{};
  a[0].wants = 0;
  a[1].wants = 0;
  Nanoseconds t{};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    t += 4ms;
    const auto out = shared.step(m, t, a);
    m = out.memory;
    benchmark::DoNotOptimize(out);
  }
}
}  // namespace

BENCHMARK(features)->Name("features of a hand among 6 objects");
BENCHMARK(detection)->Name("one detection");
BENCHMARK(word)->Name("recogniser");
BENCHMARK(execute)->Name("executor");
BENCHMARK(share)->Name("two places, two robots");
