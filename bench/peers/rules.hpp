// Rules by which others give way to a wrench at the tool, written anew from what they publish, and one input
// on which their originals were asked as well.
//
// ros2: the rule of ros2_control's admittance controller (ros2_controllers 94e74de, with KDL's kinematics).
// fzi: forward dynamics compliance (S. Scherzinger, A. Roennau, R. Dillmann, IROS 2017, arXiv 1908.06252;
// cartesian_controllers f53f798) without stiffness.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

namespace peers {

using Six = Eigen::Matrix<double, 6, 1>;
using Square = Eigen::Matrix<double, 6, 6>;
using Point = Eigen::Vector3d;

/// What the rules need of a UR5: its flange, and the ends of its links.
struct Kinematics {
  std::array<Point, 7> p;  ///< origins of the joints, and of the flange [m]
  std::array<Point, 6> z;  ///< axes of the joints
  Eigen::Matrix3d R;       ///< axes of the flange

  explicit Kinematics(const Six& q) {
    const skinctl::ur5::Model model;
    skinctl::JointPosition<6> angles;
    for (std::size_t i = 0; i < 6; ++i) angles[i] = q(int(i));
    const skinctl::Poses<skinctl::ur5::Model, skinctl::all_links(6)> poses(
        model, skinctl::JointAngles<skinctl::ur5::Model, double>(model, angles));
    const auto point = [](const auto& x) { return Point(x.x, x.y, x.z); };
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      ((p[K] = point(poses.template get<K>().origin()), z[K] = point(poses.template get<K>().axis_z())), ...);
    }(std::make_index_sequence<6>{});
    const auto X = poses.template get<5>();
    R.col(2) = z[5], R.col(0) = point(X.axis_x()), R.col(1) = R.col(2).cross(R.col(0));
    p[6] = p[5] + skinctl::ur5::Description::flange[2] * z[5];
  }
  /// Of the end of link `i`, linear rows first.
  [[nodiscard]] Square jacobian(std::size_t i = 5) const {
    Square J = Square::Zero();
    for (std::size_t k = 0; k <= i; ++k) {
      J.col(int(k)).head<3>() = z[k].cross(p[i + 1] - p[k]);
      J.col(int(k)).tail<3>() = z[k];
    }
    return J;
  }
};

/// `M x'' + D x' + K x = F` at the flange, along the axes of the base, with `D = 2 ratio sqrt(M K)`; x from
/// the measured position, x' and the offset of the joints from the rule's own integration. No limit of any
/// kind.
struct Ros2 {
  Six mass, stiffness, ratio;
  double joint_damping = 5;  ///< [1/s], the default
  double filter = 0.05;      ///< share of a new reading of the sensor, the default; 1: no filter
  double alpha = 5e-6;       ///< damping of the inverse Jacobian, the default

  Six reference, wrench = Six::Zero(), twist = Six::Zero(), dq = Six::Zero(), offset = Six::Zero();

  Six step(const Six& q, const Six& F, double dt) {
    const Kinematics here(q), there(reference);
    const Square J = here.jacobian();
    wrench = filter * F + (1 - filter) * wrench;
    Six x;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(here.R * there.R.transpose()));
    x << here.p[6] - there.p[6], turn.angle() * turn.axis();
    const Six damping = 2 * ratio.cwiseProduct(mass.cwiseProduct(stiffness).cwiseSqrt());
    const Six ddx = (wrench - damping.cwiseProduct(twist) - stiffness.cwiseProduct(x)).cwiseQuotient(mass);
    const Square JtJ = J.transpose() * J + alpha * Square::Identity();
    const Six ddq = JtJ.inverse() * (J.transpose() * ddx) - joint_damping * dq;
    dq += dt * ddq;
    offset += dt * dq;
    twist = J * dq;
    return reference + offset;
  }
};

/// `H ddq = J' gain F` of a robot of light links (0.1 kg) with a flange of 1 kg, 1 kg m^2; steps of 20 ms
/// whatever the period, a tenth of the speed lost in each, from the measured position.
struct Fzi {
  double gain = 1;
  Six lower = Six::Constant(-1e9), upper = Six::Constant(1e9);
  Six dq = Six::Zero();

  static Square inertia(const Kinematics& here) {
    Square H = Square::Zero();
    for (std::size_t i = 0; i < 6; ++i) {
      const Square J = here.jacobian(i);
      const double mass = i == 5 ? 1 : 0.1, turned = i == 5 ? 1 : 1e-6;
      H += mass * J.topRows<3>().transpose() * J.topRows<3>() +
           turned * J.bottomRows<3>().transpose() * J.bottomRows<3>();
    }
    return H;
  }
  Six step(const Six& q, const Six& F) {
    const Kinematics here(q);
    const Six ddq = inertia(here).inverse() * (here.jacobian().transpose() * (gain * F));
    const Six command = (q + 0.02 * dq).cwiseMax(lower).cwiseMin(upper);
    dq = 0.9 * (dq + 0.02 * ddq);
    return command;
  }
};

/// How far both are from their originals after five steps under one wrench, the joints measured elsewhere in
/// each [rad]: the originals' formulas with KDL's chain of the published DH rows, run once outside of here.
inline double from_originals() {
  Six q, dq, F, ros2, fzi;
  q << 0.1, -1.2, 1.4, -1.8, -1.5, 0.3;
  dq << 0.01, -0.02, 0.015, 0.005, -0.01, 0.02;  // from step to step [rad]
  F << 12, -7, 5, 0.4, -0.3, 0.6;
  ros2 << -9.73165422056e-05, 0.000450446029592, -0.000587526378539, 0.000208452896199, 0.00016570322221,
      -0.000512172384936;
  fzi << 0.153776750796, -1.30180117813, 1.47779422134, -1.77607910519, -1.54067316392, 0.393024629061;
  Ros2 one;
  one.mass << 5, 6, 7, 0.5, 0.4, 0.3;
  one.stiffness << 200, 150, 100, 10, 8, 6;
  one.ratio.setConstant(1.5);
  one.reference = q;
  Fzi two;
  double off = 0;
  for (int n = 0; n < 5; ++n) {
    const Six command = one.step(q + n * dq, F, 0.008), other = two.step(q + n * dq, F);
    if (n == 4)
      off = std::max((command - q - ros2).cwiseAbs().maxCoeff(), (other - fzi).cwiseAbs().maxCoeff());
  }
  return off;
}

}  // namespace peers
