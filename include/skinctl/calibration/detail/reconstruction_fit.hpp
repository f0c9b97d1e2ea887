// The fit behind `reconstruct`.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

#include "skinctl/calibration/least_squares.hpp"
#include "skinctl/calibration/reconstruction.hpp"
#include "skinctl/calibration/sparse_inverse.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Unknowns: place and turn of each cell but the root, nine sensor errors of each, two of each direction of gravity.
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
    // As little as nothing is known of a rotation: without it a cell that the data do not show makes all of the
    // inverse infinite, and not its own part.
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

/// The rotation that maps readings of `b` to those of `a`, and the rms that it leaves [g].
struct PairTurn {
  Eigen::Matrix3d R_ab = Eigen::Matrix3d::Identity();
  double rest = std::numeric_limits<double>::infinity();
  int poses = 0;
};
[[nodiscard]] inline PairTurn procrustes(const std::vector<Eigen::Vector3d>& a,
                                         const std::vector<Eigen::Vector3d>& b) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  PairTurn out;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k].allFinite() && b[k].allFinite()) M += a[k] * b[k].transpose(), ++out.poses;
  if (out.poses < 3) return out;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  out.R_ab = U * svd.matrixV().transpose();
  if (out.R_ab.col(0).cross(out.R_ab.col(1)).dot(out.R_ab.col(2)) < 0) {  // a mirror
    U.col(2) *= -1;
    out.R_ab = U * svd.matrixV().transpose();
  }
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k].allFinite() && b[k].allFinite()) sum += (a[k] - out.R_ab * b[k]).squaredNorm();
  out.rest = std::sqrt(sum / out.poses);
  return out;
}

SKINCTL_COLD inline void require_patch(const PatchGraph& patch, const RestReadings& readings,
                                       const ReconstructionSettings& s) {
  require(!patch.ids.empty(), "reconstruction: cells", 0, ">= 1");
  require(readings.size() == patch.ids.size(), "reconstruction: cells with readings", double(readings.size()),
          "as many as the patch has");
  const std::size_t poses = readings.front().size();
  require(poses >= 3 && poses <= 1000, "reconstruction: poses", double(poses), "3 to 1000");
  for (const auto& y : readings)
    require(y.size() == poses, "reconstruction: poses of a cell", double(y.size()), "as of the first");
  require(s.reading > 0 && s.reading < 1, "reconstruction: reading", s.reading, "0 to 1 g");
  require(s.gap > 0 && s.gap < 0.1, "reconstruction: gap", s.gap, "0 to 0.1 m");
  require(s.prior.bias > 0 && s.prior.scale > 0 && s.prior.misalignment > 0, "reconstruction: prior", 0,
          "> 0");
  for (const auto& j : patch.joints)
    require(j.a < patch.ids.size() && j.b < patch.ids.size() && j.port_a < 4 && j.port_b < 4,
            "reconstruction: connector of cell", double(j.a), "between ports of its cells");
}

