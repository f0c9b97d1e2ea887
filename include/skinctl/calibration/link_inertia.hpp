// SPDX-License-Identifier: BSD-3-Clause
// A link with the inertia that a fit found.
#pragma once

#include <Eigen/Core>

#include "skinctl/calibration/detail/pseudo_inertia.hpp"
#include "skinctl/model/link.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The link with another inertia `theta`, ten numbers as of `inertial_parameters`; its placement stays.
[[nodiscard]] inline LinkParameters<double> with_inertia(LinkParameters<double> link, const double* theta) {
  using P = LinkParameter;
  const Eigen::Map<const detail::fit::Inertia10> t(theta);
  const Eigen::Matrix4d Q = detail::fit::pseudo_inertia(t);
  const Eigen::Vector3d c = Q.topRightCorner<3, 1>() / t(0);
  const Eigen::Matrix3d S = Q.topLeftCorner<3, 3>() - t(0) * c * c.transpose();
  link[P::mass] = t(0);
  link[P::c_x] = c.x(), link[P::c_y] = c.y(), link[P::c_z] = c.z();
  link[P::s_xx] = S(0, 0), link[P::s_yy] = S(1, 1), link[P::s_zz] = S(2, 2);
  link[P::s_xy] = S(0, 1), link[P::s_xz] = S(0, 2), link[P::s_yz] = S(1, 2);
  return link;
}

SKINCTL_END_NAMESPACE
