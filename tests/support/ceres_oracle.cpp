#include "support/ceres_oracle.hpp"

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>

namespace oracle {

namespace {

using Block = std::array<double, 6>;  // place, rotation vector

Block block_of(const PlainPose& X) {
  Block b{X[9], X[10], X[11]};
  double columns[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) columns[3 * j + i] = X[std::size_t(3 * i + j)];
  ceres::RotationMatrixToAngleAxis(columns, b.data() + 3);
  return b;
}
PlainPose pose_of(const Block& b) {
  PlainPose X{};
  double columns[9];
  ceres::AngleAxisToRotationMatrix(b.data() + 3, columns);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) X[std::size_t(3 * i + j)] = columns[3 * j + i];
  for (std::size_t i = 0; i < 3; ++i) X[9 + i] = b[i];
  return X;
}

struct Light {
  std::array<double, 4> camera;
  PlainSighting seen;
  double deviation;

  bool operator()(const double* const X_BaseCam, const double* const X_LinkRoot, double* residual) const {
    double on_link[3], away[3], in_camera[3];
    ceres::AngleAxisRotatePoint(X_LinkRoot + 3, seen.in_patch.data(), on_link);
    for (int i = 0; i < 3; ++i) on_link[i] += X_LinkRoot[i];
    const auto& X = seen.X_BaseLink;
    for (std::size_t i = 0; i < 3; ++i)
      away[i] = X[3 * i] * on_link[0] + X[3 * i + 1] * on_link[1] + X[3 * i + 2] * on_link[2] + X[9 + i] -
                X_BaseCam[i];
    const double back[3] = {-X_BaseCam[3], -X_BaseCam[4], -X_BaseCam[5]};
    ceres::AngleAxisRotatePoint(back, away, in_camera);
    residual[0] = (camera[0] * in_camera[0] / in_camera[2] + camera[2] - seen.pixel[0]) / deviation;
    residual[1] = (camera[1] * in_camera[1] / in_camera[2] + camera[3] - seen.pixel[1]) / deviation;
    return in_camera[2] > 0.02;
  }
};

}  // namespace

namespace {

// A cell: place, rotation vector, bias, scale, misalignment.
using Cell = std::array<double, 15>;

struct AtRest {
  std::array<double, 3> read;
  double deviation;

  bool operator()(const double* const cell, const double* const up, double* residual) const {
    const double norm = std::sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
    const double force[3] = {up[0] / norm, up[1] / norm, up[2] / norm};
    const double back[3] = {-cell[3], -cell[4], -cell[5]}, aside[3] = {-cell[12], -cell[13], -cell[14]};
    double in_cell[3], in_sensor[3];
    ceres::AngleAxisRotatePoint(back, force, in_cell);
    ceres::AngleAxisRotatePoint(aside, in_cell, in_sensor);
    for (std::size_t i = 0; i < 3; ++i)
      residual[i] = ((1 + cell[9 + i]) * in_sensor[i] + cell[6 + i] - read[i]) / deviation;
    return norm > 1e-3;
  }
};
struct Joined {
  PlainPatch::Joint joint;
  double deviation;

  bool operator()(const double* const a, const double* const b, double* residual) const {
    double at_a[3], at_b[3];
    ceres::AngleAxisRotatePoint(a + 3, joint.port_a.data(), at_a);
    ceres::AngleAxisRotatePoint(b + 3, joint.port_b.data(), at_b);
    for (int i = 0; i < 3; ++i) residual[i] = (a[i] + at_a[i] - b[i] - at_b[i]) / deviation;
    return true;
  }
};
struct SensorPrior {
  double bias, scale, misalignment;

  bool operator()(const double* const cell, double* residual) const {
    for (int i = 0; i < 3; ++i) {
      residual[i] = cell[6 + i] / bias;
      residual[3 + i] = cell[9 + i] / scale;
      residual[6 + i] = cell[12 + i] / misalignment;
    }
    return true;
  }
};
// The length of an upward vector means nothing: it is kept at 1.
struct Unit {
  bool operator()(const double* const up, double* residual) const {
    residual[0] = up[0] * up[0] + up[1] * up[1] + up[2] * up[2] - 1;
    return true;
  }
};

ceres::Solver::Options strict() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

bool ceres_patch(const PlainPatch& patch, std::vector<PlainPose>& cells,
                 std::vector<std::array<double, 3>>& up) {
  std::vector<Cell> blocks;
  for (const auto& X : cells) {
    const Block pose = block_of(X);
    Cell& cell = blocks.emplace_back();
    std::copy(pose.begin(), pose.end(), cell.begin());
  }
  ceres::Problem problem;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t k = 0; k < up.size(); ++k)
      problem.AddResidualBlock(new ceres::NumericDiffCostFunction<AtRest, ceres::CENTRAL, 3, 15, 3>(
                                   new AtRest{patch.readings[i][k], patch.reading}),
                               new ceres::HuberLoss(5), blocks[i].data(), up[k].data());
    problem.AddResidualBlock(new ceres::NumericDiffCostFunction<SensorPrior, ceres::CENTRAL, 9, 15>(
                                 new SensorPrior{patch.bias, patch.scale, patch.misalignment}),
                             nullptr, blocks[i].data());
  }
  for (auto& u : up)
    problem.AddResidualBlock(new ceres::NumericDiffCostFunction<Unit, ceres::CENTRAL, 1, 3>(new Unit),
                             nullptr, u.data());
  for (const auto& joint : patch.joints)
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<Joined, ceres::CENTRAL, 3, 15, 15>(new Joined{joint, patch.gap}),
        nullptr, blocks[joint.a].data(), blocks[joint.b].data());
  problem.SetManifold(blocks[0].data(), new ceres::SubsetManifold(15, {0, 1, 2, 3, 4, 5}));
  ceres::Solver::Summary summary;
  ceres::Solve(strict(), &problem, &summary);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    Block pose{};
    std::copy(blocks[i].begin(), blocks[i].begin() + 6, pose.begin());
    cells[i] = pose_of(pose);
  }
  return summary.termination_type == ceres::CONVERGENCE;
}

bool ceres_sightings(const std::array<double, 4>& camera, const std::vector<PlainSighting>& lights,
                     double pixel, double width, std::vector<PlainPose>& poses) {
  std::vector<Block> blocks;
  for (const auto& X : poses) blocks.push_back(block_of(X));
  ceres::Problem problem;
  for (const auto& seen : lights)
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<Light, ceres::CENTRAL, 2, 6, 6>(new Light{camera, seen, pixel}),
        new ceres::CauchyLoss(width), blocks[0].data(), blocks[1 + seen.patch].data());
  ceres::Solver::Summary summary;
  ceres::Solve(strict(), &problem, &summary);
  for (std::size_t i = 0; i < blocks.size(); ++i) poses[i] = pose_of(blocks[i]);
  return summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace oracle
