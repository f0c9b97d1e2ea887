// What encoders and the accelerometers of a skin report of a moving robot: a generator.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "skinctl/calibration/joint_lines_types.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// A cell where it truly is.
struct TrueCell {
  int link = 0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();       ///< axes of the cell in the link
  Eigen::Vector3d p = Eigen::Vector3d::Zero();           ///< in the link [m]
  Eigen::Matrix3d sensor = Eigen::Matrix3d::Identity();  ///< axes of the accelerometer in the link
  Eigen::Vector3d bias = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross_axis = Eigen::Matrix3d::Zero();
};

/// How the sensors of a moved skin err.
struct MovedSkinSettings {
  double noise = 0.009, step = 1.0 / 256;    ///< of an axis [g]
  double bias = 0.040, scale = 0.015;        ///< standard deviations [g], [1]
  double misalignment = 0.2 * 0.0174532925;  ///< of a sensor in its cell, an axis [rad]
  double cross_axis = 0.003;                 ///< standard deviation
  double vibration = 0.020;                  ///< of a link, 8 to 15 Hz, amplitude [g]
  double compliance = 5e-5;                  ///< of the joints [rad/(N m)]
  double late = 0.007;                       ///< labels [s]
  double encoder_rate = 125;                 ///< [Hz]; cells have 250 Hz
  double encoder_noise = 1e-5;               ///< [rad]
  bool torques = true;                       ///< they are recorded, too
  double torque_error = 0.1,
         torque_noise = 0.5;  ///< standard deviations: of a joint's factor, of a sample [N m]
  double gravity = 9.80665;   ///< [m/s^2]
  double loss = 0;            ///< share of the samples that do not come
  Eigen::Matrix3d base = Eigen::Matrix3d::Identity();  ///< axes of the robot's base in the upright world

  /// Sensors without any error on a stiff robot.
  [[nodiscard]] static MovedSkinSettings ideal() {
    MovedSkinSettings s;
    s.noise = s.step = s.bias = s.scale = s.misalignment = s.cross_axis = s.vibration = s.compliance =
        s.late = 0;
    s.encoder_noise = 1e-9;
    return s;
  }
};

/// Gives a cell sensors' errors.
inline void add_errors(TrueCell& cell, const MovedSkinSettings& s, Random& rng) {
  std::normal_distribution<double> normal;
  const auto three = [&](double size) {
    const double x = normal(rng), y = normal(rng), z = normal(rng);
    return Eigen::Vector3d(size * x, size * y, size * z);
  };
  cell.sensor = cell.R * turn(three(s.misalignment));
  cell.bias = three(s.bias), cell.scale = three(s.scale);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) cell.cross_axis(i, k) = i == k ? 0 : s.cross_axis * normal(rng);
}

