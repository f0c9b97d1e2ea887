// Promise: a place that no cell near it feels stops the main job, which says where, however many cells
// report
// Tried: 25 neighbours silent: at rest before the finger comes, exit code 4; 26 single ones: it goes on.
// Also: `tactile/trusted_skin_test.cpp`, `limits/skin_watch_test.cpp`,
// `examples/compliant_ur5/tests/main_job_test.cpp`

#include "skinctl/tactile/cell_graph.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Index = CellGraph::Index;

bool lists_itself(const CellGraph& graph) {
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (const Index j : graph.neighbours(i))
      if (j == i || !graph.joined(j, i)) return true;
  return false;
}

/// A flat hexagonal lattice with the given pitch, facing along z.
std::vector<CellPlace> lattice(std::size_t rows, std::size_t columns, double pitch) {
  std::vector<CellPlace> cells;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c)
      cells.push_back({0, 0, {pitch * (double(c) + 0.5 * double(r % 2)), pitch * 0.866 * double(r), 0.0}});
  return cells;
}

}  // namespace

TEST_CASE("CellGraph: an inner cell of a hexagonal lattice has its six neighbours") {
  const CellGraph graph(lattice(7, 9, 0.028));
  REQUIRE(graph.size() == 63);
  for (std::size_t r = 1; r < 6; ++r)
    for (std::size_t c = 1; c < 8; ++c) {
      const std::size_t i = 9 * r + c, up = i + 9, down = i - 9, shift = r % 2;
      CAPTURE(i);
      CHECK(graph.neighbours(i).size() == 6);
      for (const std::size_t j : {i - 1, i + 1, up + shift, up + shift - 1, down + shift, down + shift - 1})
        CHECK(graph.joined(i, j));
    }
  CHECK(graph.neighbours(0).size() == 2);
  CHECK(graph.edges() == 7 * 8 + 6 * 17);  // along rows, between rows
}

TEST_CASE("CellGraph: the pairs are those of the definition, pair by pair") {
  auto rng = seeded(11);
  for (int round = 0; round < 12; ++round) {
    std::vector<CellPlace> cells;
    const std::size_t count = 2 + std::size_t(round) * 20;
    for (std::size_t k = 0; k < count; ++k) {
      const auto at = [&] { return uniform(rng, -0.1, 0.1); };
      const std::size_t link = k % 2, patch = k % 2 + 2 * (k % 3 == 0);
      cells.push_back({link, patch, {at(), at(), at()}, {0.0, 0.0, k % 5 == 0 ? -1.0 : 1.0}});
    }
    const CellGraph graph(cells, 2);
    const auto distance = [&](std::size_t i, std::size_t j) {
      const auto way = cells[i].place - cells[j].place;
      return std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
    };
    const auto facing = [&](std::size_t i, std::size_t j) { return cells[i].normal.z == cells[j].normal.z; };
    const auto pitch = [&](std::size_t patch) {
      std::vector<double> nearest;
      for (std::size_t i = 0; i < count; ++i) {
        if (cells[i].patch != patch) continue;
        double least = INFINITY;
        for (std::size_t j = 0; j < count; ++j)
          if (j != i && cells[j].patch == patch && facing(i, j)) least = std::min(least, distance(i, j));
        nearest.push_back(least);
      }
      std::sort(nearest.begin(), nearest.end());
      return nearest.empty() ? double(INFINITY) : nearest[nearest.size() / 2];
    };
    std::vector<double> pitches;
    for (std::size_t k = 0; k < 4; ++k) pitches.push_back(pitch(k));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) {
        const double a = pitches[cells[i].patch], b = pitches[cells[j].patch];
        double reach = std::isinf(a) || std::isinf(b) ? 2 * std::min(a, b) : a + b;
        if (std::isinf(reach)) reach = 2 * *std::min_element(pitches.begin(), pitches.end());
        if (std::isinf(reach)) reach = -1;
        const bool close =
            i != j && cells[i].link == cells[j].link && facing(i, j) && distance(i, j) <= reach;
        CAPTURE(round);
        CAPTURE(i);
        CAPTURE(j);
        CHECK(graph.joined(i, j) == close);
      }
    CHECK_FALSE(lists_itself(graph));
  }
}

