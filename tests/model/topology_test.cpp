#include "skinctl/model/topology.hpp"

#include <doctest/doctest.h>

#include "tests/support/robots.hpp"

using namespace skinctl;
using testing::MixedTree;

static_assert(Topology<MixedTree>);
static_assert(is_tree<MixedTree>() && is_tree<Chain<6>>() && is_tree<allegro::Tree>());
static_assert(ancestors<MixedTree>(4) == 0b000011011);
static_assert(ancestors<MixedTree>(8) == 0b110100000);
static_assert(subtree<MixedTree>(1) == 0b000011110);
static_assert(closure<MixedTree>(link_bit<2> | link_bit<6>) == 0b001100111);
static_assert(children<MixedTree, -1> == std::array<std::size_t, 2>{0, 5});
static_assert(children<MixedTree, 1> == std::array<std::size_t, 2>{2, 3});
static_assert(children<MixedTree, 8>.empty());
static_assert(all_links(64) == ~LinkMask(0) && all_links(6) == 0b111111);

namespace {
struct Backward : Chain<3> {
  static constexpr std::array<int, 3> parents = {-1, 2, 0};
};
struct Orphan : Chain<3> {
  static constexpr std::array<int, 3> parents = {-1, -2, 0};
};
}  // namespace
static_assert(!is_tree<Backward>(), "a child before its parent");
static_assert(!is_tree<Orphan>(), "no such parent");

TEST_CASE("topology: a link is among its own ancestors and in its own subtree") {
  for (std::size_t i = 0; i < MixedTree::joints; ++i) {
    CHECK(((ancestors<MixedTree>(i) >> i) & 1u) == 1);
    for (std::size_t j = 0; j < MixedTree::joints; ++j)
      CHECK(((subtree<MixedTree>(i) >> j) & 1u) == ((ancestors<MixedTree>(j) >> i) & 1u));
  }
}
