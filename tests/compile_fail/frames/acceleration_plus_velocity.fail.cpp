// expect: other body, point or axes, or no acceleration
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  [[maybe_unused]] const Acceleration<Tool, Base> a, b;
  [[maybe_unused]] const Twist<Tool, Base> V;
#ifdef SKINCTL_RIGHT
  static_cast<void>(a + b);
#else
  static_cast<void>(a + V);
#endif
}
