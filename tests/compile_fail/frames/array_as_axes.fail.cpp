// expect: axes, not an array
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
auto pose(const Rotation<double>& R, const Xyz<double>& p) {
#else
auto pose(const std::array<double, 9>& R, const std::array<double, 3>& p) {
#endif
  return Transform<Link<5>, Cell>(R, p);
}
