// Bodies that are not as their drawing says.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "skinctl/calibration/detail/pseudo_inertia.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// A body whose mass, moments and their axes are off by a tenth to a quarter: the factor of its
/// pseudo-inertia is disturbed, lengths in 0.15 m and mass first.
inline detail::fit::Inertia10 other_body(const detail::fit::Inertia10& body, Random& rng) {
  Eigen::Matrix4d turned = Eigen::Matrix4d::Zero();  // lengths of 0.15 m, mass first
  for (int i = 0; i < 3; ++i) turned(3 - i, i) = 1 / 0.15;
  turned(0, 3) = 1;
  const detail::fit::Inertia10 near = detail::fit::body_near(body, 0.15);
  const Eigen::Matrix4d P = turned * detail::fit::pseudo_inertia(near) * turned.transpose();
  const skinctl::detail::Cholesky factor(P);
  Eigen::Matrix4d L = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k <= i; ++k) L(i, k) = factor.factor(i, k);
  const double mass = L(0, 0);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k <= i; ++k)
      if (k < i)
        L(i, k) += uniform(rng, -0.08, 0.08) * mass;
      else
        L(i, k) *= std::exp(i == 0 ? uniform(rng, -0.12, 0.12) : uniform(rng, -0.15, 0.15));
  Eigen::Matrix4d back = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 3; ++i) back(i, 3 - i) = 0.15;
  back(3, 0) = 1;
  return detail::fit::parameters_of(back * (L * L.transpose()) * back.transpose());
}

}  // namespace skinctl::testing
