// SPDX-License-Identifier: BSD-3-Clause
// A decision tree that reads features and says an activity: for a `Recogniser`, beside the rules.
#pragma once

#include "skinctl/semantics/decision_tree.hpp"
#include "skinctl/semantics/rules.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The features as numbers: the six bits, and what is behind them.
inline constexpr std::size_t feature_numbers = 12;
[[nodiscard]] inline std::array<double, feature_numbers> numbers(const Features& f) noexcept {
  const auto bit = [](bool b) { return b ? 1.0 : 0.0; };
  return {bit(f.moving), bit(f.in_hand), bit(f.squeezed), bit(f.carried), bit(f.tool), bit(f.left),
          f.speed,       f.force,        f.ratio,         f.moved,        f.elapsed,   f.near_distance};
}

/// An activity by a learnt tree; `unknown` where the signals do not suffice.
class ActivityTree {
 public:
  using Tree = DecisionTree<feature_numbers, activities>;
  explicit ActivityTree(Tree tree) noexcept : tree_(std::move(tree)) {}

  [[nodiscard]] Activity operator()(const Features& f) const noexcept {
    return f.known ? static_cast<Activity>(tree_.classify(numbers(f)).label) : Activity::unknown;
  }
  [[nodiscard]] const Tree& tree() const noexcept { return tree_; }

 private:
  Tree tree_;
};

/// An example for `ActivityTree::Tree::learn`.
[[nodiscard]] inline Example<feature_numbers> example(const Features& f, Activity a) noexcept {
  return {numbers(f), static_cast<std::uint8_t>(a)};
}

SKINCTL_END_NAMESPACE
