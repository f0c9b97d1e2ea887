// How many times lighter a robot may be than its model says.
#pragma once

#include <cstdint>
#include <limits>

#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The largest eigenvalue of `(M_b(q) + diag(rotors))^-1 (M_a(q) + diag(rotors))` over 64 poses within +-pi, at least 1:
/// a torque made for model `a` accelerates a robot like model `b` up to so many times faster. To 0.1 %; infinite beyond
/// 1e6 and where M_b is not positive definite. For configuration, not for the loop.
///
/// @param rotors  inertia of the motors, seen at the joints, the same in both [kg m^2].
template <RobotModel A, RobotModel B, Real T>
  requires(A::joints == B::joints)
[[nodiscard]] SKINCTL_COLD T mass_ratio(const A& a, const B& b, const JointTorque<A::joints, T>& rotors) {
  constexpr std::size_t N = A::joints;
  T ratio(1);
  std::uint64_t bits = 1;
  for (int pose = 0; pose < 64; ++pose) {
    JointPosition<N, T> q;
    for (T& angle : q) {
      bits = bits * 6364136223846793005u + 1442695040888963407u;
      angle = T((static_cast<double>(bits >> 32) / 4294967296.0 - 0.5) * 6.2832);
    }
    const auto heavy = mass_matrix(a, q), light = mass_matrix(b, q);
    // x light - heavy is positive definite exactly above the largest eigenvalue.
    const auto is_above = [&](const T& x) {
      T rest[N * N];
      for (std::size_t i = 0; i < N * N; ++i) rest[i] = x * light.data[i] - heavy.data[i];
      for (std::size_t i = 0; i < N; ++i) rest[i * N + i] = rest[i * N + i] + (x - T(1)) * rotors[i];
      return math::Ldlt<N, T>(rest).positive_definite();
    };
    T low = ratio, high = T(1.001) * ratio;
    while (!is_above(high)) {
      if (!(high <= T(1e6))) return std::numeric_limits<T>::infinity();
      low = high;
      high = T(2) * high;
    }
    while (high > T(1.001) * low) {
      const T middle = T(0.5) * (low + high);
      (is_above(middle) ? high : low) = middle;
    }
    ratio = low > ratio ? high : ratio;
  }
  return ratio;
}

SKINCTL_END_NAMESPACE
