// The quantities whose rounding errors are bounded, as programs in any scalar.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/studies/proofs/tape.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"

namespace skinctl::bounds {

/// The largest rates of the states, in magnitude.
struct Rates {
  double velocity = 3;      ///< [rad/s]
  double acceleration = 3;  ///< [rad/s^2]
};

enum class Quantity { pose, jacobian, gravity, inverse_dynamics, yr_theta, mass, forward_dynamics };
inline constexpr Quantity quantities[] = {
    Quantity::pose,     Quantity::jacobian, Quantity::gravity,         Quantity::inverse_dynamics,
    Quantity::yr_theta, Quantity::mass,     Quantity::forward_dynamics};
struct Named {
  const char *name, *unit;
  std::size_t rates;  ///< joint vectors besides q
};
inline Named named(Quantity q) {
  switch (q) {
    case Quantity::pose:
      return {"pose", "1 and m", 0};
    case Quantity::jacobian:
      return {"Jacobian", "1 and m", 0};
    case Quantity::gravity:
      return {"G", "N m", 0};
    case Quantity::inverse_dynamics:
      return {"inverse dynamics", "N m", 2};
    case Quantity::yr_theta:
      return {"Y_r Theta", "N m", 3};
    case Quantity::mass:
      return {"M", "kg m^2", 0};
    case Quantity::forward_dynamics:
      return {"forward dynamics", "N m", 2};
  }
  return {};
}

/// The links that carry no other: the tool of an arm, the tips of a hand.
template <Topology M>
constexpr LinkMask tips() {
  LinkMask mask = all_links(M::joints);
  for (std::size_t i = 0; i < M::joints; ++i)
    if (M::parents[i] >= 0) mask &= ~(LinkMask(1) << M::parents[i]);
  return mask;
}

/// The numbers of quantity `Q` at `x`: joint by joint its angle and its rates. (In this order a value of the
/// recursion depends on the first so many.)
template <Quantity Q, class T, RobotModel M>
std::vector<T> computed(const M& model, const T* x) {
  constexpr std::size_t N = M::joints;
  JointPosition<N, T> q;
  JointVelocity<N, T> dq, dq_r;
  JointAcceleration<N, T> ddq;
  constexpr bool moves =
      Q == Quantity::inverse_dynamics || Q == Quantity::yr_theta || Q == Quantity::forward_dynamics;
  const std::size_t stride = 1 + named(Q).rates;
  for (std::size_t i = 0; i < N; ++i) {
    q[i] = x[stride * i];
    if constexpr (moves) dq[i] = x[stride * i + 1], ddq[i] = x[stride * i + 2];
    if constexpr (Q == Quantity::yr_theta) dq_r[i] = x[stride * i + 3];
  }
  std::vector<T> out;
  const auto take = [&](const auto& v) { out.push_back(v.x), out.push_back(v.y), out.push_back(v.z); };
  const auto each_tip = [&](auto&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto one = [&](auto i) {
        if constexpr ((tips<M>() >> i.value) & 1u) f(i);
      };
      (one(std::integral_constant<std::size_t, I>{}), ...);
    }(std::make_index_sequence<N>{});
  };
  if constexpr (Q == Quantity::pose) {
    const Poses<M, tips<M>(), T> poses(model, q);
    each_tip([&](auto i) {
      const auto at = poses.template place<i.value>();
      take(dense<T>(at.x)), take(dense<T>(at.y)), take(dense<T>(at.z)), take(dense<T>(at.p));
    });
  } else if constexpr (Q == Quantity::jacobian) {
    const Poses<M, all_links(N), T> poses(model, q);
    each_tip([&](auto i) {
      jacobian<i.value>(poses).for_each(
          [&](auto, const auto& column) { take(column.linear), take(column.angular); });
    });
  } else if constexpr (Q == Quantity::gravity) {
    for (const T& t : gravity_torque(model, q)) out.push_back(t);
  } else if constexpr (Q == Quantity::inverse_dynamics) {
    for (const T& t : inverse_dynamics(model, q, dq, ddq)) out.push_back(t);
  } else if constexpr (Q == Quantity::yr_theta) {
    for (const T& t : yr_theta(model, q, dq, dq_r, ddq)) out.push_back(t);
  } else if constexpr (Q == Quantity::forward_dynamics) {
    // The torque that explains an acceleration, from M and the bias as forward dynamics computes them.
    const JointAngles<M, T> angles(model, q);
    const auto mass = mass_matrix(model, angles);
    const auto bias = bias_torque(model, angles, dq);
    if constexpr (!std::is_arithmetic_v<T>) math::Tape::current()->judge();
    for (const T& t : mass* ddq + bias) out.push_back(t);
  } else {
    const auto m = mass_matrix(model, q);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j <= i; ++j) out.push_back(m(i, j));
  }
  return out;
}

