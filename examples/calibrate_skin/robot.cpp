#include "examples/calibrate_skin/robot.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/calibration/excitation.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/random.hpp"

#ifdef CALIBRATE_SKIN_HAS_URDF
#include "skinctl/io/urdf.hpp"
#endif

namespace calibrate_skin {

using namespace skinctl;

namespace {

/// Poses and motions by a model. With `masses` the motion keeps the limits of torque.
template <class M>
void move_by(Robot& robot, const M& model, const ExcitationLimits& limits, bool masses) {
  robot.link_poses = [model](const JointAngles& q) {
    JointPosition<M::joints> position;
    for (std::size_t i = 0; i < M::joints; ++i) position[i] = q.at(i);
    const auto at = link_poses(model, position);
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return std::vector<FitPose>{{at.template get<I>().rotation(), at.template get<I>().translation()}...};
    }(std::make_index_sequence<M::joints>{});
  };
  // Half of the jerk for the fastest sine, of 2.5 Hz; the rest for the sweep.
  const double wiggle = std::min(1.0, 0.5 * robot.jerk / (15.7 * 15.7));
  robot.sweeping = [model, limits, masses, wiggle, home = robot.home](double sweep) {
    const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(home.data(), Eigen::Index(home.size()));
    SkinExcitation::Settings s;
    s.sweep = sweep, s.wiggle = wiggle;
    const SkinExcitation motion =
        masses ? SkinExcitation(at, limits, s, model) : SkinExcitation(at, limits, s);
    PlannedMotion out{[motion](double t) { return motion.at(t); }, motion.duration(), {}};
    for (const auto& a : motion.announcements()) out.announcements.push_back(a.text);
    return out;
  };
}

double largest_jerk(const PlannedMotion& motion) {
  constexpr double h = 0.004;
  double out = 0;
  Eigen::VectorXd before = motion.path(0).ddq;
  for (double t = h; t < motion.duration; t += h) {
    const Eigen::VectorXd now = motion.path(t).ddq;
    out = std::max(out, (now - before).cwiseAbs().maxCoeff() / h);
    before = now;
  }
  return out;
}

}  // namespace

double Robot::lowest_point(const JointAngles& q) const {
  const auto X = link_poses(q);
  double low = 1e9;
  for (const Point& at : points) low = std::min(low, (X[at.link] * at.p).z());
  return low;
}

double Robot::lowest_point(const PlannedMotion& motion, double step) const {
  double low = 1e9;
  for (double t = 0; t < motion.duration; t += step) {
    const Eigen::VectorXd q = motion.path(t).q;
    low = std::min(low, lowest_point(JointAngles(q.data(), q.data() + q.size())));
  }
  return low;
}

bool Robot::clear_way(const JointAngles& from, const JointAngles& to) const {
  for (int k = 0; k <= 16; ++k) {
    JointAngles q = from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += k / 16.0 * (to[i] - from[i]);
    if (lowest_point(q) < clearance) return false;
  }
  return true;
}

PlannedMotion Robot::excitation() const {
  double low = 0, sharpest = 0;
  for (double sweep = 1; sweep > 0.1; sweep *= 0.8) {
    PlannedMotion planned = sweeping(sweep);
    low = lowest_point(planned, 0.05), sharpest = largest_jerk(planned);
    if (low < clearance || sharpest > jerk) continue;
    planned.announcements.push_back(
        examples::text("elbow, wrists and flange come as low as %.2f m above the robot's foot", low));
    return planned;
  }
  require(sharpest <= jerk, "jerk of the motion [rad/s^3]", sharpest, "that of --jerk");
  require(false, "height of elbow, wrists and flange in the motion", low, ">= 0.1 m: choose another home");
  return {};
}

