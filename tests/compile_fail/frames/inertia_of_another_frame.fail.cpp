// expect: \(M_L \+ M_T\).*other body or frame: part_of
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Inertia<Link<5>> M_L;
  const Inertia<Tool> M_T;
  [[maybe_unused]] const Transform<Link<5>, Tool> X_LT;
  static_cast<void>(M_L + M_T);
}
