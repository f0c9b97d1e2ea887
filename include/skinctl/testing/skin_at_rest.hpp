// SPDX-License-Identifier: BSD-3-Clause
// Patches of skin with known shapes, and what their accelerometers read at rest.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/calibration/nees.hpp"
#include "skinctl/calibration/reconstruction_types.hpp"
#include "skinctl/tactile/cover.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// A normally distributed number, the same on every machine.
[[nodiscard]] inline double normal(Random& rng) {
  double sum =
      0;  // of twelve uniform ones: to 6 deviations, and no logarithm that libraries round differently
  for (int k = 0; k < 12; ++k) sum += uniform<double>(rng, 0.0, 1.0);
  return sum - 6;
}
[[nodiscard]] inline Eigen::Vector3d normal3(Random& rng, double deviation) {
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return deviation * Eigen::Vector3d(x, y, z);
}

/// The true pose of a cell, and its accelerometer.
struct CellAtRest {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  AccelerometerErrors errors{};
  Eigen::Matrix3d cross_axis = Eigen::Matrix3d::Identity();
};
struct PatchAtRest {
  PatchGraph graph;
  std::vector<CellAtRest> cells;  ///< cells in the order of `graph.ids`
};

/// The accelerometer of a BMA250, as it is in a cell.
struct SimulatedAccelerometer {
  double noise = 9e-3;  ///< standard deviation of a sample [g]
  double step = 1.0 / 256;
  double cross_axis = 3e-3;
  AccelerometerPrior prior{};

  void draw(Random& rng, CellAtRest& cell) const {
    cell.errors = {normal3(rng, prior.bias), normal3(rng, prior.scale), normal3(rng, prior.misalignment)};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (i != j) cell.cross_axis(i, j) = cross_axis * uniform<double>(rng);
  }
  /// One sample where the specific force in the cell's outer frame is `f` [g].
  [[nodiscard]] Eigen::Vector3d sample(Random& rng, const CellAtRest& cell, const Eigen::Vector3d& f) const {
    Eigen::Vector3d y = cell.cross_axis * reading(cell.R, cell.errors, f) + normal3(rng, noise);
    for (int i = 0; i < 3; ++i) y(i) = std::round(y(i) / step) * step;
    return y;
  }
  /// The mean of a hundred samples at rest [g]; `up`: unit vector upwards in the cell's outer frame.
  [[nodiscard]] Eigen::Vector3d rest(Random& rng, const CellAtRest& cell, const Eigen::Vector3d& up) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 100; ++k) sum += sample(rng, cell, up);
    return sum / 100;
  }
};

/// A patch of cells with these poses, joined where their ports meet to within half a millimetre, by ids from
/// 1 in another order than the cells'. Only the piece that the first cell is in.
[[nodiscard]] inline PatchAtRest joined(const std::vector<CellAtRest>& cells, const CellPorts& ports,
                                        Random& rng) {
  std::vector<CellNames> names(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) names[i].id = std::uint16_t(i + 1);
  for (std::size_t i = cells.size(); i > 1; --i) std::swap(names[i - 1].id, names[rng() % i].id);
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t j = i + 1; j < cells.size(); ++j) {
      if ((cells[i].p - cells[j].p).norm() > 2.2 * ports[0].norm()) continue;
      for (std::uint8_t a = 0; a < 4; ++a)
        for (std::uint8_t b = 0; b < 4; ++b) {
          const Eigen::Vector3d gap = cells[i].p + cells[i].R * ports[a] - cells[j].p - cells[j].R * ports[b];
          if (gap.norm() > 5e-4) continue;
          names[i].neighbours[a] = {names[j].id, b}, names[j].neighbours[b] = {names[i].id, a};
        }
    }
  PatchAtRest out;
  out.graph = skin_graph(names).patches.front();
  for (const auto id : out.graph.ids)
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (names[i].id == id) out.cells.push_back(cells[i]);
  return out;
}

