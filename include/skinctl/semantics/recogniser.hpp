// SPDX-License-Identifier: BSD-3-Clause
// The activity of a hand by a learnt tree, its beginning, and whether it has stood long enough to rely on.
#pragma once

#include "skinctl/semantics/decision_tree.hpp"
#include "skinctl/semantics/words.hpp"

SKINCTL_BEGIN_NAMESPACE

/// How many numbers features have: six bits, and six quantities behind them.
inline constexpr std::size_t feature_numbers = 12;
[[nodiscard]] inline std::array<double, feature_numbers> numbers(const Features& f) noexcept {
  const auto bit = [](bool b) { return b ? 1.0 : 0.0; };
  return {bit(f.moving), bit(f.in_hand), bit(f.squeezed), bit(f.carried), bit(f.tool), bit(f.left),
          f.speed,       f.force,        f.ratio,         f.moved,        f.elapsed,   f.near_distance};
}
/// A tree that tells activities from the numbers of features.
using ActivityTree = DecisionTree<feature_numbers, activities>;
/// An example to learn the tree from: features, and the activity that they show.
[[nodiscard]] inline Example<feature_numbers> example(const Features& f, Activity a) noexcept {
  return {numbers(f), static_cast<std::uint8_t>(a)};
}

/// An activity as recognised.
struct Recognised {
  Activity activity = Activity::unknown;
  /// Beginning of the activity: the stamp of the change of a bit that decided, else of the decision.
  Nanoseconds since{};
  bool sure = false;  ///< the activity has stood for `settle` since it was first said
  friend bool operator==(const Recognised&, const Recognised&) noexcept = default;
};

/// Says what a hand does, for a screen: the tree's word, `unknown` where the signals do not suffice, with its
/// beginning. No task depends on it.
///
/// A word is said at once. `sure` follows after `settle`: a motion is known 40 to 60 ms after it began, and
/// until then the word before it stands.
class Recogniser {
 public:
  struct Memory {
    Recognised said{};
    Nanoseconds decided{};  ///< time at which the word was first said
    Nanoseconds event{};    ///< stamp of the newest change of a feature's bit
    bool started = false;
  };

  /// Throws `ConfigurationError` unless `settle` is in [0, 10] s.
  SKINCTL_COLD explicit Recogniser(ActivityTree tree, Nanoseconds settle = 60ms)
      : tree_(std::move(tree)), settle_(settle) {
    require(settle >= 0ns && settle <= 10s, "Recogniser: settle", milliseconds(settle), "0 to 1e4 ms");
  }
  [[nodiscard]] const ActivityTree& tree() const noexcept { return tree_; }

  Recognised step(Memory& m, const Features& f) const noexcept {
    const Activity word =
        f.known ? static_cast<Activity>(tree_.classify(numbers(f)).label) : Activity::unknown;
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
  ActivityTree tree_;
  Nanoseconds settle_;
};

SKINCTL_END_NAMESPACE
