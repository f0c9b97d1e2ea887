#include "examples/show_skin/unrolled.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace show_skin {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Eigen::Vector3d mean(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}
/// Axes by how much the points spread along them, the least first.
Eigen::Matrix3d spread(const Points& points, const Eigen::Vector3d& about) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (const auto& p : points) m += (p - about) * (p - about).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m).eigenvectors();
}
/// Distance of most neighbours.
double pitch_of(const Points& p) {
  std::vector<double> nearest;
  for (std::size_t i = 0; i < p.size(); ++i) {
    double least = 1e9;
    for (std::size_t k = 0; k < p.size(); ++k)
      if (k != i) least = std::min(least, (p[i] - p[k]).norm());
    nearest.push_back(least);
  }
  std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2),
                   nearest.end());
  return std::clamp(nearest[nearest.size() / 2], 1e-4, 1.0);
}

}  // namespace

Layout unrolled(const skinctl::SkinFile::Patch& patch) {
  Points at, normals;
  for (const auto& cell : patch.cells) {
    const auto& p = cell.X_RootCell.p;
    const auto R = cell.X_RootCell.rotation();
    at.emplace_back(p.x, p.y, p.z);
    normals.emplace_back(R.z.x, R.z.y, R.z.z);
  }
  Layout out;
  if (at.empty()) return out;
  const Eigen::Vector3d middle = mean(at), outward = mean(normals);
  const double pitch = at.size() > 1 ? pitch_of(at) : 0.03;
  std::vector<Eigen::Vector2d> flat;  // along the rows, across them
  if (outward.norm() > std::cos(std::numbers::pi / 12)) {
    const Eigen::Matrix3d axes = spread(at, middle);
    for (const auto& p : at) flat.emplace_back(axes.col(2).dot(p - middle), axes.col(1).dot(p - middle));
  } else {
    const Eigen::Vector3d axis = spread(normals, Eigen::Vector3d::Zero()).col(0);
    const Eigen::Vector3d x = axis.unitOrthogonal(), y = axis.cross(x);
    // The axis is where the normals meet: least squares of p - r n - c across the axis.
    Eigen::MatrixXd A(2 * at.size(), 3);
    Eigen::VectorXd b(2 * at.size());
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(at.size()); ++i) {
      const auto k = static_cast<std::size_t>(i);
      A.row(2 * i) << 1, 0, x.dot(normals[k]);
      A.row(2 * i + 1) << 0, 1, y.dot(normals[k]);
      b.segment(2 * i, 2) << x.dot(at[k]), y.dot(at[k]);
    }
    const Eigen::VectorXd solution = A.completeOrthogonalDecomposition().solve(b);
    const double radius = std::max(std::abs(solution[2]), pitch / 2);
    for (std::size_t k = 0; k < at.size(); ++k)
      flat.emplace_back(axis.dot(at[k]), radius * std::atan2(y.dot(normals[k]), x.dot(normals[k])));
  }
  // Cells of a row differ little across it: rows are as far apart as cells of a hexagonal patch are.
  Eigen::Vector2d least = flat[0];
  for (const auto& f : flat) least = least.cwiseMin(f);
  std::set<std::pair<int, int>> taken;
  for (const auto& f : flat) {
    const Eigen::Vector2d from = (f - least) / pitch;
    Place place{static_cast<int>(std::lround(from.y() / 0.87)), static_cast<int>(std::lround(2 * from.x()))};
    while (!taken.insert({place.row, place.column}).second) ++place.column;
    out.cells.push_back(place);
    out.rows = std::max(out.rows, place.row + 1);
    out.columns = std::max(out.columns, place.column + 1);
  }
  return out;
}

}  // namespace show_skin
