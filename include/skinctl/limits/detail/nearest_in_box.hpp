// SPDX-License-Identifier: BSD-3-Clause
// Joint velocities within bounds, reached by impulses on the bounded joints only.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Velocities within bounds, and the impulses [N m s] that lead there.
template <std::size_t N, Real T>
struct Bounded {
  JointVelocity<N, T> u;
  JointTorque<N, T> impulse;  ///< impulse taken off: >= 0 at an upper bound, <= 0 at a lower one, else 0
  bool exact = true;          ///< every velocity keeps its bounds; else the number of steps ran out
};

/// The velocities nearest to `u` in kinetic energy, `min (v - u)' M (v - u) / 2`, with `lower <= v <= upper`.
///
/// Every joint has stops that push that joint only, and only back (Gauss's principle): the impulses `p = M
/// (u - v)` are complementary to the distances from the bounds, so no joint is moved to hold another one,
/// and all that p does is to take energy. Found by principal pivoting: the joints that break a bound are put
/// on it, those whose stop would pull are released, all at once, and if that does not settle, one by one. The
/// number of steps is limited; when they run out, each impulse still has its sign.
///
/// @param mass  symmetric positive definite.
template <std::size_t N, Real T>
[[nodiscard]] SKINCTL_NOINLINE Bounded<N, T> nearest_in_box(const MassMatrix<N, T>& mass,
                                                            const JointVelocity<N, T>& u,
                                                            const JointVelocity<N, T>& lower,
                                                            const JointVelocity<N, T>& upper) noexcept {
  constexpr int together = 8, most = together + 2 * static_cast<int>(N);
  constexpr T rounding = T(64) * std::numeric_limits<T>::epsilon();
  Bounded<N, T> out{u, {}, false};
  int side[N];  // +1 at the upper bound, -1 at the lower one
  for (std::size_t i = 0; i < N; ++i) side[i] = u[i] > upper[i] ? 1 : (u[i] < lower[i] ? -1 : 0);
  for (int step = 0; step < most && !out.exact; ++step) {
    T change[N], a[N * N], b[N];
    for (std::size_t i = 0; i < N; ++i)
      change[i] = side[i] > 0 ? T(upper[i] - u[i]) : (side[i] < 0 ? T(lower[i] - u[i]) : T(0));
    for (std::size_t i = 0; i < N; ++i) {
      b[i] = side[i] != 0 ? T(mass(i, i) * change[i]) : T(0);
      for (std::size_t j = 0; j < N; ++j) {
        const bool own = side[i] == 0 && side[j] == 0;
        a[N * i + j] = own || i == j ? mass(i, j) : T(0);
        if (side[i] == 0 && side[j] != 0) b[i] -= mass(i, j) * change[j];
      }
    }
    T moved[N];
    math::Ldlt<N, T>(a).solve(b, moved);
    out.exact = true;
    for (std::size_t k = 0; k < N; ++k) {
      const std::size_t i = N - 1 - k;
      T p(0), size(0);
      for (std::size_t j = 0; j < N; ++j) {
        p -= mass(i, j) * moved[j];
        size += magnitude(T(mass(i, j) * moved[j]));
      }
      const T v = u[i] + moved[i], slack = rounding * (magnitude(u[i]) + magnitude(moved[i]));
      int next = side[i];
      if (side[i] == 0)
        next = v > upper[i] + slack ? 1 : (v < lower[i] - slack ? -1 : 0);
      else if (T(side[i]) * p < -rounding * size)
        next = 0;
      out.u[i] = side[i] > 0 ? upper[i] : (side[i] < 0 ? lower[i] : v);
      out.impulse[i] = T(side[i]) * p > T(0) ? p : T(0);
      if (next == side[i] || (step >= together && !out.exact)) continue;
      side[i] = next;  // beyond `together`, of the last such joint only
      out.exact = false;
    }
  }
  return out;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
