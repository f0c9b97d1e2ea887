// expect: \(V_WB_W \+ V_BT_B\).*no chain V_AB \+ V_BC
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Twist<Base, World, Tool, World> V_WB_W;
  const Twist<Tool, Base, Tool, Base> V_BT_B;
  [[maybe_unused]] const Transform<World, Base> X_WB;
#ifdef SKINCTL_RIGHT
  static_cast<void>(V_WB_W + express(X_WB, V_BT_B));
#else
  static_cast<void>(V_WB_W + V_BT_B);
#endif
}
