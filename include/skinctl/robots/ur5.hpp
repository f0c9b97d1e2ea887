// SPDX-License-Identifier: BSD-3-Clause
// Universal Robots UR5 (CB3): kinematics, inertias and limits as the maker publishes them.
#pragma once

#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace ur5 {

/// The static model of a UR5. Link `i` (0 to 5) is moved by joint `i`; its frame is the maker's
/// Denavit-Hartenberg frame directly after the rotation by theta, so z lies on the joint axis and x, y rotate
/// with the link. At q = 0 the arm is stretched along -x of the base.
///
/// Sources:
/// - a, d, alpha, masses and centres of mass: universal-robots.com, "DH parameters for calculations of
///   kinematics and dynamics".
/// - Inertia tensors (cylinder approximations) and joint limits: UR ROS 2 description, config/ur5 (BSD-3).
struct Description {
  static constexpr std::size_t joints = 6;
  static constexpr auto parents = chain_parents<6>();
  static constexpr auto kinds = all_of_kind<6>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};

  // Maker's DH rows: Rz(theta) Tz(d) Tx(a) Rx(alpha).
  static constexpr double d1 = 0.089159, a2 = -0.425, a3 = -0.39225, d4 = 0.10915, d5 = 0.09465, d6 = 0.0823;

  static constexpr std::array<LinkParameters<double>, 6> links = {
      make_link({},
                {3.7, {0, -0.00193, d1 - 0.02561}, 0.014972358333333331, 0.014972358333333331, 0.01040625}),
      make_link({.p = {0, 0, d1}, .alpha = Angle::quarter(1)},
                {8.393, {a2 + 0.2125, 0, 0.11336}, 0.0151074, 0.13388583541666665, 0.13388583541666665}),
      make_link({.p = {a2, 0, 0}},
                {2.33, {a3 + 0.15, 0, 0.0265}, 0.004095, 0.031216803515624995, 0.031216803515624995}),
      make_link({.p = {a3, 0, 0}},
                {1.219, {0, -0.01634, d4 - 0.0018}, 0.002013889583333333, 0.002013889583333333, 0.0021942}),
      make_link({.p = {0, 0, d4}, .alpha = Angle::quarter(1)},
                {1.219, {0, 0.01634, d5 - 0.0018}, 0.0018310395833333333, 0.0018310395833333333, 0.0021942}),
      make_link(
          {.p = {0, 0, d5}, .alpha = Angle::quarter(-1)},
          {0.1879, {0, 0, d6 - 0.001159}, 8.062475833333332e-05, 8.062475833333332e-05, 0.0001321171875}),
  };
  static constexpr double flange[3] = {0, 0, d6};  ///< origin of the flange in link 5's frame, axes alike [m]

  static constexpr std::array<double, 6> lower = {-6.283185307179586, -6.283185307179586, -3.141592653589793,
                                                  -6.283185307179586, -6.283185307179586, -6.283185307179586};
  static constexpr std::array<double, 6> upper = {6.283185307179586, 6.283185307179586, 3.141592653589793,
                                                  6.283185307179586, 6.283185307179586, 6.283185307179586};
  static constexpr double max_velocity = 3.141592653589793;  ///< largest speed of every joint [rad/s]
  static constexpr std::array<double, 6> max_torque = {150, 150, 150, 28, 28, 28};  ///< largest torques [N m]
};

using Model = StaticModel<Description>;

/// A UR5 with numbers at run time: start from the maker's numbers and replace those of the calibration.
template <Scalar T = double>
using Calibrated = CalibratedModel<Description, T>;

}  // namespace ur5

SKINCTL_END_NAMESPACE
