// Plays a recording to a recogniser, cycle by cycle.
#pragma once

#include "examples/recognise/recording.hpp"
#include "skinctl/semantics/intent_rules.hpp"

namespace recognise {

/// What came out of a recording.
struct Outcome {
  std::vector<skinctl::testing::Said> said;        ///< by `Rules`
  std::vector<skinctl::testing::Said> said_meant;  ///< by `IntentRules`
  /// `Rules` against the labels by definition, `IntentRules` against what was meant.
  skinctl::testing::Score by_definition, by_intent;
  bool labelled = false;  ///< the recording says what was meant
};

/// Calls `each(line, recognised, meant, features)` for every line, with the words of `Rules` and `IntentRules`. Pictures arrive 60 ms after they were taken.
template <class Each>
Outcome play(const Recording& recording, Each&& each) {
  using namespace skinctl;
  using namespace skinctl::testing;
  FeatureSettings settings;
  settings.tools = thing::tools;
  const FeatureExtractor<> extractor(settings);
  const Recogniser<> recogniser;
  const Recogniser<IntentRules> meaning;
  std::array<ObjectClass, led_things> kinds{};
  std::copy(recording.kinds.begin(), recording.kinds.end(), kinds.begin());
  const ObjectWorld<led_things> world(kinds);
  auto objects = world.start();
  FeatureExtractor<>::Memory memory;
  Recogniser<>::Memory words;
  Recogniser<IntentRules>::Memory meanings;
  Outcome out;
  Words meant, defined;
  std::size_t pictures = 0;
  for (const Line& l : recording.lines) {
    for (; pictures < recording.seen.size() && recording.seen[pictures].time + 0.06 <= l.time; ++pictures) {
      const Seen& s = recording.seen[pictures];
      static_cast<void>(world.detect(objects, {.object = s.thing,
                                               .X_WO = ObjectPose<>::translation_xyz(s.p.x, s.p.y, s.p.z),
                                               .sigma = 0.005,
                                               .time = nanoseconds(s.time) + 1ns}));
    }
    const HandSample<> hand{nanoseconds(l.time) + 1ns,
                            Transform<World, Tool>::translation_xyz(l.p.x, l.p.y, l.p.z), 0.0002, l.force};
    const auto features = extractor.step(memory, world, objects, hand);
    const auto r = recogniser.step(words, features);
    const auto m = meaning.step(meanings, features);
    const auto note = [&l](std::vector<Said>& said, const Recognised& word) {
      if (said.empty() || said.back().word != word.activity)
        said.push_back({l.time, seconds<double>(word.since), word.activity});
    };
    note(out.said, r);
    note(out.said_meant, m);
    say(meant, l.time, l.meant);
    say(defined, l.time, l.defined);
    each(l, r, m, features);
  }
  const double lasts = recording.lines.back().time;
  out.labelled = meant.size() > 1 || meant.front().word != Activity::unknown;
  if (out.labelled) {
    out.by_intent = compare(out.said_meant, meant, lasts);
    out.by_definition = compare(out.said, defined, lasts);
  }
  return out;
}

}  // namespace recognise