/// Records a motion. Links' poses are differenced twice: nothing is shared with the recursion that is judged
/// by it.
/// @param motion  the joints' `JointPoint` at a time, from 0.4 s before 0 to 0.4 s after `duration`.
template <RobotModel M, class Motion>
[[nodiscard]] MotionRecording record_motion(const M& model, const Motion& motion, double duration,
                                            const std::vector<TrueCell>& cells, const MovedSkinSettings& s,
                                            std::uint64_t seed) {
  constexpr std::size_t N = M::joints;
  constexpr double tick = 0.001, before = 0.4;
  constexpr int span = 2;
  Random rng = seeded(seed);
  std::normal_distribution<double> normal;
  struct Pose {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
  };
  const auto grid = std::size_t((duration + 2 * before) / tick);
  std::vector<std::array<Pose, N>> poses(grid);
  MotionRecording out;
  std::vector<Eigen::VectorXd> encoders, torques;
  Eigen::VectorXd factor(N);
  for (double& x : factor) x = 1 + s.torque_error * normal(rng);
  const auto per_encoder = std::size_t(std::lround(1 / (tick * s.encoder_rate)));
  for (std::size_t i = 0; i < grid; ++i) {
    const double t = tick * double(i) - before;
    const JointPoint p = motion(t);
    JointPosition<N> q;
    JointVelocity<N> dq;
    JointAcceleration<N> ddq;
    for (std::size_t j = 0; j < N; ++j)
      q[j] = p.q(Eigen::Index(j)), dq[j] = p.dq(Eigen::Index(j)), ddq[j] = p.ddq(Eigen::Index(j));
    if (i % per_encoder == 0) {
      Eigen::VectorXd e = p.q;
      for (std::size_t j = 0; j < N; ++j) e(Eigen::Index(j)) += s.encoder_noise * normal(rng);
      out.joints.time.push_back(t), encoders.push_back(e);
    }
    if (s.compliance > 0) {
      const auto tau = yr_theta(model, q, dq, dq, ddq);
      if (i % per_encoder == 0) {
        torques.emplace_back(N);
        for (std::size_t j = 0; j < N; ++j)
          torques.back()(Eigen::Index(j)) = factor(Eigen::Index(j)) * tau[j] + s.torque_noise * normal(rng);
      }
      for (std::size_t j = 0; j < N; ++j) q[j] -= s.compliance * tau[j];
    }
    const auto at = link_poses(model, q);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((poses[i][I] = Pose{at.template get<I>().rotation(), at.template get<I>().translation()}), ...);
    }(std::make_index_sequence<N>{});
  }
  out.joints.q.resize(Eigen::Index(encoders.size()), Eigen::Index(N));
  for (std::size_t k = 0; k < encoders.size(); ++k)
    out.joints.q.row(Eigen::Index(k)) = encoders[k].transpose();

  if (s.torques && !torques.empty()) {
    out.torque.resize(out.joints.q.rows(), Eigen::Index(N));
    for (std::size_t k = 0; k < torques.size(); ++k) out.torque.row(Eigen::Index(k)) = torques[k].transpose();
  }
  struct Shake {
    double rate, phase, sway;
    Eigen::Vector3d direction;
  };
  std::vector<std::vector<Shake>> shakes(N);
  for (auto& link : shakes)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d(normal(rng), normal(rng), normal(rng));
      link.push_back({6.2831853 * uniform(rng, 8.0, 15.0), uniform(rng, 0.0, 6.28), uniform(rng, 0.0, 6.28),
                      s.vibration / std::sqrt(3.0) * d.normalized()});
    }
  out.cells.resize(cells.size());
  std::vector<int> phase;
  for (std::size_t c = 0; c < cells.size(); ++c) phase.push_back(int(rng() % 4));
  const Eigen::Vector3d gravity = s.base.transpose() * Eigen::Vector3d(0, 0, -s.gravity);
  std::array<Eigen::Matrix3d, N> S;
  std::array<Eigen::Vector3d, N> A;
  for (int ph = 0; ph < 4; ++ph)
    for (std::size_t i = std::size_t(ph) + 2 * span; i + 2 * span < grid; i += 4) {
      const double t = tick * double(i) - before;
      if (t < -0.3 || t > duration + 0.3) continue;
      for (std::size_t l = 0; l < N; ++l) {
        const auto at = [&](int k) -> const Pose& { return poses[std::size_t(long(i) + k * span)][l]; };
        const double per = 1 / (12 * span * span * tick * tick);
        const Eigen::Matrix3d ddR = per * (16 * (at(1).R + at(-1).R) - 30 * at(0).R - at(2).R - at(-2).R);
        const Eigen::Vector3d ddp = per * (16 * (at(1).p + at(-1).p) - 30 * at(0).p - at(2).p - at(-2).p);
        S[l] = at(0).R.transpose() * ddR / s.gravity;
        A[l] = at(0).R.transpose() * (ddp - gravity) / s.gravity;
        for (const Shake& shake : shakes[l])
          A[l] +=
              std::sin(shake.rate * t + 3 * std::sin(0.6 * t + shake.sway) + shake.phase) * shake.direction;
      }
      for (std::size_t c = 0; c < cells.size(); ++c) {
        if (phase[c] != ph) continue;
        const TrueCell& cell = cells[c];
        const auto l = std::size_t(cell.link);
        const Eigen::Vector3d f = cell.sensor.transpose() * (A[l] + S[l] * cell.p);
        Eigen::Vector3d y =
            (Eigen::Vector3d::Ones() + cell.scale).cwiseProduct(f + cell.cross_axis * f) + cell.bias;
        for (int k = 0; k < 3; ++k) {
          y(k) += s.noise * normal(rng);
          if (s.step > 0) y(k) = s.step * std::round(y(k) / s.step);
        }
        if (s.loss > 0 && uniform(rng, 0.0, 1.0) < s.loss) continue;
        auto& to = out.cells[c];
        to.time.push_back(t + s.late);
        const auto n = Eigen::Index(to.time.size());
        if (to.y.cols() < n) to.y.conservativeResize(3, std::max<Eigen::Index>(2 * n, 1024));
        to.y.col(n - 1) = y;
      }
    }
  for (auto& cell : out.cells) cell.y.conservativeResize(3, Eigen::Index(cell.time.size()));
  return out;
}

/// The places of cells in patches as a reconstruction gives them: the first cell of each patch is its root.
[[nodiscard]] inline std::vector<CellInPatch> reconstructed_places(const std::vector<TrueCell>& cells,
                                                                   const std::vector<int>& patch,
                                                                   double position, double angle,
                                                                   Random& rng) {
  std::normal_distribution<double> normal;
  std::vector<CellInPatch> out;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    std::size_t root = 0;
    while (patch[root] != patch[c]) ++root;
    CellInPatch place;
    place.patch = patch[c];
    const Eigen::Vector3d d(normal(rng), normal(rng), normal(rng)), r(normal(rng), normal(rng), normal(rng));
    place.R = cells[root].R.transpose() * cells[c].R * turn(angle * r);
    place.p = cells[root].R.transpose() * (cells[c].p - cells[root].p) + position * d;
    out.push_back(place);
  }
  return out;
}

}  // namespace skinctl::testing
