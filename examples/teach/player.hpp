// Plays a recording to a recogniser, cycle by cycle: words for a screen while somebody demonstrates.
#pragma once

#include "examples/teach/recording.hpp"
#include "examples/worlds/shown_words.hpp"

namespace teach {

inline constexpr skinctl::ToolUse uses[] = {
    {skinctl::testing::thing::knife, skinctl::testing::thing::bread, "cut"},
    {skinctl::testing::thing::bottle, skinctl::testing::thing::pan, "pour"},
    {skinctl::testing::thing::spatula, skinctl::testing::thing::pan, "turn over"}};

/// Calls `each(time, word, since)` for every sample, with a word where it is new: by a tree that has learnt
/// the intent of other people.
template <class Each>
void play(const Recording& recording, Each&& each) {
  using namespace skinctl;
  const Recogniser recogniser(testing::learnt_words(9000));
  Recogniser::Memory words;
  Activity last = Activity::unknown;
  testing::each_feature(recording.shown, 0.0002, [&](const Features& f, const auto& x) {
    const auto r = recogniser.step(words, f);
    const bool is_new = r.activity != last;
    last = r.activity;
    each(x.time,
         is_new ? (r.activity == Activity::use ? describe_use(f, uses) : describe(r.activity)) : nullptr,
         r.since);
  });
}

}  // namespace teach
