// SPDX-License-Identifier: BSD-3-Clause
// Dry friction with sticking.
#pragma once

#include <limits>

#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/detail/block_ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Dry friction, implicit and set-valued at rest: the velocity `u` with `m (u - v) + c S = impulse`, S in
/// [-1, 1], and S = sign(u) where u is not zero. `u` enters as the solution without friction.
///
/// It is the minimum of `u'm u/2 - b'u + c'|u|` with `b = impulse + m v`. A few sweeps over the joints come
/// near; from there the moving joints are solved together, one that would reverse sticks, and the one that
/// breaks loose hardest moves, until no joint changes. Each round lowers the function, so it ends at the
/// minimum; the bound on rounds is for rounding only.
template <std::size_t N, Real T>
SKINCTL_NOINLINE void stick_or_slip(const MassMatrix<N, T>& m, const JointTorque<N, T>& c,
                                    const JointTorque<N, T>& impulse, const JointVelocity<N, T>& v,
                                    JointVelocity<N, T>& u) noexcept {
  JointTorque<N, T> b;
  int way[N] = {};
  const auto without = [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    T s = b[i];
    for (std::size_t j = 0; j < N; ++j)
      if (j != i) s = s - m(i, j) * u[j];
    return s;
  };
  for (std::size_t i = 0; i < N; ++i) {
    T s = impulse[i];
    for (std::size_t j = 0; j < N; ++j) s = s + m(i, j) * v[j];
    b[i] = s;
  }
  constexpr int sweeps = 3;  // a guess which joints stick, as most often it leaves one round
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t k = 0; k < N; ++k) {
      const std::size_t i = N - 1 - k;
      const T s = without(i);
      way[i] = s > c[i] ? 1 : (s < -c[i] ? -1 : 0);
      u[i] = T((s - T(way[i]) * c[i]) / m(i, i)) * T(way[i] == 0 ? 0 : 1);
    }
  }
  // Each round stops or frees one joint; the bound is for rounding that repeats.
  constexpr std::size_t rounds = 4 * N + 4;
  for (std::size_t round = 0; round < rounds; ++round) {
    MassMatrix<N, T> moving = m;
    JointTorque<N, T> rest;
    for (std::size_t i = 0; i < N; ++i) {
      if (way[i] == 0) {
        for (std::size_t j = 0; j < N; ++j) moving(i, j) = moving(j, i) = T(i == j ? 1 : 0);
      } else {
        rest[i] = b[i] - T(way[i]) * c[i];
      }
    }
    JointVelocity<N, T> best;
    const math::detail::OneSystem<N, T> factors(moving.data);
    if (!factors.positive_definite()) return;
    factors.solve(rest.data, best.data);
    T part(1);
    std::size_t sticks = N;
    for (std::size_t i = 0; i < N; ++i) {
      if (way[i] == 0 || best[i] * T(way[i]) > T(0)) continue;
      const T at = u[i] == best[i] ? T(0) : T(u[i] / (u[i] - best[i]));
      if (sticks == N || at < part) part = at, sticks = i;
    }
    for (std::size_t i = 0; i < N; ++i) u[i] = sticks == N ? best[i] : T(u[i] + part * (best[i] - u[i]));
    if (sticks != N) {
      u[sticks] = T(0);
      way[sticks] = 0;
      continue;
    }
    T most(0);
    std::size_t loose = N;
    for (std::size_t i = 0; i < N; ++i) {
      if (way[i] != 0) continue;
      const T s = without(i), over = (s < T(0) ? T(-s) : s) - c[i];
      if (over > most + T(16) * std::numeric_limits<T>::epsilon() * (c[i] + (b[i] < T(0) ? T(-b[i]) : b[i])))
        most = over, loose = i, way[i] = 0;
    }
    if (loose == N) return;
    way[loose] = without(loose) > T(0) ? 1 : -1;
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
