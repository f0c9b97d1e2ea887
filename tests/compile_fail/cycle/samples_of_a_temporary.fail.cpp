// expect: input.samples = poll\(\).*keep them in a variable
#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

std::vector<CellSample> poll();

int main() {
  CycleInput<6> input;
  input.samples = poll();
}
