// SPDX-License-Identifier: BSD-3-Clause
// Masses, inertias and friction of a robot from its torques, such as bodies can have them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "skinctl/calibration/base_parameters.hpp"
#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/inertial_newton.hpp"
#include "skinctl/calibration/detail/pseudo_inertia.hpp"
#include "skinctl/calibration/detail/torque_equations.hpp"
#include "skinctl/calibration/estimate.hpp"
#include "skinctl/calibration/link_inertia.hpp"

SKINCTL_BEGIN_NAMESPACE

struct InertialFitSettings {
  /// Weight lambda of the prior, 0.01 to 1000: its masses are off by 1/sqrt(lambda), relative. Or `chosen`.
  double prior = 4;
  double reach = 0.15;      ///< size of a link, for the prior's first and second moments [m]
  bool rotors = true;       ///< whether rotor inertias I_a are fitted
  double max_lateness = 0;  ///< largest lateness of the torques behind the positions [s], 0 to 0.1; 0: none
  int steps = 200;          ///< most Newton steps of each of the three rounds
  /// As `prior`: that of 0.01, 0.1, 1, 10 with which the first four fifths of each recording tell the most of
  /// the last fifth, where nobody knows how good the prior is.
  static constexpr double chosen = 0;
};

/// The result of `fit_inertia`. `theta` is of bodies that have a density; friction and rotors are not
/// negative.
template <std::size_t N>
struct InertialFit {
  InertialParameters<N> theta;
  /// Viscous and Coulomb friction, rotor inertia [N m s/rad], [N m], [kg m^2].
  std::array<double, N> viscous{}, coulomb{}, rotor{};
  double prior = 0;                    ///< weight of the prior that was used
  double lateness = 0;                 ///< lateness of the torques behind the positions [s]
  std::array<double, N> presliding{};  ///< presliding distance x0 in which friction reverses [rad]
  std::array<double, N> noise{};       ///< standard deviation of a torque from the fit [N m]
  std::array<double, N> explained{};   ///< R^2 of each joint, of torques less their means
  BaseParameters base;
  EstimateOf<Eigen::VectorXd>
      base_values;                      ///< base parameters of `theta`; covariance of least squares and prior
  InertialParameters<N> least_squares;  ///< result of ordinary least squares; no physical body need have it
  std::array<double, N> ls_viscous{}, ls_coulomb{},
      ls_rotor{};  ///< friction and rotors of ordinary least squares
  int steps = 0;
  bool converged = false;
};

/// Inertial parameters of the links for a start without a drawing: cylinders of `radius` [m] and 2700 kg/m^3
/// along each link, to the next joint, half filled.
template <RobotModel M>
[[nodiscard]] InertialParameters<M::joints> cylinder_prior(const M& model, double radius = 0.05) {
  constexpr std::size_t N = M::joints;
  using detail::fit::operator+, detail::fit::operator-, detail::fit::operator*,
      detail::fit::operator/;  // of Eigen alone
  InertialParameters<N> theta;
  std::array<LinkParameters<double>, N> links;
  detail::unrolled<N>([&](auto i) { links[i] = numbers_of<i, double>(model); });
  for (std::size_t i = 0; i < N; ++i) {
    Eigen::Vector3d end(0, 0, 0.08);
    for (std::size_t k = 0; k < N; ++k)
      if (M::parents[k] == int(i))
        end = {links[k][LinkParameter::p_x], links[k][LinkParameter::p_y], links[k][LinkParameter::p_z]};
    const double length = std::max(end.norm(), 0.08),
                 mass = 0.5 * 2700 * 3.14159265 * radius * radius * length;
    const Eigen::Vector3d d =
        end.norm() > 1e-3 ? Eigen::Vector3d(end.normalized()) : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d c = 0.5 * length * d;
    Eigen::Matrix4d P;
    P.topLeftCorner<3, 3>() =
        mass * (length * length / 12 * d * d.transpose() +
                radius * radius / 4 * (Eigen::Matrix3d::Identity() - d * d.transpose()) + c * c.transpose());
    P.topRightCorner<3, 1>() = mass * c, P.bottomLeftCorner<1, 3>() = mass * c.transpose(), P(3, 3) = mass;
    const auto t = detail::fit::parameters_of(P);
    for (std::size_t k = 0; k < 10; ++k) theta.data[10 * i + k] = t(Eigen::Index(k));
  }
  return theta;
}

