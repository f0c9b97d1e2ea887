#include "examples/packing_oranges/run_of.hpp"
#include "examples/packing_oranges/ur10e.hpp"

namespace packing {
Outcome run_ur10e(const RunSettings& settings, const Watch& watch, const Show& show) {
  return Run<Ur10e>(settings)(watch, show);
}
}  // namespace packing
