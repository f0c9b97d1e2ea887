// expect: axes, not a quaternion: q\.toRotationMatrix\(\)
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto pose(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
#ifdef SKINCTL_RIGHT
  return Transform<Link<5>, Cell>(q.toRotationMatrix(), p);
#else
  return Transform<Link<5>, Cell>(q, p);
#endif
}
