// Study: masses, friction and rotors of a UR5 from its torques, over seeds. Baseline: ordinary least squares.
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "bench/studies/worlds/ur5_excitation.hpp"
#include "examples/worlds/other_bodies.hpp"
#include "skinctl/calibration/dynamics_excitation.hpp"
#include "skinctl/calibration/inertial_fit.hpp"
#include "skinctl/calibration/nees.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Model = ur5::Calibrated<>;
using Theta = InertialParameters<6>;

// An arm whose bodies are off by a tenth to a quarter from the maker's numbers, with friction and rotors that
// the maker does not give.
struct Arm {
  Model model = calibrated_from<ur5::Description>();
  Theta theta;
  std::array<double, 6> viscous{}, coulomb{}, rotor{}, ripple{}, phase{};
  double presliding = 1.4e-3, load = 0.03;

  explicit Arm(Random& rng) {
    const Theta cad = inertial_parameters(ur5::Model{});
    for (std::size_t i = 0; i < 6; ++i) {
      const auto out = other_body(Eigen::Map<const detail::fit::Inertia10>(cad.data + 10 * i), rng);
      for (std::size_t k = 0; k < 10; ++k) theta.data[10 * i + k] = out(Eigen::Index(k));
      const bool big = i < 3;
      viscous[i] = uniform(rng, 0.7, 1.3) * (big ? 8 : 1.5),
      coulomb[i] = uniform(rng, 0.7, 1.3) * (big ? 9 : 2.5);
      rotor[i] = uniform(rng, 0.7, 1.3) * (big ? 0.4 : 0.08);
      ripple[i] = big ? 0.8 : 0.2, phase[i] = uniform(rng, 0.0, 6.28);
    }
  }
  [[nodiscard]] Eigen::VectorXd friction(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                         const Eigen::VectorXd& z, const Eigen::VectorXd& tau) const {
    Eigen::VectorXd out(6);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto k = std::size_t(i);
      out(i) = viscous[k] * dq(i) + (coulomb[k] + load * std::abs(tau(i))) * z(i) +
               ripple[k] * std::sin(20 * q(i) + phase[k]);
    }
    return out;
  }
};

struct Joints {
  JointPosition<6> q;
  JointVelocity<6> dq;
  JointAcceleration<6> ddq;
  explicit Joints(const JointPoint& p) {
    for (std::size_t i = 0; i < 6; ++i)
      q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
  }
};
Eigen::VectorXd rigid(const Model& model, const Theta& theta, const JointPoint& p) {
  const Joints j(p);
  const auto tau = regressor_product(model, j.q, j.dq, j.dq, j.ddq, theta);
  Eigen::VectorXd out(6);
  for (std::size_t i = 0; i < 6; ++i) out(Eigen::Index(i)) = tau[i];
  return out;
}

TorqueRecording record(const Arm& arm, const Excitation& motion, Random& rng, double duration) {
  std::normal_distribution<double> normal;
  TorqueRecording out;
  const auto n = Eigen::Index(duration * 125);
  out.joints.q.resize(n, 6), out.torque.resize(n, 6);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(6), last = motion.at(0).q;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double t = 0.008 * double(k);
    const JointPoint p = motion.at(t);
    Eigen::VectorXd tau = rigid(arm.model, arm.theta, p);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double step = p.q(i) - last(i), side = step > 0 ? 1 : -1;
      z(i) = side - (side - z(i)) * std::exp(-std::abs(step) / arm.presliding);
      tau(i) += arm.rotor[std::size_t(i)] * p.ddq(i);
    }
    last = p.q;
    tau += arm.friction(p.q, p.dq, z, tau);
    out.joints.time.push_back(t);
    for (Eigen::Index i = 0; i < 6; ++i) {
      out.joints.q(k, i) = p.q(i) + 1e-5 * normal(rng);
      out.torque(k, i) = tau(i) + (i < 3 ? 1.5 : 0.35) * normal(rng) + (i < 3 ? 1.0 : -0.2);
    }
  }
  return out;
}

Eigen::MatrixXd mass(const Model& model, const Theta& theta, const std::array<double, 6>& rotor,
                     const Eigen::VectorXd& q) {
  Eigen::MatrixXd M(6, 6);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(6);
  const Eigen::VectorXd g = rigid(model, theta, {q, none, none});
  for (Eigen::Index k = 0; k < 6; ++k)
    M.col(k) = rigid(model, theta, {q, none, Eigen::VectorXd::Unit(6, k)}) - g;
  for (Eigen::Index k = 0; k < 6; ++k) M(k, k) += rotor[std::size_t(k)];
  return 0.5 * (M + M.transpose());
}

struct Score {
  double r2 = 0, r2_ols = 0, mass = 0, mass_ols = 0, mass_cad = 0, bad = 0, bad_ols = 0, nees = 0,
         seconds = 0, noise_r2 = 0;
  double track = 0, track_maker = 0, track_none = 0;
};

