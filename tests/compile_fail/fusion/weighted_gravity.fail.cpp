// expect: gravity keeps weight 1
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/fusion/expression.hpp"

int main() {
  const skinctl::GravityControl gravity;
  static_cast<void>(0.5 * gravity);
}
