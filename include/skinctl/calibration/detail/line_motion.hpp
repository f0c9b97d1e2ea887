// SPDX-License-Identifier: BSD-3-Clause
// The motion of a chain of links from the lines of its joints' axes: what its accelerometers feel.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "skinctl/calibration/activation.hpp"
#include "skinctl/calibration/detail/cell_fit.hpp"
#include "skinctl/calibration/detail/eigen_only.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An axis as a line in the axes of the base, at home.
struct AxisLine {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< any point of the line [m]
};

namespace detail::fit {

/// `v` turned by an angle of cosine `c` and sine `s` about a unit axis.
inline Eigen::Vector3d turned(const Eigen::Vector3d& v, const Eigen::Vector3d& axis, double c,
                              double s) noexcept {
  return c * v + s * axis.cross(v) + ((1 - c) * axis.dot(v)) * axis;
}

/// The state of a link in its own axes, which at home are the base's; all over |g|.
struct LinkState {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();      ///< angular velocity, over sqrt |g|
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();  ///< angular acceleration
  Eigen::Vector3d f = Eigen::Vector3d::UnitZ();     ///< specific force at `point`
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< point of the link, where it lies at home [m]

  /// The next link, behind a joint with sine and cosine of its angle, dq/sqrt |g| and ddq/|g|.
  [[nodiscard]] LinkState next(const AxisLine& line, double c, double s, double dq,
                               double ddq) const noexcept {
    const Eigen::Vector3d d = line.point - point, &z = line.direction;
    const auto back = [&](const Eigen::Vector3d& v) { return turned(v, z, c, -s); };
    LinkState out;
    out.w = back(w) + dq * z;
    out.alpha = back(alpha + dq * w.cross(z)) + ddq * z;
    out.f = back(f + alpha.cross(d) + w.cross(w.cross(d)));
    out.point = line.point;
    return out;
  }
  /// `A` and `S`, row by row, of the specific force `A + S p` at the point p of the link.
  [[nodiscard]] Eigen::Matrix<double, 12, 1> signal() const noexcept {
    const Eigen::Matrix3d S =
        cross_matrix(alpha) + w * w.transpose() - w.squaredNorm() * Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 12, 1> out;
    out.head<3>() = f - S * point;
    for (int a = 0; a < 3; ++a) out.segment<3>(3 + 3 * a) = S.row(a).transpose();
    return out;
  }
};

/// The unknowns: four per line (two turns of the direction, two shifts of the point), a compliance per joint,
/// the lateness of the labels. Joints of `joints` are fitted; links are counted by them. A joint stands at
/// `q - compliance tau`.
class LineMotion {
 public:
  LineMotion(const MeasuredMotion& motion, std::vector<int> joints, const Eigen::VectorXd& home,
             std::vector<AxisLine> start, double late, double gravity, const MeasuredMotion* torque = nullptr)
      : lines(std::move(start)),
        compliance(lines.size(), 0.0),
        lateness(late),
        torque_(torque),
        motion_(&motion),
        joints_(std::move(joints)),
        home_(home),
        gravity_(gravity) {
    if (torque_ != nullptr) torque_home_ = torque_->first();
  }

  std::vector<AxisLine> lines;
  std::vector<double> compliance;  ///< compliance of each joint [rad/(N m)]
  double lateness;                 ///< lateness of the labels [s]

  /// Standard deviation of a compliance, before the data [rad/(N m)].
  static constexpr double usual_compliance = 1e-4;