// R^2 of predicted torques on another motion, means taken out; the mean of the joints.
double explained(const Arm& arm, const TorqueRecording& r, const Theta& theta, const std::array<double, 6>& v,
                 const std::array<double, 6>& c, const std::array<double, 6>& rotor, double presliding) {
  const MeasuredMotion motion(r.joints);
  Eigen::MatrixXd e(r.torque.rows(), 6), y(r.torque.rows(), 6);
  Eigen::Index n = 0;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(6), last = motion.at(0).q;
  for (Eigen::Index k = 0; k < r.torque.rows(); ++k) {
    const double t = r.joints.time[std::size_t(k)];
    if (t < motion.start() || t > motion.end()) continue;
    const JointPoint p = motion.at(t);
    Eigen::VectorXd tau = rigid(arm.model, theta, p);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto j = std::size_t(i);
      const double step = p.q(i) - last(i), side = step > 0 ? 1 : -1;
      z(i) = side - (side - z(i)) * std::exp(-std::abs(step) / presliding);
      tau(i) += rotor[j] * p.ddq(i) + v[j] * p.dq(i) + c[j] * z(i);
    }
    last = p.q;
    y.row(n) = r.torque.row(k), e.row(n++) = r.torque.row(k) - tau.transpose();
  }
  double sum = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const auto var = [&](const Eigen::MatrixXd& m) {
      return (m.col(i).head(n).array() - m.col(i).head(n).mean()).square().sum();
    };
    sum += (1 - var(e) / var(y)) / 6;
  }
  return sum;
}

// Rms of the joints' errors [rad] of a motion under torques of a model and the same feedback.
double tracking(const Arm& arm, const Excitation& motion, const Theta& theta, const std::array<double, 6>& v,
                const std::array<double, 6>& c, const std::array<double, 6>& rotor) {
  const double dt = 0.001, seconds = 12;
  JointPoint x = motion.at(0);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(6);
  double squares = 0, count = 0;
  const double gain[6] = {600, 600, 300, 40, 40, 15};
  for (double t = 0; t < seconds; t += dt) {
    const JointPoint d = motion.at(t);
    Eigen::VectorXd tau = rigid(arm.model, theta, d);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto j = std::size_t(i);
      tau(i) += rotor[j] * d.ddq(i) + v[j] * d.dq(i) + c[j] * std::tanh(d.dq(i) / 0.02) +
                gain[i] * (d.q(i) - x.q(i)) + 0.12 * gain[i] * (d.dq(i) - x.dq(i));
    }
    const Eigen::MatrixXd M = mass(arm.model, arm.theta, arm.rotor, x.q);
    JointPoint rest = x;
    rest.ddq.setZero();
    const Eigen::VectorXd bias = rigid(arm.model, arm.theta, rest);
    // Friction implicitly in the viscous part.
    Eigen::MatrixXd A = M;
    Eigen::VectorXd push = tau - bias;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto j = std::size_t(i);
      A(i, i) += dt * arm.viscous[j];
      push(i) -= arm.viscous[j] * x.dq(i) + (arm.coulomb[j] + arm.load * std::abs(tau(i))) * z(i) +
                 arm.ripple[j] * std::sin(20 * x.q(i) + arm.phase[j]);
    }
    x.dq += dt * A.ldlt().solve(push);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double step = dt * x.dq(i), side = step > 0 ? 1 : -1;
      z(i) = side - (side - z(i)) * std::exp(-std::abs(step) / arm.presliding);
      x.q(i) += step;
    }
    if (t > 2) squares += (x.q - d.q).squaredNorm(), count += 6;
  }
  return std::sqrt(squares / count);
}