TEST_CASE("CellGraph: patches of one cell side by side are joined by the pitch of another patch") {
  auto cells = lattice(3, 3, 0.028);
  for (const double x : {0.0, 0.028, 0.056, 0.2}) {
    const std::size_t patch = cells.back().patch + 1;
    cells.push_back({1, patch, {x, 0.0, 0.0}});
  }
  const CellGraph graph(cells);
  CHECK(graph.joined(9, 10));
  CHECK(graph.joined(10, 11));
  CHECK_FALSE(graph.joined(9, 11));
  CHECK(graph.neighbours(12).empty());
  CHECK_FALSE(lists_itself(graph));
  cells.erase(cells.begin(), cells.begin() + 9);  // no patch has a pitch
  CHECK(CellGraph(cells).edges() == 0);
}

TEST_CASE("CellGraph: a UR5's cells are joined within their link, and to all of its cells") {
  const CellGraph graphs[] = {CellGraph(cell_places(ur5::skin_patches<260>())),
                              CellGraph(cell_places(ur5::skin_patches<1260>()))};
  for (const CellGraph& graph : graphs) {
    const std::size_t cells = &graph == graphs ? 260 : 1260;
    CAPTURE(cells);
    CHECK(graph.size() == cells);
    CHECK_FALSE(lists_itself(graph));
    // Flooded from any cell, a link is covered and nothing else.
    const auto share = cells == 260 ? ur5::skin_cells<260> : ur5::skin_cells<1260>;
    std::size_t first = 0;
    for (const std::size_t count : share) {
      std::vector<bool> seen(cells);
      std::vector<std::size_t> open{first};
      seen[first] = true;
      std::size_t found = 1;
      while (!open.empty()) {
        const std::size_t i = open.back();
        open.pop_back();
        for (const Index j : graph.neighbours(i))
          if (!seen[j]) seen[j] = true, ++found, open.push_back(j);
      }
      CHECK(found == count);
      first += count;
    }
  }
}

TEST_CASE("CellGraph: the two sides of a plate are not joined, its edge is") {
  auto cells = lattice(3, 3, 0.02);
  for (CellPlace c : lattice(3, 3, 0.02)) {
    c.place.z = -0.002, c.normal = {0.0, 0.0, -1.0};
    cells.push_back(c);
  }
  cells.push_back({0, 0, {-0.01, 0.0, -0.001}, {-1.0, 0.0, 0.0}});
  const CellGraph graph(cells);
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t j = 9; j < 18; ++j) CHECK_FALSE(graph.joined(i, j));
  CHECK(graph.joined(0, 18));
  CHECK(graph.joined(9, 18));
}

TEST_CASE("CellGraph: lists are taken as they are, or refused with the number") {
  const CellGraph graph(std::vector<std::vector<Index>>{{2, 1}, {0}, {0}, {}});
  CHECK(graph.size() == 4);
  CHECK(graph.edges() == 2);
  CHECK(graph.neighbours(0)[0] == 1);
  CHECK(graph.neighbours(3).empty());
  CHECK(CellGraph(5).size() == 5);
  CHECK(CellGraph(5).neighbours(4).empty());
  CHECK(CellGraph().size() == 0);
  using Lists = std::vector<std::vector<Index>>;
  CHECK_THROWS_AS(CellGraph(Lists{{4}, {0}}), ConfigurationError);
  CHECK_THROWS_AS(CellGraph(Lists{{0}}), ConfigurationError);
  CHECK_THROWS_AS(CellGraph(Lists{{1, 1}, {0}}), ConfigurationError);
  CHECK_THROWS_AS(CellGraph(Lists{{1}, {}}), ConfigurationError);
  CHECK_THROWS_AS(CellGraph(lattice(2, 2, 0.01), 0), ConfigurationError);
  auto broken = lattice(2, 2, 0.01);
  broken[1].place.y = NAN;
  CHECK_THROWS_AS(CellGraph(broken, 1.3), ConfigurationError);
}
