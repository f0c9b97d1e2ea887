// expect: F = v.*from_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Vec6<double> v = Vec6<double>::Zero();
  Wrench<Tool> F;
#ifdef SKINCTL_RIGHT
  F = Wrench<Tool>::from_eigen(v);
#else
  F = v;
#endif
}