  [[nodiscard]] int unknowns() const noexcept { return 5 * int(lines.size()) + 1; }
  /// Adds the prior of the compliances to the information and the gradient.
  void hold(Eigen::VectorXd& information, Eigen::VectorXd& gradient) const {
    const auto n = Eigen::Index(lines.size());
    // Without torques they are 0.
    const double weight = 1 / (usual_compliance * usual_compliance) * (torque_ == nullptr ? 1e6 : 1.0);
    information.segment(4 * n, n).array() += weight;
    for (Eigen::Index j = 0; j < n; ++j) gradient(4 * n + j) -= weight * compliance[std::size_t(j)];
  }
  [[nodiscard]] static Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction) noexcept {
    Eigen::Matrix<double, 3, 2> out;
    out.col(0) = direction.unitOrthogonal();
    out.col(1) = direction.cross(out.col(0));
    return out;
  }
  [[nodiscard]] static AxisLine moved(const AxisLine& line, const Eigen::Vector4d& d) noexcept {
    const auto E = across(line.direction);
    return {(line.direction + E * d.head<2>()).normalized(), line.point + E * d.tail<2>()};
  }
  [[nodiscard]] LineMotion moved(const Eigen::VectorXd& d) const {
    LineMotion out = *this;
    for (std::size_t j = 0; j < lines.size(); ++j)
      out.lines[j] = moved(lines[j], d.segment<4>(4 * Eigen::Index(j)));
    for (std::size_t j = 0; j < lines.size(); ++j)
      out.compliance[j] += d(4 * Eigen::Index(lines.size()) + Eigen::Index(j));
    out.lateness += d(unknowns() - 1);
    return out;
  }
  /// The unknowns' change by a shift `t` and a turn `psi` about the vertical of the base: gauge.
  [[nodiscard]] Eigen::VectorXd gauge(const Eigen::Vector3d& t, double psi) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(unknowns());
    const Eigen::Vector3d z(0, 0, psi);
    for (std::size_t j = 0; j < lines.size(); ++j) {
      const auto E = across(lines[j].direction);
      out.segment<2>(4 * Eigen::Index(j)) = E.transpose() * z.cross(lines[j].direction);
      out.segment<2>(4 * Eigen::Index(j) + 2) = E.transpose() * (t + z.cross(lines[j].point));
    }
    return out;
  }

  [[nodiscard]] std::vector<BodySignals> signals(const BlockMeans& data) const {
    const auto n = lines.size();
    std::vector<BodySignals> out(n);
    for (std::size_t l = 0; l < n; ++l) {
      for (int k = 0; k < 4 * int(l + 1); ++k) out[l].unknowns.push_back(k);
      if (torque_ != nullptr)
        for (int k = 0; k < int(l + 1); ++k) out[l].unknowns.push_back(4 * int(n) + k);
      out[l].unknowns.push_back(unknowns() - 1);
      out[l].columns.setZero(data.blocks(),
                             BodySignals::own + BodySignals::each * Eigen::Index(out[l].unknowns.size()));
      out[l].columns.col(12).setOnes();
    }
    constexpr double step = 1e-6, soft_step = 1e-8, time_step = 1e-4;
    std::vector<AxisLine> changed;
    for (std::size_t j = 0; j < n; ++j)
      for (int k = 0; k < 4; ++k) changed.push_back(moved(lines[j], step * Eigen::Vector4d::Unit(k)));
    std::vector<LinkState> states(n), late(n);
    std::vector<Angle> angles(n), softer(n), late_angles(n);
    std::vector<Eigen::Matrix<double, 12, 1>> signal(n);
    for (Eigen::Index block = 0; block < data.blocks(); ++block)
      for (int g = 0; g < 3; ++g) {
        const double t = data.middle(block) + gauss_place[g] * data.length - lateness;
        const double weight = gauss_weight[g];
        angles_at(t - time_step, 0, late_angles);
        chain(late_angles, late);
        angles_at(t, 0, angles);
        chain(angles, states);
        for (std::size_t l = 0; l < n; ++l) {
          signal[l] = states[l].signal();
          auto row = out[l].columns.row(block);
          row.head<12>() += weight * signal[l].transpose();
          row.tail<12>() += weight / time_step * (late[l].signal() - signal[l]).transpose();
        }
        // Joint j changed: its line in four ways, or its compliance.
        const auto change = [&](std::size_t j, const AxisLine& line, const Angle& angle, double per,
                                const auto& column) {
          LinkState s =
              (j == 0 ? LinkState{} : states[j - 1]).next(line, angle.c, angle.s, angle.dq, angle.ddq);
          for (std::size_t l = j; l < n; ++l) {
            if (l > j) s = s.next(lines[l], angles[l].c, angles[l].s, angles[l].dq, angles[l].ddq);
            out[l].columns.row(block).segment<12>(13 + 12 * column(l)) +=
                weight / per * (s.signal() - signal[l]).transpose();
          }
        };
        for (std::size_t j = 0; j < n; ++j)
          for (std::size_t k = 0; k < 4; ++k)
            change(j, changed[4 * j + k], angles[j], step,
                   [&](std::size_t) { return Eigen::Index(4 * j + k); });
        if (torque_ == nullptr) continue;
        angles_at(t, soft_step, softer);
        for (std::size_t j = 0; j < n; ++j)
          change(j, lines[j], softer[j], soft_step,
                 [&](std::size_t l) { return Eigen::Index(4 * (l + 1) + j); });
      }
    return out;
  }

 private:
  struct Angle {
    double c, s, dq, ddq;
  };
  /// Sets the angles of all joints at `t` [s], with compliances that are greater by `softer` [rad/(N m)].
  void angles_at(double t, double softer, std::vector<Angle>& angles) const {
    motion_->at(t, p_);
    if (torque_ != nullptr) torque_->at(t, tau_);
    for (std::size_t j = 0; j < lines.size(); ++j) {
      const int i = joints_[j];
      double q = p_.q(i) - home_(i), dq = p_.dq(i), ddq = p_.ddq(i);
      if (torque_ != nullptr) {
        const double c = compliance[j] + softer;
        q -= c * (tau_.q(i) - torque_home_(i)), dq -= c * tau_.dq(i), ddq -= c * tau_.ddq(i);
      }
      angles[j] = {std::cos(q), std::sin(q), dq / std::sqrt(gravity_), ddq / gravity_};
    }
  }
  void chain(const std::vector<Angle>& angles, std::vector<LinkState>& states) const {
    LinkState state;
    for (std::size_t j = 0; j < lines.size(); ++j)
      states[j] = state = state.next(lines[j], angles[j].c, angles[j].s, angles[j].dq, angles[j].ddq);
  }

  const MeasuredMotion* torque_ = nullptr;
  Eigen::VectorXd torque_home_{};
  const MeasuredMotion* motion_;
  std::vector<int> joints_;
  Eigen::VectorXd home_;
  double gravity_;
  mutable JointPoint p_{}, tau_{};
};

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
