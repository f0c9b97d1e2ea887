// Contact stability: the gain margin of the loop through a resolver's virtual robot and a contact.
#pragma once

#include <cmath>
#include <complex>

#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/passivity/detail/contact_path.hpp"
#include "skinctl/robot/robot_configuration.hpp"
#include "skinctl/robot/tool_shape.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The stiffness of a contact, and the path of its force to the law.
template <Real T = double>
struct ContactEnvironment {
  T stiffness = T(0);        ///< of the stiffest contact [N/m], > 0
  T cover = T(0);            ///< of the skin's cover, in series [N/m]; 0: rigid
  T force_gain = T(1);       ///< w_f: newtons at the law per newton at the cell, > 0
  Nanoseconds skin_delay{};  ///< t_skin: age of a push when a cycle uses it, >= 0
  T margin = T(2);           ///< required gain margin, >= 1

  /// `k_env k_skin / (k_env + k_skin)` [N/m].
  [[nodiscard]] T series() const noexcept {
    return cover > T(0) ? T(stiffness * cover / (stiffness + cover)) : stiffness;
  }
};

/// Damping along a contact of stiffness `k` [N/m] with which a loop of total delay `delay` [s] is stable
/// whatever the virtual mass: `B >= 1.5 k T` [N s/m]. The gain margin is then 1.5 for a heavy mass and
/// `1.5 pi/2 = 2.4` for a light one; `ContactStability::damping_for` takes the mass into account.
template <Real T>
[[nodiscard]] T contact_damping(const T& k, const T& delay) noexcept {
  return T(1.5) * k * delay;
}

