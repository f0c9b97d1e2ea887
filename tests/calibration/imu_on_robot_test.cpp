// not sanitized: the fits of Eigen take this compiler minutes; least_squares_test holds a sample
// A real accelerometer on a real arm (`imu_on_robot`): one pose of the sensor for two recordings, from the arm's own report of its pose.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "skinctl/calibration/detail/cell_fit.hpp"
#include "skinctl/calibration/joint_motion.hpp"

using namespace skinctl;
using skinctl::detail::fit::BlockMeans;
using skinctl::detail::fit::BodySignals;

namespace {

constexpr double gravity = 9.81, block = 0.3;  // means of 0.3 s: a low-pass of 1.5 Hz

struct Arm {
  JointRecording pose;  // position [m], quaternion w x y z
  CellReadings imu;
};

// The robot's pose is held for about 66 ms: it counts where it is new.
Arm read(const std::string& file) {
  std::ifstream in(file);
  REQUIRE_MESSAGE(in.good(), file);
  std::string line;
  std::getline(in, line);
  std::vector<std::array<double, 7>> poses;
  std::vector<std::array<double, 3>> readings;
  Arm out;
  while (std::getline(in, line)) {
    std::stringstream fields(line);
    std::vector<double> v;
    for (std::string field; std::getline(fields, field, ',');) v.push_back(std::stod(field));
    REQUIRE(v.size() == 17);
    std::array<double, 7> pose{v[10] / 1e3, v[11] / 1e3, v[12] / 1e3, v[13], v[14], v[15], v[16]};
    if (!poses.empty()) {
      double same = 0;
      for (std::size_t k = 3; k < 7; ++k) same += pose[k] * poses.back()[k];
      for (std::size_t k = 3; k < 7 && same < 0; ++k) pose[k] = -pose[k];
    }
    if (poses.empty() || pose != poses.back()) poses.push_back(pose), out.pose.time.push_back(v[0]);
    if (v[1] != 0 || v[2] != 0 || v[3] != 0)
      readings.push_back({v[1], v[2], v[3]}), out.imu.time.push_back(v[0]);
  }
  out.pose.q.resize(Eigen::Index(poses.size()), 7);
  for (std::size_t k = 0; k < poses.size(); ++k)
    for (std::size_t i = 0; i < 7; ++i) out.pose.q(Eigen::Index(k), Eigen::Index(i)) = poses[k][i];
  out.imu.y.resize(3, Eigen::Index(readings.size()));
  for (std::size_t k = 0; k < readings.size(); ++k)
    for (Eigen::Index i = 0; i < 3; ++i) out.imu.y(i, Eigen::Index(k)) = readings[k][std::size_t(i)];
  return out;
}

// The flange in all recordings, one after the other. Unknown: the tilt of the robot's base (two turns), how late each
// recording's labels are.
struct FlangeMotion {
  const std::vector<MeasuredMotion>* recordings = nullptr;
  std::vector<double> times;  // of the blocks, by their labels
  std::vector<std::size_t> recording;
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  std::vector<double> late;
  bool accelerates = true, tilts = true, shifts = true;

