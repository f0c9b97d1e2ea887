#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  [[maybe_unused]] const Acceleration<Tool, Base> a, b;
  [[maybe_unused]] const Twist<Tool, Base> V;
  static_cast<void>(a + b);
}
