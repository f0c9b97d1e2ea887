// A page has no skin files.
#include "examples/compliant_ur5/skin.hpp"
#include "skinctl/core/contract.hpp"

namespace compliant_ur5 {

std::vector<skinctl::SkinPatch> patches_of_file(const Settings&) {
  skinctl::refuse("there are no skin files here");
}
skinctl::CellGraph graph_of_file(const Settings&) {
  skinctl::refuse("there are no skin files here");
}

}  // namespace compliant_ur5
