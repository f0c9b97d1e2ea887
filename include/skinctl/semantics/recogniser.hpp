// SPDX-License-Identifier: BSD-3-Clause
// The activity of a hand, since when, and whether it has stood long enough to be relied upon.
#pragma once

#include "skinctl/semantics/rules.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An activity as recognised.
struct Recognised {
  Activity activity = Activity::unknown;
  /// Beginning of the activity: the stamp of the change of a bit that decided, else of the decision.
  Nanoseconds since{};
  bool sure = false;  ///< the activity has stood for `settle` since it was first said
  friend bool operator==(const Recognised&, const Recognised&) noexcept = default;
};

/// Says what a hand does: the word of a classifier of features, `Rules` or a `DecisionTree`, with its
/// beginning.
///
/// A word is said at once. `sure` follows after `settle`: a motion is known 40 to 60 ms after it began, and
/// until then the word before it stands.
template <class Classifier = Rules>
class Recogniser {
 public:
  struct Memory {
    Recognised said{};
    Nanoseconds decided{};  ///< time at which the word was first said
    Nanoseconds event{};    ///< newest change of a bit
    bool started = false;
  };

  /// Throws `ConfigurationError` unless `settle` is in [0, 10] s.
  SKINCTL_COLD explicit Recogniser(const Classifier& classifier = {}, Nanoseconds settle = 60ms)
      : classifier_(classifier), settle_(settle) {
    require(settle >= 0ns && settle <= 10s, "Recogniser: settle", milliseconds(settle), "0 to 1e4 ms");
  }
  [[nodiscard]] const Classifier& classifier() const noexcept { return classifier_; }

  Recognised step(Memory& m, const Features& f) const noexcept {
    const Activity word = classifier_(f);
    if (!m.started || word != m.said.activity) {
      // A bit that changed now dates the word, but not before the word that it ends.
      const bool by_event = word != Activity::unknown && f.event != m.event && f.event <= f.time;
      const Nanoseconds since = by_event ? f.event : f.time;
      m.said = {word, m.started && since < m.said.since ? m.said.since : since, false};
      m.decided = f.time;
      m.started = true;
    }
    m.event = f.event;
    m.said.sure = word != Activity::unknown && f.time - m.decided >= settle_;
    return m.said;
  }

 private:
  Classifier classifier_;
  Nanoseconds settle_;
};

SKINCTL_END_NAMESPACE
