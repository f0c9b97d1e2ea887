// Cells of the simulated robot from a skin file.
#include "skinctl/io/skin_file.hpp"

#include "examples/simulated_ur5/scenario.hpp"
#include "skinctl/io/skin_placement.hpp"
#include "skinctl/robots/ur5_links.hpp"

namespace simulated_ur5 {

std::vector<SkinCell> read_skin_cells(const std::string& file) {
  std::vector<SkinCell> out;
  const auto vector = [](const skinctl::Xyz<double>& v) { return Vec3{v.x, v.y, v.z}; };
  for (const auto& patch : skinctl::place_skin<skinctl::ur5::Ros2Links>(skinctl::read_skin_file(file)))
    for (const auto& c : patch.cells)
      out.push_back(
          {c.id, patch.link, vector(c.X_LC.origin()), vector(c.X_LC.axis_z()), vector(c.X_LC.axes().x)});
  return out;
}

}  // namespace simulated_ur5