/// A tube around z with skin of at most `most` cells; ports miss each other by `gap` [m].
[[nodiscard]] inline PatchAtRest tube(double radius, double length, std::size_t most,
                                      const SimulatedAccelerometer& sensor, Random& rng, double gap = 7e-5) {
  std::vector<CellAtRest> cells;
  for (const auto& X : full_cover(CylinderSurface{radius, length})) {
    if (cells.size() == most) break;
    CellAtRest cell;
    cell.R = X.rotation();
    cell.p = X.translation() + normal3(rng, gap / std::sqrt(2.0));
    sensor.draw(rng, cell);
    cells.push_back(cell);
  }
  return joined(cells, hexagonal_ports(), rng);
}

/// Directions of up, in the axes of the patch's base, that are the corners of a cube in a random orientation,
/// each turned by `off / 2` rms about each axis [rad]; the first three span space.
[[nodiscard]] inline std::vector<Eigen::Vector3d> cube_corners(Random& rng, double off = 0.1) {
  std::vector<Eigen::Vector3d> up;
  const Eigen::Matrix3d R = turn(normal3(rng, 1));
  for (int k = 0; k < 8; ++k)
    up.push_back(turn(normal3(rng, off / 2)) * R *
                 Eigen::Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).normalized());
  return up;
}

[[nodiscard]] inline RestReadings rest_readings(const PatchAtRest& patch,
                                                const std::vector<Eigen::Vector3d>& up,
                                                const SimulatedAccelerometer& sensor, Random& rng) {
  RestReadings out;
  for (const auto& cell : patch.cells) {
    auto& y = out.emplace_back();
    for (const auto& u : up) y.push_back(sensor.rest(rng, cell, u));
  }
  return out;
}

/// The errors of a reconstruction once it is aligned as a whole, over the cells that it says it knows.
struct ShapeError {
  double place = 0, turn = 0;  ///< rms errors of place [m] and turn [rad]
  double worst_place = 0, worst_turn = 0;
  double nees = 0;  ///< mean of the cells' normalised squared errors, over 6
  std::size_t known = 0;
};
[[nodiscard]] inline ShapeError shape_error(const Reconstruction& found, const PatchAtRest& truth) {
  ShapeError out;
  // The rigid motion that makes the weighted errors smallest: a few Gauss-Newton steps.
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  for (std::size_t i = 0; i < truth.cells.size(); ++i)
    if (found.cells[i].unknown.empty()) {
      R = truth.cells[i].R * found.cells[i].R.transpose();
      t = truth.cells[i].p - R * found.cells[i].p;
      break;
    }
  const auto error = [&](std::size_t i) {
    Vector6 e;  // in the axes of the reconstruction, as its covariance
    e << R.transpose() * (R * found.cells[i].p + t - truth.cells[i].p),
        turn_vector(truth.cells[i].R.transpose() * R * found.cells[i].R);
    return e;
  };
  for (int round = 0; round < 8; ++round) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6), b = Eigen::MatrixXd::Zero(6, 1);
    for (std::size_t i = 0; i < truth.cells.size(); ++i) {
      if (!found.cells[i].unknown.empty()) continue;
      Eigen::MatrixXd G = Eigen::MatrixXd::Identity(6, 6), e = error(i), WG;
      const Eigen::Matrix3d across = cross_matrix(found.cells[i].p);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) G(r, 3 + c) = -across(r, c), G(3 + r, 3 + c) = found.cells[i].R(c, r);
      WG = G;
      for (int r = 0; r < 6; ++r) WG.row(r) *= r < 3 ? 1 / (3e-4 * 3e-4) : 1 / (0.0174 * 0.0174);
      A += G.transpose() * WG;
      b += WG.transpose() * e;
    }
    const Vector6 d = -detail::solve_symmetric(A, b);
    t += R * d.head<3>();
    R = R * turn(d.tail<3>());
  }
  for (std::size_t i = 0; i < truth.cells.size(); ++i) {
    if (!found.cells[i].unknown.empty()) continue;
    const Vector6 e = error(i);
    ++out.known;
    out.place += e.head<3>().squaredNorm(), out.turn += e.tail<3>().squaredNorm();
    out.worst_place = std::max(out.worst_place, e.head<3>().norm());
    out.worst_turn = std::max(out.worst_turn, e.tail<3>().norm());
    out.nees += nees(e, found.cells[i].covariance) / 6;
  }
  const double n = std::max<double>(1, double(out.known));
  out.place = std::sqrt(out.place / n), out.turn = std::sqrt(out.turn / n), out.nees /= n;
  return out;
}

}  // namespace skinctl::testing
