// expect: \(V \+ F\).*no chain V_AB \+ V_BC
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Twist<Tool, World, Tool, Tool> V;
  const Wrench<Tool> F;
#ifdef SKINCTL_RIGHT
  static_cast<void>(power(F, V));
#else
  static_cast<void>(V + F);
#endif
}
