// Plays a recording to a recogniser, cycle by cycle: words for a screen while somebody demonstrates.
#pragma once

#include "examples/teach/recording.hpp"
#include "examples/worlds/led_tasks.hpp"
#include "skinctl/semantics/intent_rules.hpp"
#include "skinctl/semantics/recogniser.hpp"

namespace teach {

inline constexpr skinctl::ToolUse uses[] = {
    {skinctl::testing::thing::knife, skinctl::testing::thing::bread, "cut"},
    {skinctl::testing::thing::bottle, skinctl::testing::thing::pan, "pour"},
    {skinctl::testing::thing::spatula, skinctl::testing::thing::pan, "turn over"}};

/// Calls `each(time, word, since)` for every new word by what the person means. Pictures arrive 60 ms after
/// they were taken.
template <class Each>
void play(const Recording& recording, Each&& each) {
  using namespace skinctl;
  FeatureSettings settings;
  settings.tools = testing::thing::tools;
  const FeatureExtractor<> extractor(settings);
  const Recogniser<IntentRules> recogniser;
  std::array<ObjectClass, 64> kinds{};
  std::copy(recording.shown.kinds.begin(), recording.shown.kinds.end(), kinds.begin());
  const ObjectWorld<64> world(kinds);
  auto objects = world.start();
  FeatureExtractor<>::Memory memory;
  Recogniser<IntentRules>::Memory words;
  auto picture = recording.shown.seen.begin();
  Activity last = Activity::unknown;
  for (const auto& x : recording.shown.hand) {
    for (; picture != recording.shown.seen.end() && picture->time + 60ms <= x.time; ++picture)
      static_cast<void>(world.detect(objects, *picture));
    const auto f = extractor.step(memory, world, objects, {x.time, x.X_WH, 0.0002, x.force});
    const auto r = recogniser.step(words, f);
    const bool is_new = r.activity != last;
    last = r.activity;
    each(x.time,
         is_new ? (r.activity == Activity::use ? describe_use(f, uses) : describe(r.activity)) : nullptr,
         r.since);
  }
}

}  // namespace teach
