#include "skinctl/sensing/unexplained_cells.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace skinctl;

TEST_CASE(
    "Unexplained cells: frozen for 60 s, not released, not seen touched; each named once, with its reason") {
  std::vector<RestRow> rows(3);
  const auto put = [&](std::size_t i, RestCell<> cell) { RestLevel::put(rows[i / 16], i % 16, cell); };
  put(3, {100, 300, 0, 64, 0, 0});         // too early in the rows
  put(5, {12.25f, 300, 0, 60, 0, -0.7f});  // nothing known
  put(17, {90, 300, 0, -64, 0, 3.9f});     // fast
  put(18, {90, 300, 0, 64, -1.5f, 3.9f});  // being released
  put(19, {90, 300, 0, 64, 0, -3.9f});     // seen touched
  put(20, {90, 300, 0, 59.9f, 0, 0});      // not for long enough
  put(40, {7, 300, 0, 64, 0.5f, 2.5f});    // not enough evidence
  put(47, {7, 300, 0, 64, 0, 0});          // beyond the cells asked for
  std::vector<UnexplainedCell> found;
  each_unexplained(rows, 4, 43, [&](const UnexplainedCell& c) { found.push_back(c); });
  REQUIRE(found.size() == 3);
  CHECK(found[0].cell == 5);
  CHECK(found[1].cell == 17);
  CHECK(found[2].cell == 40);
  CHECK(found[1].fast);
  CHECK_FALSE(found[2].fast);
  CHECK(describe(found[0], "cell 5 of palm") ==
        "cell 5 of palm: 12.2 steps above its rest level for 60 s or more; nothing says whether it is "
        "touched or has "
        "drifted");
  CHECK(describe(found[1], "cell 17") ==
        "cell 17: 90.0 steps above its rest level for 60 s or more; something else says that it is not "
        "touched, but it "
        "rose as fast as a touch");
  CHECK(describe(found[2], "cell 40") ==
        "cell 40: 7.0 steps above its rest level for 60 s or more; there is evidence for a drift, but not "
        "enough");
}
