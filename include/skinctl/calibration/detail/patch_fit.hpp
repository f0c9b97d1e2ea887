// SPDX-License-Identifier: BSD-3-Clause
// The least squares behind `reconstruct`: cells of a patch, their sensors, and gravity.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "skinctl/calibration/normal_equations.hpp"
#include "skinctl/calibration/reconstruction_types.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The least squares of a patch. Unknowns: place and turn of each cell but the root, nine sensor errors of
/// each, two of each direction of gravity.
struct PatchFit {
  struct State {
    std::vector<ReconstructedCell> cells;
    std::vector<Eigen::Vector3d> up;
  };
  const std::vector<PatchGraph::Joint>& joints;
  const RestReadings& readings;
  const ReconstructionSettings& s;
  std::vector<Eigen::Matrix3d> start;  // of the cells

  [[nodiscard]] int pose_column(std::size_t i) const { return i == 0 ? -1 : 15 * int(i) - 6; }
  [[nodiscard]] int error_column(std::size_t i) const { return i == 0 ? 0 : 15 * int(i); }
  [[nodiscard]] int up_column(std::size_t k) const { return 15 * int(readings.size()) - 6 + 2 * int(k); }
  [[nodiscard]] int unknowns() const { return up_column(readings.front().size()); }

  /// Two directions across `u`.
  [[nodiscard]] static Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& u) {
    Eigen::Matrix<double, 3, 2> A;
    A.col(0) = u.unitOrthogonal();
    A.col(1) = u.cross(A.col(0));
    return A;
  }
  [[nodiscard]] State plus(const State& x, const Eigen::VectorXd& d) const {
    State out = x;
    for (std::size_t i = 0; i < x.cells.size(); ++i) {
      auto& cell = out.cells[i];
      if (const int at = pose_column(i); at >= 0) {
        cell.p += d.segment<3>(at);
        cell.R = straightened(cell.R * turn(d.segment<3>(at + 3)));
      }
      const int at = error_column(i);
      cell.errors.bias += d.segment<3>(at);
      cell.errors.scale += d.segment<3>(at + 3);
      cell.errors.misalignment += d.segment<3>(at + 6);
    }
    for (std::size_t k = 0; k < x.up.size(); ++k)
      out.up[k] = (x.up[k] + across(x.up[k]) * d.segment<2>(up_column(k))).normalized();
    return out;
  }
  template <class Sum>
  void terms(const State& x, Sum& sum) const {
    const Loss readings_loss{Loss::Kind::huber, 5};
    const double prior[3] = {1 / s.prior.bias, 1 / s.prior.scale, 1 / s.prior.misalignment};
    Eigen::Matrix<double, 9, 9> by_own = Eigen::Matrix<double, 9, 9>::Zero();
    for (int k = 0; k < 9; ++k) by_own(k, k) = prior[k / 3];
    // As little as nothing is known of a rotation: without it a cell that the data do not show makes all of
    // the inverse infinite, and not its own part.
    const Eigen::Matrix3d loose = Eigen::Matrix3d::Identity() / 1.8;
    for (std::size_t i = 0; i < x.cells.size(); ++i) {
      const auto& cell = x.cells[i];
      const int turn_at = i == 0 ? -1 : pose_column(i) + 3;
      for (std::size_t k = 0; k < x.up.size(); ++k) {
        if (!readings[i][k].allFinite()) continue;
        const double w = 1 / s.reading;
        if constexpr (Sum::derivatives) {
          const auto y = reading_and_derivatives(cell.R, cell.errors, x.up[k]);
          const Eigen::Vector3d rest = w * (y.y - readings[i][k]);
          const Eigen::Matrix3d by_turn = w * y.by_turn;
          Eigen::Matrix<double, 3, 9> by_errors = Eigen::Matrix<double, 3, 9>::Zero();
          for (int a = 0; a < 3; ++a) {
            by_errors(a, a) = w, by_errors(a, 3 + a) = w * y.by_scale(a);
            for (int b = 0; b < 3; ++b) by_errors(a, 6 + b) = w * y.by_misalignment(a, b);
          }
          const Eigen::Matrix3d by_force = w * y.by_force;
          const Eigen::Matrix<double, 3, 2> by_up = by_force * across(x.up[k]);
          sum.add(readings_loss, rest,
                  {{turn_at, by_turn}, {error_column(i), by_errors}, {up_column(k), by_up}});
        } else {
          const Eigen::Vector3d rest = w * (reading(cell.R, cell.errors, x.up[k]) - readings[i][k]);
          sum.add(readings_loss, rest);
        }
      }
      Eigen::Matrix<double, 9, 1> own;
      for (int k = 0; k < 3; ++k)
        own(k) = prior[0] * cell.errors.bias(k), own(3 + k) = prior[1] * cell.errors.scale(k),
        own(6 + k) = prior[2] * cell.errors.misalignment(k);
      sum.add({}, own, {{error_column(i), by_own}});
      const Eigen::Matrix3d turned = start[i].transpose() * cell.R;
      sum.add({}, Eigen::Vector3d(loose * turn_vector(turned)), {{turn_at, loose}});
    }
    for (const auto& j : joints) {
      const auto &a = x.cells[j.a], &b = x.cells[j.b];
      const auto &ca = s.ports[j.port_a], &cb = s.ports[j.port_b];
      const double w = 1 / s.gap;
      const Eigen::Vector3d port_a = a.R * ca, port_b = b.R * cb;
      Eigen::Vector3d gap;
      for (int k = 0; k < 3; ++k) gap(k) = w * (a.p(k) + port_a(k) - b.p(k) - port_b(k));
      Eigen::Matrix<double, 3, 6> by_a, by_b;
      by_a.setZero(), by_b.setZero();
      if constexpr (Sum::derivatives) {
        const Eigen::Matrix3d turn_a = a.R * cross_matrix(ca), turn_b = b.R * cross_matrix(cb);
        for (int r = 0; r < 3; ++r) {
          by_a(r, r) = w, by_b(r, r) = -w;
          for (int c = 0; c < 3; ++c) by_a(r, 3 + c) = -w * turn_a(r, c), by_b(r, 3 + c) = w * turn_b(r, c);
        }
      }
      sum.add({}, gap, {{pose_column(j.a), by_a}, {pose_column(j.b), by_b}});
    }
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
