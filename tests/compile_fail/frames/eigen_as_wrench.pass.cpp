#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Vec6<double> v = Vec6<double>::Zero();
  Wrench<Tool> F;
  F = Wrench<Tool>::from_eigen(v);
}