  void hold(Eigen::VectorXd& information, Eigen::VectorXd&) const {
    if (!tilts) information.head(2).array() += 1e14;
    if (!shifts) information.tail(Eigen::Index(late.size())).array() += 1e14;
  }
  [[nodiscard]] int unknowns() const { return 2 + int(late.size()); }
  [[nodiscard]] FlangeMotion moved(const Eigen::VectorXd& d) const {
    FlangeMotion out = *this;
    out.tilt += d.head<2>();
    for (std::size_t r = 0; r < late.size(); ++r) out.late[r] += d(2 + Eigen::Index(r));
    return out;
  }
  [[nodiscard]] Eigen::Matrix<double, 12, 1> signal(const MeasuredMotion& motion, double t,
                                                    const Eigen::Vector2d& lean) const {
    const auto R = [&](double at) -> Eigen::Matrix3d {
      const Eigen::VectorXd q = motion.at(at).q;
      // As stored it turns the base into the flange.
      return Eigen::Quaterniond(q(3), -q(4), -q(5), -q(6)).normalized().toRotationMatrix();
    };
    constexpr double h = 0.01;
    const Eigen::Matrix3d now = R(t), ddR = (R(t + h) - 2 * now + R(t - h)) / (h * h);
    const Eigen::Vector3d up = turn({lean.x(), lean.y(), 0}) * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d a = motion.at(t).ddq.head<3>() / gravity;
    Eigen::Matrix<double, 12, 1> out;
    out.head<3>() = now.transpose() * (up + (accelerates ? a : Eigen::Vector3d::Zero()));
    const Eigen::Matrix3d S = now.transpose() * ddR / gravity;
    for (int i = 0; i < 3; ++i) out.segment<3>(3 + 3 * i) = (accelerates ? 1.0 : 0.0) * S.row(i).transpose();
    return out;
  }
  [[nodiscard]] std::vector<BodySignals> signals(const BlockMeans&) const {
    BodySignals out;
    for (int k = 0; k < unknowns(); ++k) out.unknowns.push_back(k);
    out.columns.setZero(Eigen::Index(times.size()), 13 + 12 * unknowns());
    out.columns.col(12).setOnes();
    constexpr double step = 1e-5, time_step = 1e-3;
    for (std::size_t k = 0; k < times.size(); ++k)
      for (int g = 0; g < 5; ++g) {  // means of five points over a block
        const MeasuredMotion& motion = (*recordings)[recording[k]];
        const double t = times[k] + 0.2 * (g - 2) * block - late[recording[k]];
        const auto now = signal(motion, t, tilt);
        auto row = out.columns.row(Eigen::Index(k));
        row.head<12>() += 0.2 * now.transpose();
        for (int i = 0; i < 2; ++i)
          row.segment<12>(13 + 12 * i) +=
              0.2 / step * (signal(motion, t, tilt + step * Eigen::Vector2d::Unit(i)) - now).transpose();
        row.segment<12>(37 + 12 * Eigen::Index(recording[k])) +=
            0.2 / time_step * (signal(motion, t - time_step, tilt) - now).transpose();
      }
    return {out};
  }
};

struct Result {
  std::vector<double> rms;  // of each recording [g]
  std::vector<double> late, late_deviation;
  double lever_deviation = 0;  // largest [m]
  Eigen::Matrix3d Q;
};

// `recordings` share one pose of the sensor.
Result fit(const std::vector<Arm>& arms, bool biases, bool scales, bool lateness, bool accelerates,
           bool tilts) {
  std::vector<MeasuredMotion> motions;
  for (const Arm& arm : arms) motions.emplace_back(arm.pose, 0.2);
  FlangeMotion motion;
  motion.recordings = &motions;
  motion.accelerates = accelerates, motion.tilts = tilts, motion.shifts = lateness;
  BlockMeans all;
  all.length = block;
  std::vector<Eigen::Vector3d> y;
  for (std::size_t r = 0; r < arms.size(); ++r) {
    motion.late.push_back(0);
    const BlockMeans own = skinctl::detail::fit::block_means({arms[r].imu}, motions[r].start() + 0.5,
                                                             motions[r].end() - 0.5, block);
    for (Eigen::Index k = 0; k < own.blocks(); ++k) {
      if (own.missing(k, 0) || motions[r].gap_within(own.middle(k) - 0.5, own.middle(k) + 0.5)) continue;
      motion.times.push_back(own.middle(k)), motion.recording.push_back(r);
      y.emplace_back(own.y.row(k).transpose());
    }
  }
  all.y.resize(Eigen::Index(y.size()), 3);
  all.missing.setConstant(Eigen::Index(y.size()), 1, false);
  for (std::size_t k = 0; k < y.size(); ++k) all.y.row(Eigen::Index(k)) = y[k].transpose();
  // Where it points at first: as gravity says.
  Eigen::Matrix3d B = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < y.size(); ++k)
    B += motion.signal(motions[motion.recording[k]], motion.times[k], {0, 0}).head<3>() * y[k].transpose();
  skinctl::detail::fit::FittedCell cell;
  cell.Q = skinctl::detail::fit::nearest_turn(B);
  cell.deviation = 0.02;
  skinctl::detail::fit::CellFitSettings settings;
  settings.steps = 60, settings.decrease = 1e-3;
  settings.bias = biases ? 0.1 : 1e-7, settings.scale = scales ? 0.05 : 1e-7;
  settings.cross_axis = scales ? 0.02 : 1e-7;
  skinctl::detail::fit::CellFit<FlangeMotion> fitted(all, motion, {cell}, {}, settings);
  fitted.run();
  fitted.weigh();
  fitted.run();
  Result out;
  const Eigen::MatrixXd r = fitted.residuals();
  out.rms.assign(arms.size(), 0);
  std::vector<double> count(arms.size(), 0);
  for (Eigen::Index k = 0; k < r.rows(); ++k) {
    const std::size_t at = motion.recording[std::size_t(k)];
    out.rms[at] += r.row(k).squaredNorm(), count[at] += 3;
  }
  for (std::size_t k = 0; k < arms.size(); ++k) out.rms[k] = std::sqrt(out.rms[k] / count[k]);
  skinctl::detail::fit::CellSolver solver;
  REQUIRE(solver.factorise(fitted.equations(), 0));
  const Eigen::MatrixXd C = solver.motion_covariance(), D = fitted.jackknife(solver);
  for (std::size_t k = 0; k < arms.size(); ++k) {
    const Eigen::Index at = 2 + Eigen::Index(k);
    out.late.push_back(fitted.motion.late[k]);
    out.late_deviation.push_back(std::sqrt(C(at, at) + D.row(at).squaredNorm()));
  }
  const Eigen::MatrixXd own = solver.cell_covariance(0, C);
  const Eigen::Index at = fitted.globals() + 3;
  const Eigen::Matrix3d P = own.block<3, 3>(3, 3) + D.middleRows<3>(at) * D.middleRows<3>(at).transpose();
  out.lever_deviation = std::sqrt(P.diagonal().maxCoeff());
  out.Q = fitted.cells[0].Q;
  return out;
}

}  // namespace