namespace detail::fit {
/// Lateness of the torques behind the positions [s], 0 to `latest`: least squares leave the smallest
/// residuals there. Positions are moved, not torques: between two readings their noise would be less.
template <RobotModel M>
[[nodiscard]] double torque_lateness(const M& model, const std::vector<TorqueRecording>& recordings,
                                     const BaseParameters& base, bool rotors, double latest) {
  const auto left = [&](double late) {
    TorqueEquations<M> equations(model, recordings, late);
    static_cast<void>(equations.least_squares(base, rotors));
    double sum = 0;
    for (const double noise : equations.noise()) sum += std::log(noise);
    return sum;
  };
  double middle = 0.5 * latest, side = middle;
  for (int round = 0; round < 3; ++round, side *= 0.25) {
    const double a = left(middle - side), b = left(middle), c = left(middle + side);
    const double bend = a - 2 * b + c, slope = 0.5 * (a - c);
    const double way = bend > 0 ? std::clamp(slope / bend, -1.0, 1.0) : (slope > 0 ? 1 : -1);
    middle = std::clamp(middle + side * way, 0.0, latest);
  }
  return middle;
}
/// Parameters of the bodies, friction and rotors, and what was found beside them.
struct InertialSolution {
  Eigen::VectorXd x, linear;  ///< of the fit, and of ordinary least squares
  Eigen::VectorXd weight;     ///< the prior's, of each parameter
  int steps = 0;
  bool converged = false;
};
/// Fits equations with the weight `lambda` of a prior. Leaves them weighted by what the fit leaves.
template <RobotModel M>
[[nodiscard]] InertialSolution solve_inertia(TorqueEquations<M>& equations, const BaseParameters& base,
                                             const InertialParameters<M::joints>& prior, double lambda,
                                             const InertialFitSettings& s) {
  constexpr auto N = Eigen::Index(M::joints), bodies = 10 * N, all = bodies + 3 * N;
  // A little of the divergence tr(P0^-1 P) - log det P, too: it keeps bodies what they can be.
  const double divergence = 0.25 * lambda;
  InertialSolution out;
  out.weight = Eigen::VectorXd::Zero(all), out.x = Eigen::VectorXd::Ones(all);
  Eigen::VectorXd theta0 = Eigen::VectorXd::Zero(all);
  std::vector<Inertia10> bodies_of_prior;
  for (Eigen::Index i = 0; i < N; ++i) {
    const Eigen::Map<const Inertia10> t(prior.data + 10 * i);
    const Eigen::Index at = 10 * i;
    const double m = std::max(t(0), 0.05), r = s.reach;
    bodies_of_prior.push_back(body_near(t, r));
    theta0.segment<10>(at) = t, out.x.segment<10>(at) = bodies_of_prior.back();
    for (int k = 0; k < 10; ++k)
      out.weight(at + k) = lambda / std::pow(m * (k == 0 ? 1 : k < 4 ? r : r * r), 2);
  }
  const Eigen::Index absent = s.rotors ? all : all - N;
  for (Eigen::Index i = all - N; i < all; ++i) out.x(i) = s.rotors ? 0.1 : 0;
  out.linear = equations.least_squares(base, s.rotors);
  for (int round = 0; round < 3; ++round) {
    equations.refine(out.linear);  // what a wrong prior leaves is no noise, which would give it more weight
    Eigen::MatrixXd H = equations.H();
    H.diagonal() += out.weight;
    const Eigen::VectorXd b = equations.b() + out.weight.cwiseProduct(theta0);
    const auto end = InertialNewton(H, b, bodies_of_prior, divergence, absent).minimise(out.x, s.steps);
    out.steps += end.steps, out.converged = end.converged;
    if (round == 0) equations.set_presliding(out.x);
    if (round == 1) out.linear = equations.least_squares(base, s.rotors);
  }
  equations.refine(out.x);
  return out;
}

/// The part of a recording from row `begin` to before row `end`.
[[nodiscard]] inline TorqueRecording part_of(const TorqueRecording& r, std::size_t begin, std::size_t end) {
  TorqueRecording out;
  const auto at = static_cast<std::ptrdiff_t>(begin), size = static_cast<std::ptrdiff_t>(end - begin);
  out.joints.time.assign(r.joints.time.begin() + at, r.joints.time.begin() + at + size);
  out.joints.q = r.joints.q.middleRows(at, size), out.torque = r.torque.middleRows(at, size);
  return out;
}
/// The weight of a prior with which the first four fifths of each recording tell the most of the last one.
template <RobotModel M>
[[nodiscard]] double chosen_prior(const M& model, const std::vector<TorqueRecording>& recordings,
                                  const BaseParameters& base, const InertialParameters<M::joints>& prior,
                                  double lateness, const InertialFitSettings& s) {
  std::vector<TorqueRecording> seen, held_out;
  for (const TorqueRecording& r : recordings) {
    const std::size_t rows = r.joints.time.size(), end = rows * 4 / 5;
    seen.push_back(part_of(r, 0, end)), held_out.push_back(part_of(r, end, rows));
  }
  const TorqueEquations<M> of_seen(model, seen, lateness);
  TorqueEquations<M> rest(model, held_out, lateness);
  double best = 0, least = 1e300;
  for (const double lambda : {10.0, 1.0, 0.1, 0.01}) {
    TorqueEquations<M> equations = of_seen;
    const InertialSolution found = solve_inertia(equations, base, prior, lambda, s);
    const double left = rest.unexplained(found.x, equations.presliding());
    if (left < least) least = left, best = lambda;
  }
  return best;
}
}  // namespace detail::fit

