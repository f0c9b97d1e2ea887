// Forms of the sign in the second integral of the sliding surface, eqs. (10), (14).
#pragma once

#include <cmath>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/math/tanh.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A sign turns S_delta into the rate of the second integral, in [-1, 1]. `slope` is its steepest slope,
/// which the bound of the gains reads; `twists`: whether it has an integral of its own.

/// The paper's `tanh(mu S)`: smooth everywhere, exponentially close to the sign.
struct TanhSign {
  static constexpr bool twists = false;
  template <std::size_t N, Real T>
  [[nodiscard]] SKINCTL_INLINE static auto rate(const detail::Row<N, T>& S, const T& mu, const T&,
                                                const T*) noexcept {
    return math::tanh(mu * S);
  }
  template <Real T>
  [[nodiscard]] static T slope(const T& mu, const T&, const T&) noexcept {
    return mu;
  }
};

/// `mu S`, cut off at -1 and 1: the cheapest.
struct SaturationSign {
  static constexpr bool twists = false;
  template <std::size_t N, Real T>
  [[nodiscard]] SKINCTL_INLINE static auto rate(const detail::Row<N, T>& S, const T& mu, const T&,
                                                const T*) noexcept {
    return clamp(mu * S, T(-1), T(1));
  }
  template <Real T>
  [[nodiscard]] static T slope(const T& mu, const T&, const T&) noexcept {
    return mu;
  }
};

/// The set-valued sign itself, by backward Euler (Acary and Brogliato, 2010): `nu = sign(S')` where
/// `S' = S - h K_i2 nu` is the surface after the robot has followed, h = 10 intervals; so
/// `nu = S / (h K_i2)`, cut off at -1 and 1. It has no mu and is as steep as sampled time and a cycle of
/// delay allow: with h of one interval it would be dead-beat, and any delay would make it oscillate.
struct ImplicitSign {
  static constexpr bool twists = false;
  template <std::size_t N, Real T>
  [[nodiscard]] SKINCTL_INLINE static auto rate(const detail::Row<N, T>& S, const T& slope, const T&,
                                                const T* z) noexcept {
    return SaturationSign::rate(S, slope, slope, z);
  }
  template <Real T>
  [[nodiscard]] static T slope(const T&, const T& K_i2, const T& dt) noexcept {
    return K_i2 > T(0) ? T(T(0.1) / (dt * K_i2)) : T(0);
  }
};

/// Super-twisting (Levant, 1993): `sqrt(mu |S|) sign(S) + z`, `dz = mu sign(S)`, cut off at -1 and 1: two
/// integrals lie between the jump of the sign and the torque. Where root and sign are steeper than sampled time
/// allows, straight lines take their places: `slope`, and `twist` for the sign of z.
struct SuperTwistingSign {
  static constexpr bool twists = true;
  template <std::size_t N, Real T>
  [[nodiscard]] SKINCTL_INLINE static auto rate(const detail::Row<N, T>& row, const T& slope, const T& mu,
                                                const T* z) noexcept {
    using std::sqrt;
    T S[N];
    row.store(S);
    for (std::size_t i = 0; i < N; ++i) {
      const T size = S[i] < T(0) ? T(-S[i]) : S[i];
      const T root = sqrt(T(mu * size)), line = slope * size;
      const T x = (S[i] < T(0) ? T(-1) : T(1)) * (root < line ? root : line) + z[i];
      S[i] = x > T(1) ? T(1) : (x < T(-1) ? T(-1) : x);
    }
    return detail::Row<N, T>(S);
  }
  template <Real T>
  [[nodiscard]] static T slope(const T& mu, const T& K_i2, const T& dt) noexcept {
    const T most = ImplicitSign::slope(mu, K_i2, dt);
    return most > mu ? most : mu;
  }
  /// The steepest slope of dz over S [1/s / (rad/s)].
  ///
  /// Beside S the z loop is an oscillator, `S'' + c S' + K_i2 twist S = 0`. Its root damps it least at the
  /// greatest S with this slope, `S = mu / twist`, by `c = K_i1 + K_i2 min(slope, sqrt(twist))`. Delays take
  /// `K_i2 twist dt` of c for each interval that they last, so `K_i2 twist dt <= c/8` leaves room for several of
  /// them; with c/5 some gains rang.
  template <Real T>
  [[nodiscard]] static T twist(const T& mu, const T& K_i1, const T& K_i2, const T& slope,
                               const T& dt) noexcept {
    using std::sqrt;
    const T sharp = T(100) * mu * mu, share = T(0.125) / dt;
    if (!(K_i2 > T(0))) return sharp;
    // y = sqrt(twist): y^2 <= share (K_i1 / K_i2 + min(slope, y))
    const T rest = share * K_i1 / K_i2, half = T(0.5) * share, y = half + T(sqrt(half * half + rest));
    const T most = y < slope ? T(y * y) : T(rest + share * slope);
    return sharp < most ? sharp : most;
  }
};

/// The own integral of a sign: none, or the z of super-twisting.
template <class Sign, std::size_t N, Real T>
struct SignMemory {
  [[nodiscard]] const T* data() const noexcept { return nullptr; }
  template <class Gains>
  [[nodiscard]] SignMemory advanced(const T*, const Gains&, const T&, bool) const noexcept {
    return *this;
  }
};
template <class Sign, std::size_t N, Real T>
  requires(Sign::twists)
struct SignMemory<Sign, N, T> {
  T z[N] = {};
  [[nodiscard]] const T* data() const noexcept { return z; }
  /// `dt` later; a NaN in S changes nothing, and nothing changes while the law is held.
  template <class Gains>
  [[nodiscard]] SignMemory advanced(const T* S, const Gains& gains, const T& dt, bool held) const noexcept {
    SignMemory next = *this;
    if (held) return next;
    for (std::size_t i = 0; i < N; ++i) {
      const T x = gains.twist * S[i], mu = gains.mu;
      const T rate = x > mu ? mu : (x < -mu ? T(-mu) : (x == x ? x : T(0)));
      const T z_i = z[i] + dt * rate;
      next.z[i] = z_i > T(1) ? T(1) : (z_i < T(-1) ? T(-1) : z_i);
    }
    return next;
  }
};

SKINCTL_END_NAMESPACE
