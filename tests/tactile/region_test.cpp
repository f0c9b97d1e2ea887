#include "skinctl/tactile/region.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace skinctl;

TEST_CASE("Regions: by name and by number") {
  const Regions none, two{{.name = "palm", .cells = {1, 2}}, {.name = "wrist", .cells = {2}, .weight = 3}};
  CHECK(none.size() == 0);
  CHECK(two.size() == 2);
  CHECK(two.find("wrist") == 1);
  CHECK(two.find("knee") == 2);
  CHECK(two.mask("palm") == 1);
  CHECK(two.mask("wrist") == 2);
  CHECK(two[1].weight == 3);
  CHECK(std::isinf(two[0].force_limit));
}

TEST_CASE("Regions: what is no region is refused") {
  CHECK_THROWS_AS((Regions{{.name = "", .cells = {1}}}), ConfigurationError);
  CHECK_THROWS_AS((Regions{{.name = "a", .cells = {1}}, {.name = "a", .cells = {2}}}), ConfigurationError);
  CHECK_THROWS_AS((Regions{{.name = "a", .cells = {}}}), ConfigurationError);
  CHECK_THROWS_AS((Regions{{.name = "a", .cells = {1}, .weight = 0}}), ConfigurationError);
  CHECK_THROWS_AS((Regions{{.name = "a", .cells = {1}, .weight = NAN}}), ConfigurationError);
  CHECK_THROWS_AS((Regions{{.name = "a", .cells = {1}, .force_limit = 0}}), ConfigurationError);
  CHECK_THROWS_AS((Regions{{.name = "a", .cells = {1}, .force_limit = NAN}}), ConfigurationError);
  std::vector<Region> many;
  for (int k = 0; k < 33; ++k) many.push_back({.name = std::to_string(k), .cells = {1}});
  CHECK_THROWS_AS((Regions(many)), ConfigurationError);
}
