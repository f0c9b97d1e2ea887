#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Twist<Tool, World, Tool, Tool> V;
  const Wrench<Tool> F;
  static_cast<void>(power(F, V));
}
