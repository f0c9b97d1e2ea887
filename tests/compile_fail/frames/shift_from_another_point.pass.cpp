#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Wrench<Link<2>, Cell> F_C;
  const Offset<Link<2>, Cell, Link<2>> p_LC_L;
  [[maybe_unused]] const Transform<Cell, Link<2>> X_CL;
  static_cast<void>(shift(F_C, -(X_CL * p_LC_L)));
}