std::vector<JointAngles> Robot::rest_poses(std::uint64_t seed) const {
  auto rng = testing::seeded(seed + 100);
  std::vector<JointAngles> out;
  std::vector<Eigen::Matrix3d> spread(joints(), 1e-3 * Eigen::Matrix3d::Identity());
  std::vector<Eigen::Vector3d> sum(joints(), Eigen::Vector3d::Zero());
  for (int k = 0; k < 8; ++k) {
    double best = -1e300;
    JointAngles chosen = home;
    for (int tries = 0; tries < 400; ++tries) {
      JointAngles q = home;
      for (std::size_t j = 1; j < q.size(); ++j)
        q[j] += testing::uniform<double>(rng, std::max(-1.6, lower[j] - home[j]),
                                         std::min(1.6, upper[j] - home[j]));
      if (!clear_way(out.empty() ? home : out.back(), q) || !clear_way(q, home)) continue;
      const auto X = link_poses(q);
      double value = 0;
      for (std::size_t l = 1; l < q.size(); ++l) {
        const Eigen::Vector3d up = X[l].R.row(2).transpose();
        value +=
            std::log((spread[l] + up * up.transpose()).determinant()) - 0.3 * (sum[l] + up).squaredNorm();
      }
      if (value > best) best = value, chosen = q;
    }
    out.push_back(chosen);
    const auto X = link_poses(chosen);
    for (std::size_t l = 0; l < joints(); ++l) {
      const Eigen::Vector3d up = X[l].R.row(2).transpose();
      spread[l] += up * up.transpose(), sum[l] += up;
    }
  }
  return out;
}

std::vector<JointAngles> Robot::camera_poses(std::uint64_t seed) const {
  auto rng = testing::seeded(seed + 3);
  std::vector<JointAngles> out;
  for (int tries = 0; out.size() < 16; ++tries) {
    require(tries < 100000, "poses for the camera that stay above the foot", double(out.size()), "16");
    JointAngles q = home;
    for (std::size_t j = 0; j < q.size(); ++j)
      q[j] += testing::uniform<double>(rng, std::max(-1.3, lower[j] - home[j]),
                                       std::min(1.3, upper[j] - home[j]));
    if (clear_way(out.empty() ? home : out.back(), q) && clear_way(q, home)) out.push_back(q);
  }
  return out;
}

Eigen::MatrixXd Robot::transposed_jacobian(std::size_t link, const JointAngles& q) const {
  const auto X = link_poses(q);
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(Eigen::Index(joints()), 6);
  for (std::size_t j = 0; j <= link; ++j) {
    const Eigen::Vector3d axis = X[link].R.transpose() * X[j].R.col(2);
    const Eigen::Vector3d arm = X[link].R.transpose() * (X[link].p - X[j].p);
    T.row(Eigen::Index(j)) << axis.cross(arm).transpose(), axis.transpose();
  }
  return T;
}

const Robot& ur5_robot() {
  static const Robot robot = [] {
    constexpr std::array<double, 6> gains = {60, 70, 50, 25, 15, 15};  // of the main job's scenario
    Robot out;
    out.name = "ur5";
    out.home.assign(home.begin(), home.end());
    out.lower.assign(6, -6.28), out.upper.assign(6, 6.28);
    for (std::size_t l = 0; l < 6; ++l) {
      const NamedLink& named = ur5::Ros2Links::named_links[l];
      const ur5::Tube& tube = ur5::tubes[l];
      out.links.push_back({named.name,
                           {Eigen::Matrix3d::Identity(), {named.p.x, named.p.y, named.p.z}},
                           tube.radius,
                           norm(tube.to - tube.from),
                           gains[l]});
      if (l >= 2) out.points.push_back({l, Eigen::Vector3d::Zero()});
    }
    out.points.push_back({5, {0, 0, ur5::Description::d6}});
    ExcitationLimits l;
    l.lower = Eigen::VectorXd::Constant(6, -6.28), l.upper = Eigen::VectorXd::Constant(6, 6.28);
    // So that the arm stays above its foot.
    for (const int j : {1, 2})
      l.lower(j) = home[std::size_t(j)] - 0.7, l.upper(j) = home[std::size_t(j)] + 0.7;
    l.velocity = Eigen::VectorXd::Constant(6, 3.14), l.acceleration = Eigen::VectorXd::Constant(6, 25);
    l.torque = (Eigen::VectorXd(6) << 150, 150, 150, 28, 28, 28).finished();
    move_by(out, ur5::Model{}, l, true);
    return out;
  }();
  return robot;
}

