// SPDX-License-Identifier: BSD-3-Clause
// How much lighter a robot may be than its model says, and how firmly its joints must hold a payload that is
// lost.
#pragma once

#include <cstdint>
#include <limits>

#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// Calls `f` with `Poses` poses within +-pi, the same each time.
template <int Poses, std::size_t N, Real T, class F>
SKINCTL_COLD void each_pose(F&& f) {
  std::uint64_t bits = 1;
  for (int pose = 0; pose < Poses; ++pose) {
    JointPosition<N, T> q;
    for (T& angle : q) {
      bits = bits * 6364136223846793005u + 1442695040888963407u;
      angle = T((static_cast<double>(bits >> 32) / 4294967296.0 - 0.5) * 6.2832);
    }
    f(q);
  }
}
/// The smallest x, at least `from`, for which `matrices_of(q)(x)`, true above some x, is true in all of them;
/// to 0.1 %, infinite beyond 1e6.
template <std::size_t N, Real T, class F>
[[nodiscard]] SKINCTL_COLD T smallest_in_all_poses(const T& from, const F& matrices_of) {
  T found = from;
  each_pose<64, N, T>([&](const JointPosition<N, T>& q) {
    if (!(found <= T(1e6))) return;
    const auto is_enough = matrices_of(q);
    T low = found, high = T(1.001) * found;
    while (!is_enough(high)) {
      low = high;
      high = T(2) * high;
      if (low > T(1e6)) {
        found = std::numeric_limits<T>::infinity();
        return;
      }
    }
    while (high > T(1.001) * low) {
      const T middle = T(0.5) * (low + high);
      (is_enough(middle) ? high : low) = middle;
    }
    found = low > found ? high : found;
  });
  return found;
}
}  // namespace detail

/// The least and the largest inertia of each joint over 64 poses [kg m^2].
template <std::size_t N, Real T>
struct InertiaRange {
  JointTorque<N, T> least, most;
};
/// The range of each joint's inertia `M_ii` over the same poses as in `mass_ratio`, its motor included.
template <RobotModel M, Real T>
[[nodiscard]] SKINCTL_COLD InertiaRange<M::joints, T> inertia_range(const M& model,
                                                                    const JointTorque<M::joints, T>& rotors) {
  InertiaRange<M::joints, T> out{JointTorque<M::joints, T>::constant(std::numeric_limits<T>::infinity()),
                                 rotors};
  detail::each_pose<64, M::joints, T>([&](const JointPosition<M::joints, T>& q) {
    const auto mass = mass_matrix(model, q);
    for (std::size_t i = 0; i < M::joints; ++i) {
      const T inertia = mass(i, i) + rotors[i];
      if (inertia > out.most[i]) out.most[i] = inertia;
      if (inertia < out.least[i]) out.least[i] = inertia;
    }
  });
  return out;
}

/// The largest eigenvalue of `(M_b(q) + diag(rotors))^-1 (M_a(q) + diag(rotors))` over 64 poses within +-pi,
/// at least 1: a torque made for model `a` accelerates a robot like model `b` up to so many times faster. To
/// 0.1 %; infinite beyond 1e6 and where M_b is not positive definite. For configuration, not for the loop.
///
/// @param rotors  inertia of the motors, seen at the joints, the same in both [kg m^2].
template <RobotModel A, RobotModel B, Real T>
  requires(A::joints == B::joints)
[[nodiscard]] SKINCTL_COLD T mass_ratio(const A& a, const B& b, const JointTorque<A::joints, T>& rotors) {
  constexpr std::size_t N = A::joints;
  return detail::smallest_in_all_poses<N>(T(1), [&](const JointPosition<N, T>& q) {
    return [&, heavy = mass_matrix(a, q), light = mass_matrix(b, q)](const T& x) {
      T rest[N * N];
      for (std::size_t i = 0; i < N * N; ++i) rest[i] = x * light.data[i] - heavy.data[i];
      for (std::size_t i = 0; i < N; ++i) rest[i * N + i] = rest[i * N + i] + (x - T(1)) * rotors[i];
      return math::Ldlt<N, T>(rest).positive_definite();
    };
  });
}

/// The largest eigenvalue, in size, of `(M_a(q) + diag(rotors))^-1 d(G_a - G_b)/dq` over the same poses
/// [1/s^2], at least 0.001: with a stiffness of `x (M_a + diag(rotors))` about a pose, x below it, a robot
/// like model `b` falls away from the pose under the gravity that a torque made for model `a` compensates
/// wrongly. As `mass_ratio` otherwise.
template <RobotModel A, RobotModel B, Real T>
  requires(A::joints == B::joints)
[[nodiscard]] SKINCTL_COLD T gravity_rate(const A& a, const B& b, const JointTorque<A::joints, T>& rotors) {
  constexpr std::size_t N = A::joints;
  return detail::smallest_in_all_poses<N>(T(1e-3), [&](const JointPosition<N, T>& q) {
    constexpr T step = T(0.01);  // [rad]: rounding in float and curvature are below 0.1 %
    MassMatrix<N, T> slope = mass_matrix(a, q);
    const auto mass = slope;
    for (std::size_t j = 0; j < N; ++j) {
      auto there = q, here = q;
      there[j] = there[j] + step, here[j] = here[j] - step;
      const auto change = (gravity_torque(a, there) - gravity_torque(b, there)) -
                          (gravity_torque(a, here) - gravity_torque(b, here));
      for (std::size_t i = 0; i < N; ++i) slope(i, j) = change[i] / (T(2) * step);
    }
    return [&, mass, slope](const T& x) {
      const auto holds = [&](const T& sign) {
        T rest[N * N];
        for (std::size_t i = 0; i < N * N; ++i) rest[i] = x * mass.data[i] + sign * slope.data[i];
        for (std::size_t i = 0; i < N; ++i) rest[i * N + i] = rest[i * N + i] + x * rotors[i];
        return math::Ldlt<N, T>(rest).positive_definite();
      };
      return holds(T(1)) && holds(T(-1));
    };
  });
}

SKINCTL_END_NAMESPACE
