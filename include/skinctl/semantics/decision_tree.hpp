// SPDX-License-Identifier: BSD-3-Clause
// A decision tree over numbers: C4.5, learnt from labelled examples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An example to learn from: `A` numbers, and the label of their class.
template <std::size_t A>
struct Example {
  std::array<double, A> x{};
  std::uint8_t label = 0;
};

/// Settings of the learning of a tree.
struct TreeSettings {
  double confidence = 0.25;    ///< confidence of the pessimistic pruning; smaller: prunes more
  std::size_t min_leaf = 0;    ///< fewest examples on a side of a split; 0: max(5, all / 400)
  std::size_t max_depth = 24;  ///< largest number of levels; `classify` visits no more nodes
};

/// A decision tree over numbers, learnt by C4.5 (Quinlan 1993): a node splits at the threshold with the
/// largest ratio of gain to split information among those whose gain reaches the mean; the gain of a
/// threshold pays `log2(distinct) / n` for its choice. A subtree whose pessimistic error (upper limit at
/// `confidence`) is not below that of a leaf becomes one.
///
/// Learning allocates, and throws `ConfigurationError` for settings out of range, no examples, a label that
/// is no class or a number that is not finite. Classifying does neither; it visits at most `max_depth` nodes;
/// a NaN goes where small numbers go.
///
/// @tparam A  how many numbers an example has. @tparam Classes how many labels there are, 0 to `Classes - 1`.
template <std::size_t A, std::size_t Classes>
class DecisionTree {
  static_assert(A > 0 && A < 255 && Classes > 1 && Classes <= 64);
  using Counts = std::array<double, Classes>;

 public:
  /// A node of the tree. A leaf has no children: its `above` is 0.
  struct Node {
    double threshold = 0;
    std::uint32_t above = 0;  ///< node where the number exceeds the threshold; the other one is the next node
    float share = 1;          ///< share of the node's examples that have its label
    std::uint8_t attribute = 0;
    std::uint8_t label = 0;
  };
  /// The label of an example, and the share of the leaf's examples that had it.
  struct Answer {
    std::uint8_t label = 0;
    double share = 0;
  };

  [[nodiscard]] SKINCTL_COLD static DecisionTree learn(std::span<const Example<A>> examples,
                                                       const TreeSettings& settings = {}) {
    require(settings.confidence > 0 && settings.confidence <= 0.5, "DecisionTree: confidence",
            settings.confidence, "> 0, <= 0.5");
    require(settings.max_depth >= 1 && settings.max_depth <= 64, "DecisionTree: max_depth",
            static_cast<double>(settings.max_depth), "1 to 64");
    require(!examples.empty() && examples.size() < 1u << 31, "DecisionTree: examples",
            static_cast<double>(examples.size()), "1 to 2^31");
    for (const auto& e : examples) {
      require(e.label < Classes, "DecisionTree: label", e.label, "below the number of classes");
      for (const double x : e.x) require(x - x == 0, "DecisionTree: attribute", x, "finite");
    }
    DecisionTree tree;
    Learner learner{examples, settings, {}, {}, tree.nodes_};
    if (learner.settings.min_leaf == 0)
      learner.settings.min_leaf = std::max<std::size_t>(5, examples.size() / 400);
    learner.order.resize(examples.size());
    for (std::size_t i = 0; i < examples.size(); ++i) learner.order[i] = static_cast<std::uint32_t>(i);
    learner.z = learner.quantile();
    static_cast<void>(learner.grow(0, examples.size(), 0));
    return tree;
  }

  [[nodiscard]] Answer classify(const std::array<double, A>& x) const noexcept {
    std::size_t i = 0;
    while (nodes_[i].above != 0) i = x[nodes_[i].attribute] > nodes_[i].threshold ? nodes_[i].above : i + 1;
    return {nodes_[i].label, nodes_[i].share};
  }
  [[nodiscard]] const std::vector<Node>& nodes() const noexcept { return nodes_; }
  [[nodiscard]] std::size_t leaves() const noexcept { return (nodes_.size() + 1) / 2; }

 private:
  DecisionTree() = default;

  struct Split {
    double gain = 0, ratio = 0, threshold = 0;
  };
  struct Learner {
    std::span<const Example<A>> examples;
    TreeSettings settings;
    std::vector<std::uint32_t> order;
    std::vector<std::pair<double, std::uint8_t>> column;
    std::vector<Node>& nodes;
    double z = 0;

