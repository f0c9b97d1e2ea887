// A square of cells, 30 mm apart.
#pragma once

#include <vector>

#include "skinctl/tactile/cell_graph.hpp"

namespace skinctl::testing {

/// The places of n x n cells, row by row.
inline std::vector<CellPlace> square_places(std::size_t n) {
  std::vector<CellPlace> cells(n * n);
  for (std::size_t i = 0; i < n * n; ++i) cells[i].place = {0.03 * double(i % n), 0.03 * double(i / n), 0.0};
  return cells;
}
/// Each has the eight cells around it as neighbours.
inline CellGraph square_graph(std::size_t n) {
  return CellGraph(square_places(n), 1.5);
}

}  // namespace skinctl::testing
