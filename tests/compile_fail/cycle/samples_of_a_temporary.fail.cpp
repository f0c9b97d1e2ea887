// expect: input.samples = poll\(\).*keep them in a variable
#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

std::vector<CellSample> poll();

int main() {
  CycleInput<6> input;
#ifdef SKINCTL_RIGHT
  const auto samples = poll();
  input.samples = samples;
#else
  input.samples = poll();
#endif
}