    static double log2_or_0(double x) { return x > 0 ? std::log2(x) : 0; }
    static double entropy(const Counts& counts, double n) {
      double bits = 0;
      for (const double c : counts)
        if (c > 0) bits -= c / n * std::log2(c / n);
      return bits;
    }
    /// The deviations from the mean beyond which a share `confidence` of a normal distribution lies, above
    /// it.
    [[nodiscard]] double quantile() const {
      double low = 0, high = 10;
      for (int i = 0; i < 60; ++i) {
        const double mid = 0.5 * (low + high);
        (0.5 * std::erfc(mid / std::sqrt(2.0)) > settings.confidence ? low : high) = mid;
      }
      return low;
    }
    /// Upper limit of the errors among `n` examples of which `e` are wrong (Wilson's, exact for none wrong).
    [[nodiscard]] double pessimistic(double n, double e) const {
      if (e < 0.5) return n * (1 - std::exp(std::log(settings.confidence) / n));
      const double f = std::min(1.0, (e + 0.5) / n), z2 = z * z;
      return n * (f + z2 / (2 * n) + z * std::sqrt(std::max(0.0, f / n - f * f / n + z2 / (4 * n * n)))) /
             (1 + z2 / n);
    }
    /// The best threshold of attribute `a` for the examples from `first` to `last`.
    [[nodiscard]] Split best(std::size_t a, std::size_t first, std::size_t last, const Counts& all) {
      column.clear();
      for (std::size_t i = first; i < last; ++i) {
        const auto& e = examples[order[i]];
        column.emplace_back(e.x[a], e.label);
      }
      std::sort(column.begin(), column.end());
      const double n = static_cast<double>(column.size()), whole = entropy(all, n);
      Counts below{};
      Split split;
      double distinct = 1;
      for (std::size_t i = 0; i + 1 < column.size(); ++i) {
        ++below[column[i].second];
        if (!(column[i].first < column[i + 1].first)) continue;
        ++distinct;
        if (i + 1 < settings.min_leaf || column.size() - i - 1 < settings.min_leaf) continue;
        Counts above{};
        for (std::size_t c = 0; c < Classes; ++c) above[c] = all[c] - below[c];
        const double m = static_cast<double>(i + 1);
        const double gain = whole - m / n * entropy(below, m) - (n - m) / n * entropy(above, n - m);
        if (gain > split.gain) {
          const double p = m / n;
          const double middle = 0.5 * column[i].first + 0.5 * column[i + 1].first;
          split = {gain, -p * std::log2(p) - (1 - p) * std::log2(1 - p),
                   middle < column[i + 1].first ? middle : column[i].first};
        }
      }
      const double information = split.ratio;
      split.gain -= log2_or_0(distinct - 1) / n;
      split.ratio = split.gain > 0 && information > 0 ? split.gain / information : 0;
      return split;
    }
    /// Appends the tree of the examples from `first` to `last`; returns its pessimistic errors.
    double grow(std::size_t first, std::size_t last, std::size_t depth) {
      Counts all{};
      for (std::size_t i = first; i < last; ++i) ++all[examples[order[i]].label];
      const double n = static_cast<double>(last - first);
      const auto most = std::max_element(all.begin(), all.end());
      Node leaf;
      leaf.label = static_cast<std::uint8_t>(most - all.begin());
      leaf.share = static_cast<float>(*most / n);
      const std::size_t here = nodes.size();
      nodes.push_back(leaf);
      const double wrong = pessimistic(n, n - *most);
      if (*most == n || last - first < 2 * settings.min_leaf || depth + 1 >= settings.max_depth) return wrong;

      std::array<Split, A> splits;
      double sum = 0;
      std::size_t useful = 0;
      for (std::size_t a = 0; a < A; ++a) {
        splits[a] = best(a, first, last, all);
        if (splits[a].gain > 0) sum += splits[a].gain, ++useful;
      }
      if (useful == 0) return wrong;
      const double mean = sum / static_cast<double>(useful) - 1e-3;
      std::size_t chosen = A;
      for (std::size_t a = 0; a < A; ++a)
        if (splits[a].gain > 0 && splits[a].gain >= mean &&
            (chosen == A || splits[a].ratio > splits[chosen].ratio))
          chosen = a;
      const double threshold = splits[chosen].threshold;
      const auto from = order.begin() + static_cast<std::ptrdiff_t>(first);
      const auto middle =
          std::partition(from, order.begin() + static_cast<std::ptrdiff_t>(last),
                         [&](std::uint32_t i) { return !(examples[i].x[chosen] > threshold); });
      const std::size_t cut = static_cast<std::size_t>(middle - order.begin());
      double errors = grow(first, cut, depth + 1);
      const auto above = static_cast<std::uint32_t>(nodes.size());
      errors += grow(cut, last, depth + 1);
      if (errors >= wrong - 0.1) {
        nodes.resize(here + 1);
        return wrong;
      }
      nodes[here].attribute = static_cast<std::uint8_t>(chosen);
      nodes[here].threshold = threshold;
      nodes[here].above = above;
      return errors;
    }
  };

  std::vector<Node> nodes_;
};

SKINCTL_END_NAMESPACE
