#include "examples/packing_oranges/run_of.hpp"

namespace packing {
Outcome run_ur5(const RunSettings& settings, const Watch& watch, const Show& show) {
  return Run<Ur5>(settings)(watch, show);
}
}  // namespace packing
