// expect: p = v.*as_xyz
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  Xyz<double> p;
  const Vec3<double> v = Vec3<double>::Zero();
#ifdef SKINCTL_RIGHT
  p = as_xyz(v);
#else
  p = v;
#endif
}
