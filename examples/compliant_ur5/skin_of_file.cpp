#include <limits>

#include "examples/compliant_ur5/skin.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/skin_placement.hpp"
#include "skinctl/robots/ur5_links.hpp"

namespace compliant_ur5 {

using namespace skinctl;

std::vector<SkinPatch> patches_of_file(const Settings& s) {
  const SkinFile file = read_skin_file(s.skin);
  for (const SkinFile::Region& region : file.regions)
    require(!(region.force_limit < std::numeric_limits<double>::infinity()),
            ("region \"" + region.name + "\" of " + s.skin + ": force_limit").c_str(), region.force_limit,
            "none: this job has no limits of regions, see ContactSkin");
  return skinctl::skin_patches(file, place_skin<ur5::Ros2Links>(file));
}

CellGraph graph_of_file(const Settings& s) {
  const SkinFile file = read_skin_file(s.skin);
  return cell_graph(file, place_skin<ur5::Ros2Links>(file));
}

}  // namespace compliant_ur5
