#include "support/ceres_oracle.hpp"

#include <ceres/loss_function.h>
#include <ceres/numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

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

bool ceres_sightings(const std::array<double, 4>& camera, const std::vector<PlainSighting>& lights,
                     double pixel, double width, std::vector<PlainPose>& poses) {
  std::vector<Block> blocks;
  for (const auto& X : poses) blocks.push_back(block_of(X));
  ceres::Problem problem;
  for (const auto& seen : lights)
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<Light, ceres::CENTRAL, 2, 6, 6>(new Light{camera, seen, pixel}),
        new ceres::CauchyLoss(width), blocks[0].data(), blocks[1 + seen.patch].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (std::size_t i = 0; i < blocks.size(); ++i) poses[i] = pose_of(blocks[i]);
  return summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace oracle
