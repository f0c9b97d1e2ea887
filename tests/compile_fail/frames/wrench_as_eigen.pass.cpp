#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  Vec6<double> v;
  const Wrench<Tool> F;
  v = as_eigen(F);
}
