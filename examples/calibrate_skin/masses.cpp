#include "examples/calibrate_skin/masses.hpp"

#include <algorithm>
#include <cmath>

#include "examples/support/text.hpp"
#include "skinctl/calibration/dynamics_excitation.hpp"
#include "skinctl/calibration/inertial_fit.hpp"
#include "skinctl/calibration/link_inertia.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/robots/ur5.hpp"

namespace calibrate_skin {

using namespace skinctl;

PlannedMotion masses_motion(std::uint64_t seed) {
  ExcitationLimits l;
  l.lower = Eigen::VectorXd::Constant(6, -6.28), l.upper = Eigen::VectorXd::Constant(6, 6.28);
  // So that the arm stays above its foot.
  for (const int j : {1, 2}) l.lower(j) = home[std::size_t(j)] - 0.7, l.upper(j) = home[std::size_t(j)] + 0.7;
  l.velocity = Eigen::VectorXd::Constant(6, 2.5), l.acceleration = Eigen::VectorXd::Constant(6, 15);
  l.torque = (Eigen::VectorXd(6) << 150, 150, 150, 28, 28, 28).finished();
  const Eigen::VectorXd from = Eigen::Map<const Eigen::VectorXd>(home.data(), 6);
  for (int tries = 0; tries < 20; ++tries) {
    const DynamicsExcitation motion(ur5::Model{}, from, l,
                                    {.periods = 4, .tries = 100, .seed = 100 * seed + std::uint64_t(tries)});
    PlannedMotion out{[motion](double t) { return motion.at(t); }, motion.duration(), {}};
    const double low = ur5_robot().lowest_point(out, 0.02);
    if (low < clearance) continue;
    for (const auto& a : motion.announcements()) out.announcements.push_back(a.text);
    out.announcements.push_back(
        examples::text("elbow, wrists and flange come as low as %.2f m above the robot's foot", low));
    return out;
  }
  throw ConfigurationError("no motion for masses was found that stays above the robot's foot");
}

FoundModel with_bodies(const FoundModel& axes, const RobotMasses& masses) {
  FoundModel::Links links;
  for (std::size_t i = 0; i < 6; ++i) links[i] = with_inertia(axes.link(i), masses.bodies[i].data());
  return FoundModel(links, axes.gravity<double>());
}

Eigen::Matrix<double, 6, 6> mass_of(const FoundModel& model, const RobotMasses& masses,
                                    const JointAngles6& q) {
  const auto M = mass_matrix(model, JointPosition<6>(q));
  Eigen::Matrix<double, 6, 6> out;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      out(Eigen::Index(i), Eigen::Index(j)) = M(i, j) + (i == j ? masses.rotor[i] : 0);
  return out;
}

namespace {

// R^2 of torques between two rows, means taken out, by bodies of `model` and friction and rotors of `found`.
template <class Model>
JointAngles6 explained(const Model& model, const FoundMasses& found, const JointRecording& joints,
                       const Eigen::MatrixXd& torque, std::size_t from) {
  const MeasuredMotion motion(joints);
  const RobotMasses& m = found.masses;
  std::vector<JointAngles6> rest, all;
  JointAngles6 z{}, last{};
  for (std::size_t k = 0; k < joints.time.size(); ++k) {
    const double t = joints.time[k] - found.lateness;
    if (!(t > motion.start() && t < motion.end())) continue;
    const auto [q, dq, ddq] = JointState6(motion.at(t));
    const auto tau = yr_theta(model, q, dq, dq, ddq);
    JointAngles6 row{}, measured{};
    for (std::size_t i = 0; i < 6; ++i) {
      const double step = last == JointAngles6{} ? 0 : q[i] - last[i], side = step > 0 ? 1 : -1;
      z[i] = side - (side - z[i]) * std::exp(-std::abs(step) / found.presliding[i]);
      measured[i] = torque(Eigen::Index(k), Eigen::Index(i));
      row[i] = measured[i] - tau[i] - m.viscous[i] * dq[i] - m.coulomb[i] * z[i] - m.rotor[i] * ddq[i];
    }
    for (std::size_t i = 0; i < 6; ++i) last[i] = q[i];
    if (k >= from) rest.push_back(row), all.push_back(measured);
  }
  JointAngles6 out{};
  const auto variance = [](const std::vector<JointAngles6>& rows, std::size_t i) {
    double mean = 0, sum = 0;
    for (const auto& r : rows) mean += r[i] / double(rows.size());
    for (const auto& r : rows) sum += (r[i] - mean) * (r[i] - mean);
    return sum;
  };
  for (std::size_t i = 0; i < 6; ++i) out[i] = 1 - variance(rest, i) / std::max(variance(all, i), 1e-12);
  return out;
}

}  // namespace

FoundMasses fit_masses(const FoundModel& axes, const JointRecording& joints, const Eigen::MatrixXd& torque) {
  const std::size_t seen = joints.time.size() * 4 / 5;
  TorqueRecording part;
  part.joints.time.assign(joints.time.begin(), joints.time.begin() + std::ptrdiff_t(seen));
  part.joints.q = joints.q.topRows(Eigen::Index(seen)), part.torque = torque.topRows(Eigen::Index(seen));
  // Cylinders say little of bodies that are unlike them.
  const auto fit = fit_inertia(axes, {part}, cylinder_prior(axes),
                               {.prior = InertialFitSettings::chosen, .max_lateness = 0.03});
  FoundMasses out;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 10; ++k) out.masses.bodies[i][k] = fit.theta.data[10 * i + k];
  out.masses.viscous = fit.viscous, out.masses.coulomb = fit.coulomb, out.masses.rotor = fit.rotor;
  out.presliding = fit.presliding, out.noise = fit.noise;
  out.lateness = fit.lateness, out.base = fit.base.count(), out.converged = fit.converged;
  for (Eigen::Index k = 0; k < fit.base_values.value.size(); ++k) {
    out.values.push_back(fit.base_values.value(k));
    out.deviations.push_back(std::sqrt(fit.base_values.covariance(k, k)));
  }
  out.predicted = explained(with_bodies(axes, out.masses), out, joints, torque, seen);
  out.predicted_by_maker = explained(ur5::Model{}, out, joints, torque, seen);
  return out;
}

}  // namespace calibrate_skin