double not_positive(const Model& model, const Theta& theta, const std::array<double, 6>& rotor, Random& rng,
                    int poses) {
  int bad = 0;
  for (int k = 0; k < poses; ++k) {
    Eigen::VectorXd q(6);
    for (double& x : q) x = uniform(rng, -3.14, 3.14);
    bad += Eigen::LLT<Eigen::MatrixXd>(mass(model, theta, rotor, q)).info() != Eigen::Success;
  }
  return bad;
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 8;
  const int poses = argc > 2 ? std::atoi(argv[2]) : 2000;
  struct Case {
    const char* name;
    bool narrow, plain;  // plain: gears do not ripple, and friction does not grow with load
  };
  for (const auto& [name, narrow, plain] :
       {Case{"UR5, 30 s", false, false}, Case{"0.35 rad range, 10 s", true, false},
        Case{"UR5, 30 s, plain friction", false, true}}) {
    std::vector<Score> scores;
    for (int seed = 1; seed <= seeds; ++seed) {
      Random rng = seeded(std::uint64_t(seed));
      Arm arm(rng);
      if (plain) arm.ripple = {}, arm.load = 0;
      DynamicsExcitation::Settings s;
      s.periods = narrow ? 1 : 3, s.seed = std::uint64_t(seed);
      const DynamicsExcitation wide_motion(ur5::Model{}, ur5_home, ur5_limits(),
                                           {.periods = 2, .tries = 4, .seed = std::uint64_t(seed) + 50});
      if (narrow) s.range = 0.35;
      const DynamicsExcitation motion(ur5::Model{}, ur5_home, ur5_limits(), s);
      const TorqueRecording train = record(arm, motion, rng, motion.duration());
      const TorqueRecording test = record(arm, wide_motion, rng, wide_motion.duration());
      const auto started = std::chrono::steady_clock::now();
      const auto fit = fit_inertia(arm.model, {train}, inertial_parameters(ur5::Model{}));
      Score r;
      r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
      r.r2 = explained(arm, test, fit.theta, fit.viscous, fit.coulomb, fit.rotor, fit.presliding[0]);
      r.r2_ols = explained(arm, test, fit.least_squares, fit.ls_viscous, fit.ls_coulomb, fit.ls_rotor,
                           fit.presliding[0]);
      r.noise_r2 = explained(arm, test, arm.theta, arm.viscous, arm.coulomb, arm.rotor, arm.presliding);
      const std::array<double, 6> none{};
      const Theta maker = inertial_parameters(ur5::Model{});
      std::vector<double> e, ols, cad;
      for (int k = 0; k < 100; ++k) {
        Eigen::VectorXd q(6);
        for (double& x : q) x = uniform(rng, -3.14, 3.14);
        const Eigen::MatrixXd M = mass(arm.model, arm.theta, arm.rotor, q);
        e.push_back((mass(arm.model, fit.theta, fit.rotor, q) - M).norm() / M.norm());
        ols.push_back((mass(arm.model, fit.least_squares, fit.ls_rotor, q) - M).norm() / M.norm());
        cad.push_back((mass(arm.model, maker, none, q) - M).norm() / M.norm());
      }
      const auto mean = [](const std::vector<double>& v) {
        double sum = 0;
        for (const double x : v) sum += x * x;
        return std::sqrt(sum / double(v.size()));
      };
      r.mass = mean(e), r.mass_ols = mean(ols), r.mass_cad = mean(cad);
      r.bad = not_positive(arm.model, fit.theta, fit.rotor, rng, poses);
      r.bad_ols = not_positive(arm.model, fit.least_squares, fit.ls_rotor, rng, std::min(poses, 1000)) /
                  std::min(poses, 1000);
      Eigen::VectorXd true_base(60);
      for (std::size_t k = 0; k < 60; ++k) true_base(Eigen::Index(k)) = arm.theta.data[k];
      r.nees =
          nees(fit.base_values.value - fit.base.K * true_base, fit.base_values.covariance) / fit.base.count();
      if (!narrow) {
        r.track = tracking(arm, wide_motion, fit.theta, fit.viscous, fit.coulomb, fit.rotor);
        r.track_maker = tracking(arm, wide_motion, maker, fit.viscous, fit.coulomb, none);
        r.track_none = tracking(arm, wide_motion, maker, none, none, none);
      }
      std::printf(
          "%s seed %d: R2 %.4f (OLS %.3f, truth %.4f), M %.2f %% (OLS %.2f, maker %.1f), not > 0: %.0f of %d "
          "(OLS %.1f %%), nees %.2f, %d base, %d steps%s, %.2f s; tracking %.2f mrad, maker's %.2f, without "
          "friction %.2f\n",
          name, seed, r.r2, r.r2_ols, r.noise_r2, 100 * r.mass, 100 * r.mass_ols, 100 * r.mass_cad, r.bad,
          poses, 100 * r.bad_ols, r.nees, fit.base.count(), fit.steps, fit.converged ? "" : " not converged",
          r.seconds, 1e3 * r.track, 1e3 * r.track_maker, 1e3 * r.track_none);
      scores.push_back(r);
    }
    const auto line = [&](const char* what, double Score::* member, double scale, bool high) {
      std::vector<double> v;
      for (const auto& s : scores) v.push_back(scale * s.*member);
      std::sort(v.begin(), v.end());
      std::printf("  %-28s median %.4g, worst %.4g\n", what, v[v.size() / 2], high ? v.back() : v.front());
    };
    std::printf("%s, %d arms\n", name, seeds);
    line("R2", &Score::r2, 1, false), line("R2 of least squares", &Score::r2_ols, 1, false),
        line("R2 of the truth", &Score::noise_r2, 1, false);
    line("M [%]", &Score::mass, 100, true), line("M of least squares [%]", &Score::mass_ols, 100, true),
        line("M of the maker [%]", &Score::mass_cad, 100, true);
    line("poses with M not > 0", &Score::bad, 1, true),
        line("of least squares [%]", &Score::bad_ols, 100, true);
    line("NEES per base parameter", &Score::nees, 1, true);
    if (!narrow)
      line("tracking [mrad]", &Score::track, 1e3, true),
          line("with the maker's bodies", &Score::track_maker, 1e3, true),
          line("and without friction", &Score::track_none, 1e3, true);
  }
}
