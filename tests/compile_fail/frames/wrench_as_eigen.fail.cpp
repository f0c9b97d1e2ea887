// expect: v = F.*as_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  Vec6<double> v;
  const Wrench<Tool> F;
#ifdef SKINCTL_RIGHT
  v = as_eigen(F);
#else
  v = F;
#endif
}
