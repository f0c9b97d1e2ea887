#include "skinctl/semantics/decision_tree.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Tree = DecisionTree<3, 3>;
using Examples = std::vector<Example<3>>;

/// 0 below a line of x, else 1 or 2 by y; the third number says nothing. A share `wrong` of the labels is
/// random.
Examples boxes(std::uint64_t seed, std::size_t n, double wrong) {
  auto random = seeded(seed);
  Examples out;
  for (std::size_t i = 0; i < n; ++i) {
    Example<3> e{{uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0)}, 0};
    e.label = e.x[0] < 0.3 ? 0 : e.x[1] < 0.6 ? 1 : 2;
    if (uniform(random, 0.0, 1.0) < wrong) e.label = static_cast<std::uint8_t>(random() % 3);
    out.push_back(e);
  }
  return out;
}
double right(const Tree& tree, const Examples& examples) {
  double n = 0;
  for (const auto& e : examples) n += tree.classify(e.x).label == e.label ? 1 : 0;
  return n / static_cast<double>(examples.size());
}
}  // namespace

TEST_CASE("DecisionTree: finds the thresholds, and no more") {
  const auto clean = boxes(1, 2000, 0);
  const auto tree = Tree::learn(clean);
  CHECK(tree.leaves() == 3);
  CHECK(right(tree, boxes(2, 5000, 0)) > 0.995);
  for (const auto& node : tree.nodes())
    if (node.above != 0) {
      CHECK(node.attribute < 2);
      CHECK(node.threshold == doctest::Approx(node.attribute == 0 ? 0.3 : 0.6).epsilon(0.02));
    }
  CHECK(tree.classify({0.1, 0.9, 0.5}).share == 1);
}

TEST_CASE("DecisionTree: wrong labels do not grow it: pruning leaves what tells") {
  const auto pruned = Tree::learn(boxes(3, 2000, 0.2));
  CHECK(pruned.leaves() < 8);
  CHECK(right(pruned, boxes(4, 5000, 0)) > 0.98);
  const auto leaf = pruned.classify({0.1, 0.5, 0.5});
  CHECK(leaf.label == 0);
  CHECK(leaf.share == doctest::Approx(0.8 + 0.2 / 3).epsilon(0.05));
  // Labels that nothing tells: the more confidence a split needs, the fewer there are.
  std::size_t leaves = 0, loose = 0;
  for (std::uint64_t seed = 10; seed < 30; ++seed) {
    const auto any = boxes(seed, 60, 1.0);
    leaves += Tree::learn(any, {.confidence = 0.1, .min_leaf = 2}).leaves();
    loose += Tree::learn(any, {.confidence = 0.5, .min_leaf = 2}).leaves();
  }
  CHECK(leaves < 60);
  CHECK(loose > leaves);
}

TEST_CASE(
    "DecisionTree: gain by hand: of two attributes with equal information the one that splits evenly wins") {
  // x0 tells the label of 8 of 8; x1 splits off one example only.
  Examples e;
  for (int i = 0; i < 40; ++i)
    e.push_back({{i % 2 == 0 ? 0.0 : 1.0, i == 1 ? 5.0 : 0.0, 0.0}, static_cast<std::uint8_t>(i % 2)});
  const auto tree = Tree::learn(e, {.min_leaf = 1});
  CHECK(tree.nodes()[0].attribute == 0);
  CHECK(tree.nodes()[0].threshold == 0.5);
  CHECK(tree.leaves() == 2);
}

TEST_CASE("DecisionTree: one label, equal examples, numbers that are none") {
  const Examples same(20, Example<3>{{1, 2, 3}, 2});
  CHECK(Tree::learn(same).leaves() == 1);
  CHECK(Tree::learn(same).classify({9, 9, 9}).label == 2);
  Examples mixed = same;
  for (std::size_t i = 0; i < 5; ++i) mixed[i].label = 1;
  CHECK(Tree::learn(mixed).leaves() == 1);  // nothing tells them apart
  CHECK(Tree::learn(mixed).classify({1, 2, 3}).share == doctest::Approx(0.75));
  const auto tree = Tree::learn(boxes(5, 500, 0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(tree.classify({nan, nan, nan}).label == 0);  // where small numbers go
  CHECK_THROWS_AS(static_cast<void>(Tree::learn({})), ConfigurationError);
  Examples bad = same;
  bad[3].x[1] = nan;
  CHECK_THROWS_AS(static_cast<void>(Tree::learn(bad)), ConfigurationError);
  bad = same;
  bad[3].label = 3;
  CHECK_THROWS_AS(static_cast<void>(Tree::learn(bad)), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(Tree::learn(same, {.confidence = 0})), ConfigurationError);
  // Levels are bounded.
  Examples stairs;
  for (int i = 0; i < 64; ++i) stairs.push_back({{double(i), 0, 0}, static_cast<std::uint8_t>(i % 2)});
  CHECK(Tree::learn(stairs, {.confidence = 0.5, .min_leaf = 1, .max_depth = 4}).nodes().size() <= 15);
}
