// expect: \(X_WT \* X_CT\).*inner frames differ: invert, swap
#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

struct Table : FrameTag {};

int main() {
  const Transform<World, Table> X_WT;
  const Transform<Cell, Table> X_CT;
  static_cast<void>(X_WT * X_CT);
}
