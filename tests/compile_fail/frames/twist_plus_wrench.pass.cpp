#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const Twist<Tool, World, Tool, Tool> V;
  const Wrench<Tool> F;
  static_cast<void>(power(F, V));
}
