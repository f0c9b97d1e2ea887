#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<Cell, Link<2>> X_CL;
  const Wrench<Link<2>, Cell> F_C;
  static_cast<void>(X_CL.inverse() * F_C);
}
