// 01 Frames: from a touch on a cell to force and moment on the link that carries it.
//
//   X_LC   pose of the cell in its link        F_C   force on the cell: along -z, because a touch only pushes
//   X_BL   pose of the link in the base        F_L   the same load on the link, about the link's origin
#include <cstdio>

#include "skinctl/frames/transform.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;
using Forearm = Link<2>;

int main() {
  // A cell on top of the forearm, 20 cm from the elbow; its z axis is the outward normal.
  const auto X_LC =
      Transform<Forearm, Cell>::translation_xyz(-0.2, 0.04, 0.0165).rotated_x(-1.5707963267948966);
  // The forearm, lifted by 30 degrees.
  const auto X_BL = Transform<Base, Forearm>::translation_xyz(-0.425, 0, 0.089).rotated_z(0.5235987755982988);

  // A finger presses with 10 N. A cell carries no moment about its own origin.
  const Wrench<Forearm, Cell> F_C{{0, 0, -10}, {0, 0, 0}};

  // The load on the link, about the link's origin, along the link's axes: it has a moment.
  const Wrench<Forearm, Forearm> F_L = X_LC * F_C;
  std::printf("on the link:  force  %6.2f %6.2f %6.2f N\n", F_L.force.x, F_L.force.y, F_L.force.z);
  std::printf("              moment %6.2f %6.2f %6.2f N m\n", F_L.moment.x, F_L.moment.y, F_L.moment.z);

  // The same load about the same point, along the axes of the base.
  const Wrench<Forearm, Forearm, Base> F_L_B = express(X_BL, F_L);
  std::printf("in the base:  force  %6.2f %6.2f %6.2f N\n", F_L_B.force.x, F_L_B.force.y, F_L_B.force.z);

  // Pose of the cell in the base: inner frames must be equal, else the product does not compile.
  const Transform<Base, Cell> X_BC = X_BL * X_LC;
  std::printf("cell at       %.3f %.3f %.3f m, normal %.2f %.2f %.2f\n", X_BC.origin().x, X_BC.origin().y,
              X_BC.origin().z, X_BC.axis_z().x, X_BC.axis_z().y, X_BC.axis_z().z);
  // X_LC * X_BL;   // error: inner frames differ: invert or swap
  // F_L + F_C;     // error: other body, point or axes: shift, express
}