/// Identifies `tau = Y theta + F_v dq + F_c z + I_a ddq + o`, an offset `o` per joint and recording; `z` is
/// the direction of Coulomb friction with presliding, `z <- s - (s - z) exp(-|step|/x0)`, s the sign of the
/// step.
///
/// Bodies keep a positive pseudo-inertia, friction and rotors stay positive: a convex problem, by Newton's
/// method from within. The prior has the weight `InertialFitSettings::prior`. Residuals of each joint are
/// weighted by their variance and count less where they are correlated in time.
///
/// Throws `ConfigurationError` for recordings that are too short or damaged, and if a joint stands still in
/// all of them: its friction cannot be known.
///
/// @param model  its placements and gravity are read.
/// @param prior  `inertial_parameters(model)` of a drawing, or `cylinder_prior(model)`.
template <RobotModel M>
[[nodiscard]] InertialFit<M::joints> fit_inertia(const M& model,
                                                 const std::vector<TorqueRecording>& recordings,
                                                 const InertialParameters<M::joints>& prior,
                                                 const InertialFitSettings& s = {}) {
  constexpr std::size_t N = M::joints;
  using detail::fit::operator+, detail::fit::operator-, detail::fit::operator*,
      detail::fit::operator/;  // of Eigen alone
  constexpr Eigen::Index bodies = 10 * Eigen::Index(N), all = bodies + 3 * Eigen::Index(N);
  require(s.prior == InertialFitSettings::chosen || (s.prior >= 0.01 && s.prior <= 1000),
          "lambda of the prior", s.prior, "0.01 to 1000, or chosen");
  require(s.reach > 0.01 && s.reach < 10, "reach of the prior", s.reach, "0.01 to 10 m");
  require(s.max_lateness >= 0 && s.max_lateness <= 0.1, "lateness of torques", s.max_lateness, "0 to 0.1 s");
  InertialFit<N> out;
  out.base = base_parameters(model);
  if (s.max_lateness > 0)
    out.lateness = detail::fit::torque_lateness(model, recordings, out.base, s.rotors, s.max_lateness);
  detail::fit::TorqueEquations<M> equations(model, recordings, out.lateness);

  out.prior = s.prior;
  if (s.prior == InertialFitSettings::chosen)
    out.prior = detail::fit::chosen_prior(model, recordings, out.base, prior, out.lateness, s);
  const detail::fit::InertialSolution found =
      detail::fit::solve_inertia(equations, out.base, prior, out.prior, s);
  const Eigen::VectorXd &x = found.x, &linear = found.linear;
  out.steps = found.steps, out.converged = found.converged;
  for (std::size_t k = 0; k < 10 * N; ++k)
    out.theta.data[k] = x(Eigen::Index(k)), out.least_squares.data[k] = linear(Eigen::Index(k));
  for (std::size_t i = 0; i < N; ++i) {
    const Eigen::Index at = bodies + Eigen::Index(i), n = Eigen::Index(N);
    out.viscous[i] = x(at), out.coulomb[i] = x(at + n), out.rotor[i] = s.rotors ? x(at + 2 * n) : 0;
    out.ls_viscous[i] = linear(at), out.ls_coulomb[i] = linear(at + n), out.ls_rotor[i] = linear(at + 2 * n);
    out.presliding[i] = equations.presliding()[i];
    out.noise[i] = equations.noise()[i], out.explained[i] = equations.explained()[i];
  }
  Eigen::MatrixXd H = equations.H();
  H.diagonal() += found.weight;
  const Eigen::MatrixXd C = detail::solve_symmetric(H, Eigen::MatrixXd::Identity(all, all));
  const Eigen::MatrixXd of_bodies = C.topLeftCorner(bodies, bodies), base = out.base.K * of_bodies;
  out.base_values.value = out.base.K * x.head(bodies);
  out.base_values.covariance = base * out.base.K.transpose();
  return out;
}

SKINCTL_END_NAMESPACE
