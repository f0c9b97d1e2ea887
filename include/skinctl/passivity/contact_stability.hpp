// SPDX-License-Identifier: BSD-3-Clause
// Contact stability: the gain margin of the loop through a resolver's virtual robot and a contact.
#pragma once

#include <cmath>
#include <complex>
#include <limits>

#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/passivity/detail/contact_modes.hpp"
#include "skinctl/robot/robot_configuration.hpp"
#include "skinctl/robot/tool_shape.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A body that touches a robot: its stiffness and mass; and the gain and the delay with which the law gets
/// its force.
template <Real T = double>
struct ContactEnvironment {
  T stiffness = T(0);        ///< stiffness of the stiffest contact [N/m], > 0
  T cover = T(0);            ///< stiffness of the skin's cover, in series [N/m]; 0: rigid
  T body = T(0);             ///< mass behind the contact [kg], that nothing else holds; 0: a wall
  T force_gain = T(1);       ///< w_f: newtons at the law per newton at the cell, > 0
  Nanoseconds skin_delay{};  ///< t_skin: age of a push when a cycle uses it, >= 0

  /// Stiffness of contact and cover in series, `k_env k_skin / (k_env + k_skin)` [N/m].
  [[nodiscard]] T series() const noexcept {
    return cover > T(0) ? T(stiffness * cover / (stiffness + cover)) : stiffness;
  }
};
/// Throws `ConfigurationError` for a number out of its range.
template <Real T>
SKINCTL_COLD void check(const ContactEnvironment<T>& e) {
  const auto number = [](const T& x) { return static_cast<double>(x); };
  require(e.stiffness > T(0) && e.stiffness <= T(1e12), "stiffness", number(e.stiffness), "> 0, <= 1e12 N/m");
  require(e.cover >= T(0) && e.cover <= T(1e12), "cover", number(e.cover), "0 to 1e12 N/m");
  require(e.body >= T(0) && e.body <= T(1e6), "body", number(e.body), "0 to 1e6 kg");
  require(e.force_gain > T(0) && e.force_gain <= T(1e6), "force gain", number(e.force_gain), "> 0, <= 1e6");
  require(e.skin_delay >= 0ns && e.skin_delay <= 1s, "delay of the skin", milliseconds(e.skin_delay),
          "0 to 1000 ms");
}

/// The loop of contact force, virtual robot, delay, lag and displacement:
///
///     g(s) = w_f n'J (M s^2 + B s)^-1 J'n (1 + T_lead s) exp(-s t_skin) H
///
/// with H the robot as cycles see it, delay, lag, hold and samples, T_lead the force lead, and t_skin the age
/// of a push (`detail::ContactPath`). M and B are the configured inertia and friction, of joints and the tool
/// (`Tool`, as in the resolver). A contact of stiffness k before a wall is stable up to where `k g`
/// passes -1; before a free body of mass m, up to where `1/k + 1/(m s^2) + g` passes 0: a light body gives
/// way with the robot. Simulated over predicted stiffness of a wall: within 2 %. A contact is given by its
/// row `n'J` (see `Contact::row`). For configuration time: some microseconds a pose, by Eigen; include
/// `<Eigen/Eigenvalues>` first.
template <RobotModel M, Real T = double, class Tool = NoToolShape>
class ContactStability {
 public:
  static constexpr std::size_t joints = M::joints;
  using Configuration = RobotConfiguration<joints, T>;
  using Row = T[joints];
  using Modes = detail::ContactModes<joints, T>;

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD ContactStability(const M& model, const Configuration& c, const ContactEnvironment<T>& e,
                                const Tool& tool = Tool())
      : model_(model), shape_(c.virtual_dynamics()), environment_(e), path_(c, e.skin_delay), tool_(tool) {
    skinctl::check(e);
  }

  /// The delay of the loop for slow motion [s]: declared delay, age of a push, lag and half a period, or a
  /// little more.
  [[nodiscard]] T total_delay() const noexcept { return path_.total_delay(); }
  [[nodiscard]] const detail::ContactPath<T>& path() const noexcept { return path_; }

  /// Inertia and friction of the virtual robot at a pose.
  struct Felt {
    MassMatrix<joints, T> inertia;   ///< M_v, mass matrix of the virtual robot
    MassMatrix<joints, T> friction;  ///< B, friction matrix [N m s/rad]
  };
  [[nodiscard]] Felt felt(const JointPosition<joints, T>& q) const {
    Felt out{mass_matrix(model_, q), {}};
    if constexpr (std::same_as<Tool, NoToolShape>) {
      for (std::size_t i = 0; i < joints; ++i) out.inertia(i, i) += shape_.inertia[i];
    } else {
      const auto terms = tool_.at(model_, q, shape_.inertia);
      out = {terms.mass, terms.friction};
    }
    for (std::size_t i = 0; i < joints; ++i) {
      for (std::size_t j = 0; j < joints; ++j) out.friction(i, j) += shape_.damping * out.inertia(i, j);
      out.friction(i, i) += shape_.viscous[i];
    }
    return out;
  }
  [[nodiscard]] Modes modes(const JointPosition<joints, T>& q) const {
    const Felt robot = felt(q);
    return {robot.inertia, robot.friction};
  }

  /// The loop's response `g(i w)` [m/N] for a contact with the row `row` [m/rad], at the frequency `w`
  /// [rad/s].
  [[nodiscard]] std::complex<T> response(const Modes& robot, const Row& row, const T& w) const {
    T mode[joints];
    robot.row(row, mode);
    return environment_.force_gain * robot.compliance(mode, mode, w) * path_.at(w);
  }
  /// k_max [N/m]: the stiffest contact along `row` at the pose `q` that comes to rest. 0 for a virtual robot
  /// without friction, infinity for a row of zeros.
  [[nodiscard]] T stiffest(const JointPosition<joints, T>& q, const Row& row) const {
    const Modes robot = modes(q);
    T mode[joints], size(0);
    robot.row(row, mode);
    for (const T& r : row) size += r * r;
    if (!(size > T(0))) return std::numeric_limits<T>::infinity();
    return T(1) / lack_of(detail::ContactLoops<joints, T>{robot, path_, mode, environment_.force_gain,
                                                          nullptr, T(1)},
                          T(1), environment_.body, T(0), T(1));
  }

 private:
  [[no_unique_address]] M model_;
  VirtualDynamics<joints, T> shape_;
  ContactEnvironment<T> environment_;
  detail::ContactPath<T> path_;
  [[no_unique_address]] Tool tool_;
};

SKINCTL_END_NAMESPACE
