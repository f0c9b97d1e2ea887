#include "examples/packing_oranges/run_of.hpp"
#include "examples/packing_oranges/ur10e.hpp"

namespace packing {
Outcome run_ur10e(const RunSettings& settings, const Watch& watch) {
  return Run<Ur10e>(settings)(watch);
}
}  // namespace packing