#ifdef CALIBRATE_SKIN_HAS_URDF
namespace {

template <std::size_t N>
Robot chain_of(const Urdf& urdf, const UrdfRobot& from) {
  constexpr double inside = 0.05, turn_of_endless = 3.14;  // [rad]
  const auto model = calibrated_from<Chain<N>>(urdf);
  const auto of_file = limits_of<N>(urdf, from.acceleration);
  Robot out;
  out.name = urdf.name;
  out.acceleration = from.acceleration, out.jerk = from.jerk;
  out.home = from.home;
  ExcitationLimits l;
  for (auto* limit : {&l.lower, &l.upper, &l.velocity, &l.torque}) limit->resize(N);
  l.acceleration = Eigen::VectorXd::Constant(N, from.acceleration);
  require(from.home.empty() || from.home.size() == N, "--home: joints", double(from.home.size()),
          "as many as move in the URDF");
  for (std::size_t i = 0; i < N; ++i) {
    const auto row = Eigen::Index(i);
    const double low = of_file.lower()[i] + inside, high = of_file.upper()[i] - inside;
    if (from.home.empty()) out.home.push_back(std::isfinite(high - low) ? 0.5 * (low + high) : 0);
    const double at = out.home[i];
    require(at > low && at < high, ("--home: " + urdf.joints[i].name).c_str(), at,
            "0.05 rad or more within its limits");
    out.lower.push_back(std::max({low, at - from.reach, at - turn_of_endless}));
    out.upper.push_back(std::min({high, at + from.reach, at + turn_of_endless}));
    l.lower(row) = out.lower[i], l.upper(row) = out.upper[i];
    l.velocity(row) = of_file.velocity()[i], l.torque(row) = of_file.torque()[i];
    const UrdfFrame& frame = urdf.frame(urdf.joints[i].link);
    out.links.push_back(
        {frame.name, {as_eigen(frame.R), {frame.p.x, frame.p.y, frame.p.z}}, 0, 0, CellGains{}.force});
  }
  for (const UrdfFrame& frame : urdf.frames)
    if (frame.joint >= 2) out.points.push_back({std::size_t(frame.joint), {frame.p.x, frame.p.y, frame.p.z}});
  const bool masses = urdf.assumed_masses.empty();
  move_by(out, model, l, masses);
  if (masses)
    out.torque = [model](const JointPoint& p) {
      JointPosition<N> q;
      JointVelocity<N> dq;
      JointAcceleration<N> ddq;
      for (std::size_t i = 0; i < N; ++i)
        q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
      const auto tau = yr_theta(model, q, dq, dq, ddq);
      Eigen::VectorXd torque(N);
      for (std::size_t i = 0; i < N; ++i) torque(Eigen::Index(i)) = tau[i];
      return torque;
    };
  const double height = out.lowest_point(out.home);
  require(height >= clearance, "height of elbow, wrists and flange at home", height,
          ">= 0.1 m above the robot's foot: --home names another one");
  return out;
}

}  // namespace

Robot robot_of(const UrdfRobot& from) {
  UrdfOptions options;
  options.tip = from.tip;
  const Urdf urdf = read_urdf(from.file, options);
  if (urdf.joints.size() == 6) return chain_of<6>(urdf, from);
  if (urdf.joints.size() == 7) return chain_of<7>(urdf, from);
  refuse(urdf.source + ": " + std::to_string(urdf.joints.size()) +
         " joints move; a chain of six or seven is calibrated, and --tip names its last link");
}
#endif

}  // namespace calibrate_skin