/// What a fit starts from: cells that are no use are marked, and the largest piece without them is laid out.
struct PatchStart {
  std::vector<ReconstructedCell> cells;
  std::vector<std::size_t> used;          // indices of the cells of the piece, its root first
  std::vector<PatchGraph::Joint> joints;  // between these, by their place in `used`
};
[[nodiscard]] inline PatchStart patch_start(const PatchGraph& patch, const RestReadings& readings,
                                            const ReconstructionSettings& s) {
  PatchStart out;
  const std::size_t n = patch.ids.size();
  std::vector<bool> usable(n, true);
  for (std::size_t i = 0; i < n; ++i) {
    auto& cell = out.cells.emplace_back();
    cell.id = patch.ids[i];
    int poses = 0;
    double worst = 0;
    for (const auto& y : readings[i])
      if (y.allFinite()) ++poses, worst = std::max(worst, std::abs(y.norm() - 1));
    if (poses < 3)
      cell.unknown = "was recorded in " + std::to_string(poses) + " poses: three are needed";
    else if (worst > 0.2)
      cell.unknown = "reads up to " + std::to_string(1 + worst).substr(0, 4) +
                     " g off or on 1 g: it was not at rest, or its accelerometer is broken";
    usable[i] = cell.unknown.empty();
  }
  // Two cells on one body turn alike, to within what the errors of their sensors explain.
  const double alike = 5 * std::sqrt(2.0) * s.prior.bias + 4 * s.prior.scale + 4 * s.reading;
  std::vector<PairTurn> pair(patch.joints.size());
  std::vector<std::vector<std::size_t>> at(n);
  for (std::size_t j = 0; j < patch.joints.size(); ++j) {
    const auto& joint = patch.joints[j];
    if (!usable[joint.a] || !usable[joint.b]) continue;
    pair[j] = procrustes(readings[joint.a], readings[joint.b]);
    if (pair[j].rest < alike) at[joint.a].push_back(j), at[joint.b].push_back(j);
  }
  std::vector<bool> seen(n, false);
  for (std::size_t root = 0; root < n; ++root) {
    if (!usable[root] || seen[root]) continue;
    std::vector<std::size_t> piece = {root};
    seen[root] = true;
    out.cells[root].R.setIdentity(), out.cells[root].p.setZero();
    for (std::size_t q = 0; q < piece.size(); ++q)
      for (const std::size_t j : at[piece[q]]) {
        const auto& joint = patch.joints[j];
        const bool forward = joint.a == piece[q];
        const std::size_t from = piece[q], to = forward ? joint.b : joint.a;
        if (seen[to]) continue;
        seen[to] = true;
        piece.push_back(to);
        auto &c = out.cells[to], &base = out.cells[from];
        c.R = base.R * (forward ? pair[j].R_ab : Eigen::Matrix3d(pair[j].R_ab.transpose()));
        c.p = base.p + base.R * s.ports[forward ? joint.port_a : joint.port_b] -
              c.R * s.ports[forward ? joint.port_b : joint.port_a];
      }
    if (piece.size() > out.used.size()) out.used.swap(piece);
  }
  std::vector<std::size_t> place(n, n);
  for (std::size_t q = 0; q < out.used.size(); ++q) place[out.used[q]] = q;
  for (std::size_t j = 0; j < patch.joints.size(); ++j) {
    const auto& joint = patch.joints[j];
    if (place[joint.a] < n && place[joint.b] < n && pair[j].rest < alike)
      out.joints.push_back({place[joint.a], place[joint.b], joint.port_a, joint.port_b});
  }
  for (std::size_t i = 0; i < n; ++i)
    if (usable[i] && place[i] == n)
      out.cells[i].unknown =
          n == 1 ? "" : "does not turn with its neighbours: it lies, or a cable joins it to another link";
  return out;
}

/// How the poses of a fit scatter once the patch as a whole is aligned. Cells that are not known have no part in the alignment.
inline void aligned_covariances(const PatchFit& fit, const SparseNormal& normal,
                                std::vector<ReconstructedCell>& cells, const ReconstructionSettings& s) {
  const SparseNormal::Matrix H = normal.information();
  const SparseInverse C(H);
  const SparseNormal::Solver solver(H);
  const std::size_t n = cells.size();
  using Matrix = Eigen::MatrixXd;
  const auto motion = [&](std::size_t i) {  // of a cell when the patch moves: place, turn in its axes
    Matrix G = Matrix::Identity(6, 6);
    const Eigen::Matrix3d across = cross_matrix(cells[i].p);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) G(r, 3 + c) = -across(r, c), G(3 + r, 3 + c) = cells[i].R(c, r);
    return G;
  };
  const double place = 1 / (3e-4 * 3e-4), angle = 1 / (0.0174 * 0.0174);
  std::vector<bool> out(n, false);
  for (int round = 0; round < 6; ++round) {
    Matrix A = Matrix::Zero(6, 6), right = Matrix::Zero(H.rows(), 6);
    for (std::size_t i = 0; i < n; ++i) {
      if (out[i]) continue;
      const Matrix G = motion(i);
      Matrix WG = G;
      for (int r = 0; r < 6; ++r) WG.row(r) *= r < 3 ? place : angle;
      A += G.transpose() * WG;
      if (const int at = fit.pose_column(i); at >= 0) right.middleRows(at, 6) = WG;
    }
    const Matrix aligned = right * solve_symmetric(A, Matrix::Identity(6, 6));  // the alignment is aligned' e
    const Matrix with = solver.solve(aligned);
    const Matrix own = aligned.transpose() * with;
    std::vector<double> score(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Matrix G = motion(i), G_own = G * own;
      Matrix cov = G_own * G.transpose();
      if (const int at = fit.pose_column(i); at >= 0) {
        const Matrix part = with.middleRows(at, 6), cross = part * G.transpose(),
                     block = C.block(at, 6, at, 6);
        for (int c = 0; c < 6; ++c)
          for (int r = 0; r < 6; ++r) cov(r, c) += block(r, c) - cross(r, c) - cross(c, r);
      }
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) cells[i].covariance(r, c) = 0.5 * (cov(r, c) + cov(c, r));
      score[i] =
          std::max(cells[i].place_deviation() / s.place_limit, cells[i].turn_deviation() / s.turn_limit);
    }
    auto sorted = score;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(n / 2), sorted.end());
    const double limit = std::max(1.0, 1.5 * sorted[n / 2]);
    bool more = false;
    for (std::size_t i = 0; i < n; ++i)
      if (!out[i] && !(score[i] <= limit)) out[i] = more = true;
    if (!more) break;
  }
}

}  // namespace detail