/// The inputs of forward dynamics for a state of q, dq and the acceleration: all q, all dq, the torques.
template <class R, RobotModel M>
std::vector<R> with_torques(const M& model, const R* x) {
  constexpr std::size_t N = M::joints;
  JointPosition<N, R> q;
  JointVelocity<N, R> dq;
  JointAcceleration<N, R> ddq;
  for (std::size_t i = 0; i < N; ++i) q[i] = x[3 * i], dq[i] = x[3 * i + 1], ddq[i] = x[3 * i + 2];
  std::vector<R> out(q.begin(), q.end());
  out.insert(out.end(), dq.begin(), dq.end());
  for (const R& t : inverse_dynamics(model, q, dq, ddq)) out.push_back(t);
  return out;
}
/// Forward dynamics of such inputs.
template <class T, RobotModel M>
auto acceleration(const M& model, const T* x) {
  constexpr std::size_t N = M::joints;
  JointPosition<N, T> q;
  JointVelocity<N, T> dq;
  JointTorque<N, T> tau;
  for (std::size_t i = 0; i < N; ++i) q[i] = x[i], dq[i] = x[N + i], tau[i] = x[2 * N + i];
  return forward_dynamics(model, q, dq, tau).acceleration;
}
/// The error of forward dynamics as a torque: `M ddq + C dq + G - tau` of the computed ddq, judged with more
/// digits. None where an acceleration is beyond `fastest`: no such state is promised anything.
template <class R, class Wide, RobotModel M, RobotModel W>
std::vector<double> unexplained_torque(const M& model, const W& wide, const R* x, double fastest) {
  constexpr std::size_t N = M::joints;
  const auto ddq = acceleration(model, x);
  if (std::any_of(ddq.begin(), ddq.end(),
                  [&](R a) { return !(std::abs(static_cast<double>(a)) <= fastest); }))
    return {};
  JointPosition<N, Wide> q;
  JointVelocity<N, Wide> dq;
  for (std::size_t i = 0; i < N; ++i) q[i] = static_cast<Wide>(x[i]), dq[i] = static_cast<Wide>(x[N + i]);
  const auto explained = inverse_dynamics(wide, q, dq, ddq.template cast<Wide>());
  std::vector<double> out;
  for (std::size_t i = 0; i < N; ++i)
    out.push_back(static_cast<double>(explained[i] - static_cast<Wide>(x[2 * N + i])));
  return out;
}

/// What the factorisation and solution of `M ddq = tau - bias` add to it, for a chain of at most `n` joints.
///
/// With the rows of M scaled by the roots of its diagonal, `|L'| |D| |L| <= sqrt(m_ii m_jj)` (Cauchy and
/// Schwarz; the product is M up to its own rounding). The backward error is at most `gamma(3 n + 4)` of that:
/// n + 2 roundings in an entry of the factors (n differences, a product, a quotient by an inverse), n in each
/// of the two substitutions, 2 in the division by a pivot; the difference of the torques adds a unit of `M
/// ddq`.
///
/// @param diagonal  upper limits of the diagonal of M over all states.
/// @param unit      2^-24 or 2^-53.
/// @param fastest   of the accelerations [rad/s^2].
inline double factorisation_error(const std::vector<double>& diagonal, std::size_t n, double unit,
                                  double fastest) {
  const double k = (3.0 * static_cast<double>(n) + 5) * unit, gamma = k / (1 - k) * 1.001;
  double roots = 0, largest = 0;
  for (const double d : diagonal) roots += std::sqrt(d), largest = std::max(largest, std::sqrt(d));
  return gamma * largest * roots * fastest;
}

}  // namespace skinctl::bounds
