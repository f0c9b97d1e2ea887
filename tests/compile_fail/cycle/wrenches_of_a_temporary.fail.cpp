// expect: input.wrenches = poll\(\).*keep them in a variable
#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

std::vector<WrenchSample> poll();

int main() {
  WristInput input;
#ifdef SKINCTL_RIGHT
  const auto wrenches = poll();
  input.wrenches = wrenches;
#else
  input.wrenches = poll();
#endif
}
