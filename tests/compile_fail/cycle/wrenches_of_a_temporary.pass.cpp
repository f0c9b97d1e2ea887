#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

std::vector<WrenchSample> poll();

int main() {
  WristInput input;
  const auto wrenches = poll();
  input.wrenches = wrenches;
}