TEST_CASE("A real accelerometer on an arm: 18 mg, its labels' lateness, and a lever that is not observed") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    MESSAGE("SKIPPED: SKINCTL_DATA_DIR is not set, imu_on_robot is not read");
    return;
  }
  const std::string folder = std::string(data) + "/imu_on_robot/";
  const std::vector<Arm> arms = {read(folder + "V_300_Sequencia1_LSM9DS0.csv"),
                                 read(folder + "V_300_Sequencia3_LSM9DS0.csv")};
  const auto print = [](const char* what, const Result& r) {
    std::string text = what;
    for (std::size_t k = 0; k < r.rms.size(); ++k) {
      char part[120];
      std::snprintf(part, sizeof part, "  %.1f mg, late %.1f ms (%.1f)", r.rms[k] * 1e3, r.late[k] * 1e3,
                    r.late_deviation[k] * 1e3);
      text += part;
    }
    char lever[64];
    std::snprintf(lever, sizeof lever, "  lever to %.0f mm", r.lever_deviation * 1e3);
    text += lever;
    MESSAGE(text);
  };
  for (const Arm& arm : arms) {
    print("gravity alone:", fit({arm}, false, false, false, false, false));
    print("and lateness:", fit({arm}, false, false, true, false, false));
    print("and b, s:", fit({arm}, true, true, true, false, false));
    print("and the flange's acceleration:", fit({arm}, true, true, true, true, false));
  }
  const Result both = fit(arms, true, true, true, true, true);
  print("one pose and base tilt for both:", both);
  CHECK(both.rms[0] < 0.0165);
  CHECK(both.rms[1] < 0.0160);
  CHECK(std::abs(both.late[0] - both.late[1]) < 0.005);
  CHECK(std::abs(0.5 * (both.late[0] + both.late[1]) - 0.085) < 0.01);
  CHECK(both.lever_deviation > 0.015);
  Eigen::Matrix3d known;  // of the data's own note
  known << -.086, .996, 0, -.996, -.086, .02, .02, 0, 1;
  MESSAGE("against the known rotation: "
          << 57.3 * std::min(turn_vector(straightened(known) * both.Q).norm(),
                             turn_vector(straightened(known).transpose() * both.Q).norm())
          << " deg");
}
