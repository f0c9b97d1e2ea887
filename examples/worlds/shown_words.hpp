// Words for what a person shows: the features of a recording, and a tree that is learnt of simulated people.
#pragma once

#include <vector>

#include "examples/worlds/demonstrations.hpp"
#include "skinctl/semantics/recogniser.hpp"

namespace skinctl::testing {

/// Calls `each(features, sample)` for every sample of the hand, whose positions have the deviation `sigma`
/// [m]. Pictures arrive 60 ms after they were taken.
template <class Each>
void each_feature(const Demonstration<>& shown, double sigma, Each&& each) {
  FeatureSettings settings;
  settings.tools = thing::tools;
  const FeatureExtractor<> extractor(settings);
  std::array<ObjectClass, 64> kinds{};
  std::copy(shown.kinds.begin(), shown.kinds.end(), kinds.begin());
  const ObjectWorld<64> world(kinds);
  auto objects = world.start();
  FeatureExtractor<>::Memory memory;
  auto picture = shown.seen.begin();
  for (const auto& x : shown.hand) {
    for (; picture != shown.seen.end() && picture->time + 60ms <= x.time; ++picture)
      static_cast<void>(world.detect(objects, *picture));
    each(extractor.step(memory, world, objects, {x.time, x.X_WH, sigma, x.force}), x);
  }
}

/// What `people` simulated people from this seed on mean in the four tasks, sampled every 20 ms.
[[nodiscard]] inline ActivityTree learnt_words(std::uint64_t seed, int people = 6) {
  std::vector<Example<feature_numbers>> examples;
  for (int i = 0; i < people; ++i) {
    auto random = seeded(seed + static_cast<std::uint64_t>(i));
    const Person who = Person::any(random);
    for (const LedTask task : {LedTask::packing, LedTask::pancake, LedTask::sandwich, LedTask::table}) {
      const LedRun run = led_run(task, who, random());
      int k = 0;
      each_feature(shown(run, {}, random()), ShownBy{}.sigma, [&](const Features& f, const auto& x) {
        if (f.known && k++ % 5 == 0) examples.push_back(example(f, run.hand.intent(seconds<double>(x.time))));
      });
    }
  }
  return ActivityTree::learn(examples);
}

}  // namespace skinctl::testing