/// The loop of contact force, virtual robot, delay, lag and displacement:
///
///     g(s) = w_f k n'J (M s^2 + B s)^-1 J'n (1 + T_lead s) exp(-s t_skin) H
///
/// with H the robot as cycles see it, delay, lag, hold and samples (`detail::ContactPath`). Simulated over predicted
/// stiffness: within 2 %, without lag as with it; `exp(-s (T_d + dt/2)) / (tau s + 1)` gives 0.72 to 1.09.
/// M and B are the configured inertia and friction, of joints and of the tool (`Tool`, as in the resolver),
/// and along the contact the contact damping. The loop is stable up to the stiffness at which g passes -1. A
/// contact is given by its row `n'J` (see `Contact::row`). For configuration time: some hundred small complex
/// solutions a pose, by Eigen; include `<Eigen/LU>` first.
template <RobotModel M, Real T = double, class Tool = NoToolShape>
class ContactStability {
 public:
  static constexpr std::size_t joints = M::joints;
  using Configuration = RobotConfiguration<joints, T>;
  using Row = T[joints];

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD ContactStability(const M& model, const Configuration& c, const ContactEnvironment<T>& e,
                                const Tool& tool = Tool())
      : model_(model), shape_(c.virtual_dynamics()), environment_(e), path_(c, e.skin_delay), tool_(tool) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(e.stiffness > T(0) && e.stiffness <= T(1e12), "stiffness", number(e.stiffness),
            "> 0, <= 1e12 N/m");
    require(e.cover >= T(0) && e.cover <= T(1e12), "cover", number(e.cover), "0 to 1e12 N/m");
    require(e.force_gain > T(0) && e.force_gain <= T(1e6), "force gain", number(e.force_gain), "> 0, <= 1e6");
    require(e.skin_delay >= 0ns && e.skin_delay <= 1s, "delay of the skin", milliseconds(e.skin_delay),
            "0 to 1000 ms");
    require(e.margin >= T(1) && e.margin <= T(100), "gain margin", number(e.margin), "1 to 100");
  }

  /// The delay of the loop for slow motion [s], T_d + t_skin + tau + dt/2 or a little more.
  [[nodiscard]] T total_delay() const noexcept { return path_.total_delay(); }

  /// Inertia and friction of the virtual robot at a pose.
  struct Felt {
    MassMatrix<joints, T> inertia;   ///< M_v
    MassMatrix<joints, T> friction;  ///< B
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

  /// `g(i w)` of a contact of 1 N/m, `row` in [m/rad], `damping` [N s/m] along it in addition to that of the
  /// virtual robot.
  [[nodiscard]] std::complex<T> response(const Felt& robot, const Row& row, const T& damping,
                                         const T& w) const {
    using C = std::complex<T>;
    constexpr int N = int(joints);
    Eigen::Matrix<C, N, N, 0, N, N> a;
    Eigen::Matrix<C, N, 1, 0, N, 1> n;
    for (std::size_t i = 0; i < joints; ++i) {
      for (std::size_t j = 0; j < joints; ++j) {
        const T b = robot.friction(i, j) + damping * row[i] * row[j];
        a(static_cast<std::ptrdiff_t>(i), static_cast<std::ptrdiff_t>(j)) =
            C(-w * w * robot.inertia(i, j), w * b);
      }
      n(static_cast<std::ptrdiff_t>(i)) = C(row[i]);
    }
    const C g = n.transpose() * a.partialPivLu().solve(n);
    return environment_.force_gain * g * path_.at(w);
  }

  /// k_max [N/m]: the stiffest contact along `row` at the pose `q` in which the loop is stable. 0 for a
  /// virtual robot without friction, infinity for a row of zeros.
  [[nodiscard]] T stiffest(const JointPosition<joints, T>& q, const Row& row, const T& damping = T(0)) const {
    const Felt robot = felt(q);
    T size(0);
    for (const T& r : row) size += r * r;
    if (!(size > T(0))) return std::numeric_limits<T>::infinity();
    // Every crossing of the negative real axis counts; beyond 20/T the gain is negligible.
    const T first = T(1e-5) / total_delay(), step = T(1.05);
    const T last = path_.last();
    T k = std::numeric_limits<T>::infinity(), from = first;
    auto before = response(robot, row, damping, from);
    if (before.imag() >= T(0)) return T(0);
    for (T w = from * step; w < last; w *= step) {
      const auto g = response(robot, row, damping, w);
      if (before.imag() < T(0) && g.imag() >= T(0) && (g.real() < T(0) || before.real() < T(0))) {
        T low = from, high = w;
        for (int n = 0; n < 40; ++n) {
          const T middle = T(0.5) * (low + high);
          (response(robot, row, damping, middle).imag() < T(0) ? low : high) = middle;
        }
        const T real = response(robot, row, damping, high).real();
        if (real < T(0) && T(-1) / real < k) k = T(-1) / real;
      }
      before = g;
      from = w;
    }
    return k;
  }

  /// The gain margin: k_max over the stiffness of the stiffest contact.
  [[nodiscard]] T margin(const JointPosition<joints, T>& q, const Row& row, const T& damping = T(0)) const {
    return stiffest(q, row, damping) / environment_.series();
  }

  /// Throws `ConfigurationError` with k_max and the allowed range unless the contact has the required margin.
  SKINCTL_COLD void check(const JointPosition<joints, T>& q, const Row& row, const T& damping = T(0)) const {
    const T k = stiffest(q, row, damping), allowed = k / environment_.margin;
    if (allowed >= environment_.series()) return;
    char text[160];
    std::snprintf(
        text, sizeof text, "> 0, <= %.6g N/m here (stable up to %.6g N/m), or contact damping >= %.6g N s/m",
        static_cast<double>(allowed), static_cast<double>(k), static_cast<double>(damping_for(q, row)));
    require(false, "stiffness of the stiffest contact", static_cast<double>(environment_.series()), text);
  }

  /// The smallest damping along the contact with which it has the required margin [N s/m], for `always` of a
  /// `ContactDamper`. 0 if it needs none; never more than `margin / 1.5` times `contact_damping`.
  [[nodiscard]] SKINCTL_COLD T damping_for(const JointPosition<joints, T>& q, const Row& row) const {
    if (margin(q, row) >= environment_.margin) return T(0);
    T low(0), high = environment_.margin / T(1.5) *
                     contact_damping(T(environment_.force_gain * environment_.series()), total_delay());
    for (int n = 0; n < 30; ++n) {
      const T middle = T(0.5) * (low + high);
      (margin(q, row, middle) < environment_.margin ? low : high) = middle;
    }
    return high;
  }

 private:
  [[no_unique_address]] M model_;
  VirtualDynamics<joints, T> shape_;
  ContactEnvironment<T> environment_;
  detail::ContactPath<T> path_;
  [[no_unique_address]] Tool tool_;
};

SKINCTL_END_NAMESPACE
