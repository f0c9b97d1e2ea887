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
  double prior = 4;     ///< prior's weight lambda, 0.01 to 1000; relative error of its masses 1/sqrt(lambda)
  double reach = 0.15;  ///< size of a link, for the prior's first and second moments [m]
  bool rotors = true;   ///< whether rotor inertias I_a are fitted
  double latest = 0;    ///< largest lateness of the torques behind the positions [s], 0 to 0.1; 0: none
  int steps = 60;
};

/// The result of `fit_inertia`. `theta` is of bodies that have a density; friction and rotors are not
/// negative.
template <std::size_t N>
struct InertialFit {
  InertialParameters<N> theta;
  /// Viscous and Coulomb friction, rotor inertia [N m s/rad], [N m], [kg m^2].
  std::array<double, N> viscous{}, coulomb{}, rotor{};
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
  require(s.prior >= 0.01 && s.prior <= 1000, "lambda of the prior", s.prior, "0.01 to 1000");
  require(s.reach > 0.01 && s.reach < 10, "reach of the prior", s.reach, "0.01 to 10 m");
  require(s.latest >= 0 && s.latest <= 0.1, "lateness of torques", s.latest, "0 to 0.1 s");
  InertialFit<N> out;
  out.base = base_parameters(model);
  if (s.latest > 0)
    out.lateness = detail::fit::torque_lateness(model, recordings, out.base, s.rotors, s.latest);
  detail::fit::TorqueEquations<M> equations(model, recordings, out.lateness);

  // A little of the divergence tr(P0^-1 P) - log det P, too: it keeps bodies what they can be.
  const double divergence = 0.25 * s.prior;
  Eigen::VectorXd prior_weight = Eigen::VectorXd::Zero(all), theta0 = Eigen::VectorXd::Zero(all);
  Eigen::VectorXd x = Eigen::VectorXd::Ones(all);
  std::vector<detail::fit::Inertia10> bodies_of_prior;
  for (std::size_t i = 0; i < N; ++i) {
    const Eigen::Map<const detail::fit::Inertia10> t(prior.data + 10 * i);
    const Eigen::Index at = 10 * Eigen::Index(i);
    const double m = std::max(t(0), 0.05), r = s.reach;
    bodies_of_prior.push_back(detail::fit::body_near(t, r));
    theta0.segment<10>(at) = t, x.segment<10>(at) = bodies_of_prior.back();
    for (int k = 0; k < 10; ++k)
      prior_weight(at + k) = s.prior / std::pow(m * (k == 0 ? 1 : k < 4 ? r : r * r), 2);
  }
  const Eigen::Index absent = s.rotors ? all : all - Eigen::Index(N);
  for (Eigen::Index i = all - Eigen::Index(N); i < all; ++i) x(i) = s.rotors ? 0.1 : 0;
  Eigen::VectorXd linear = equations.least_squares(out.base, s.rotors);
  for (int round = 0; round < 3; ++round) {
    equations.refine(round == 0 ? linear : x);
    Eigen::MatrixXd H = equations.H();
    H.diagonal() += prior_weight;
    const Eigen::VectorXd b = equations.b() + prior_weight.cwiseProduct(theta0);
    const auto end =
        detail::fit::InertialNewton(H, b, bodies_of_prior, divergence, absent).minimise(x, s.steps);
    out.steps += end.steps, out.converged = end.converged;
    if (round == 0) equations.set_presliding(x);
    if (round == 1) linear = equations.least_squares(out.base, s.rotors);
  }
  equations.refine(x);
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
  H.diagonal() += prior_weight;
  const Eigen::MatrixXd C = detail::solve_symmetric(H, Eigen::MatrixXd::Identity(all, all));
  const Eigen::MatrixXd of_bodies = C.topLeftCorner(bodies, bodies), base = out.base.K * of_bodies;
  out.base_values.value = out.base.K * x.head(bodies);
  out.base_values.covariance = base * out.base.K.transpose();
  return out;
}

SKINCTL_END_NAMESPACE
