// expect: input.wrenches = poll\(\).*keep them in a variable
#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

std::vector<WrenchSample> poll();

int main() {
  WristInput input;
  input.wrenches = poll();
}
