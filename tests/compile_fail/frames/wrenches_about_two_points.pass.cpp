#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Wrench<Link<2>> F_L;
  const Wrench<Link<2>, Cell> F_C;
  [[maybe_unused]] const Transform<Link<2>, Cell> X_LC;
  static_cast<void>(F_L + X_LC * F_C);
}
