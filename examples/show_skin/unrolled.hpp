// A patch of skin laid flat, so that its cells have rows and columns.
#pragma once

#include <cstddef>
#include <vector>

#include "skinctl/io/skin_contents.hpp"

namespace show_skin {

/// Where a cell stands on a grid of characters.
struct Place {
  int row = 0, column = 0;
};
struct Layout {
  std::vector<Place> cells;  ///< in the order of the patch
  int rows = 0, columns = 0;
};

/// Cells of a patch on a plane or around an axis, half a pitch a column and a pitch a row; no two have the
/// same place. A patch whose normals turn by more than 30 degrees is unrolled around the axis to which they
/// are square.
Layout unrolled(const skinctl::SkinFile::Patch& patch);

}  // namespace show_skin
