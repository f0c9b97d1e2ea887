#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

std::vector<CellSample> poll();

int main() {
  CycleInput<6> input;
  const auto samples = poll();
  input.samples = samples;
}
