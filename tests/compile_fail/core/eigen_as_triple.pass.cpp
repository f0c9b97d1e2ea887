#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  Xyz<double> p;
  const Vec3<double> v = Vec3<double>::Zero();
  p = as_xyz(v);
}