inline Reconstruction procrustes_chain(const PatchGraph& patch, const RestReadings& readings,
                                       const ReconstructionSettings& s) {
  detail::require_patch(patch, readings, s);
  Reconstruction out;
  out.cells = detail::patch_start(patch, readings, s).cells;
  for (const auto& c : out.cells)
    if (!c.unknown.empty()) out.unobservable.push_back({"cell " + std::to_string(c.id) + " " + c.unknown});
  return out;
}

inline Reconstruction reconstruct(const PatchGraph& patch, const RestReadings& readings,
                                  const ReconstructionSettings& s) {
  detail::require_patch(patch, readings, s);
  auto start = detail::patch_start(patch, readings, s);
  Reconstruction out;
  const auto finish = [&] {
    out.cells = std::move(start.cells);
    for (const auto& c : out.cells)
      if (!c.unknown.empty())
        out.unobservable.push_back({"cell " + std::to_string(c.id) + " " + c.unknown, c.turn_deviation(),
                                    "rad", "rest in poses that tilt it about other axes"});
    return out;
  };
  if (start.used.empty()) return finish();

  std::vector<ReconstructedCell> cells;
  RestReadings used;
  std::vector<Eigen::Matrix3d> turns;
  for (const std::size_t i : start.used) {
    cells.push_back(start.cells[i]);
    used.push_back(readings[i]);
    turns.push_back(start.cells[i].R);
  }
  std::vector<Eigen::Vector3d> up(readings.front().size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t k = 0; k < up.size(); ++k)
      if (used[i][k].allFinite()) up[k] += cells[i].R * used[i][k];
  for (auto& u : up) u = u.norm() > 1e-3 ? u.normalized() : Eigen::Vector3d::UnitZ();
  const detail::PatchFit problem{start.joints, used, s, turns};
  auto fit = least_squares<SparseNormal>(problem, {std::move(cells), std::move(up)}, {.steps = 60});
  out.end = fit.end;
  out.steps = fit.steps;
  if (fit.end == FitEnd::not_finite) {
    for (const std::size_t i : start.used) start.cells[i].unknown = "has readings that are no numbers";
    return finish();
  }
  detail::aligned_covariances(problem, fit.normal, fit.state.cells, s);
  double squares = 0, count = 0;
  for (std::size_t q = 0; q < start.used.size(); ++q) {
    auto& cell = fit.state.cells[q];
    double own = 0, readings_of_it = 0;
    for (std::size_t k = 0; k < fit.state.up.size(); ++k)
      if (used[q][k].allFinite()) {
        own += (reading(cell.R, cell.errors, fit.state.up[k]) - used[q][k]).squaredNorm();
        readings_of_it += 3;
      }
    squares += own, count += readings_of_it;
    const auto text = [](double x) {
      char buffer[32];
      std::snprintf(buffer, sizeof buffer, "%.2g", x);
      return std::string(buffer);
    };
    const double turn_off = cell.turn_deviation(), place_off = cell.place_deviation();
    if (std::sqrt(own / readings_of_it) > 8 * s.reading)
      cell.unknown = "has readings that contradict its neighbours by " +
                     text(1e3 * std::sqrt(own / readings_of_it)) + " mg";
    else if (!(turn_off <= s.turn_limit))
      cell.unknown =
          "is turned by an unknown angle: to " + text(std::min(180.0, turn_off / 0.0174532925)) + " deg only";
    else if (!(place_off <= s.place_limit))
      cell.unknown = "is at a place known to " + text(1e3 * place_off) + " mm only";
    start.cells[start.used[q]] = cell;
  }
  out.residual = std::sqrt(squares / std::max(1.0, count));
  out.up = fit.state.up;
  return finish();
}

SKINCTL_END_NAMESPACE
