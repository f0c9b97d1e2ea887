// expect: gravity keeps weight 1
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  static_cast<void>(0.5 * gravity);
}
