// SPDX-License-Identifier: BSD-3-Clause
// The bias S_d of the sliding surface: the difference that a reset leaves, and its decay.
#pragma once

#include <cmath>
#include <type_traits>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/tracking/detail/thresholds.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// The decay `exp(-kappa t)` of a bias. For the interval between evaluations, and its half, it is known
/// beforehand.
template <Real T = double>
class Decay {
 public:
  /// A decay for intervals that are not known.
  Decay(const T& kappa) noexcept : Decay(kappa, T(0)) {}
  /// @param kappa  rate of the decay [1/s]; `dt`: the interval between evaluations [s].
  Decay(const T& kappa, const T& dt) noexcept
      : kappa_(kappa),
        dt_(dt),
        half_(T(0.5) * dt),
        rest_(by_library(dt_)),
        rest_of_half_(by_library(half_)) {}

  [[nodiscard]] SKINCTL_INLINE const T& kappa() const noexcept { return kappa_; }
  /// The share `exp(-kappa t)` of the bias that is left after `t` [s].
  [[nodiscard]] SKINCTL_INLINE T after(const T& t) const noexcept {
    if constexpr (std::is_floating_point_v<T>) {
      if (t == half_) return rest_of_half_;
      if (t == dt_) return rest_;
    }
    return by_library(t);
  }

 private:
  [[nodiscard]] SKINCTL_INLINE T by_library(const T& t) const noexcept {
    using std::exp;
    return T(exp(T(-kappa_ * t)));
  }
  T kappa_, dt_, half_, rest_, rest_of_half_;
};
}  // namespace detail

/// The bias `S_d` of the sliding surface at an instant, and its derivative.
template <std::size_t N, Scalar T = double>
struct BiasNow {
  JointVelocity<N, T> S_d;
  JointAcceleration<N, T> dS_d;
};

/// The bias since a reset at t0; trivially copyable, zero by default:
///
///     S_d = decaying exp(-kappa (t - t0)) + (1 - a1(r)) dv + T_h p(r) da + T_h^2 b(r) dj,
///     r = (t - t0) / T_h,   p = r - 6 r^3 + 8 r^4 - 3 r^5,   b = r^2 (1 - r)^3 / 2.
///
/// The first part is that of eq. (12). The others are the bumpless transfer: with `dv`, `da` and `dj` the
/// changes of dq_r, ddq_r and its rate at the reset, all three continue from their old values and reach their
/// new course after T_h, and with them the torque and its rate. As dS_d is the true derivative, the surface
/// stays invariant meanwhile. A difference of torque, ramped out, would be a disturbance that K_d works
/// against: the torque would change by M da within 1/lambda, not T_h.
template <std::size_t N, Real T = double>
struct SurfaceBias {
  Nanoseconds elapsed = clock_end;  ///< time since the reset at t0
  JointVelocity<N, T> decaying;     ///< part of the bias that decays with kappa, now
  JointVelocity<N, T> dv;
  JointAcceleration<N, T> da;
  JointAcceleration<N, T> dj;  ///< change of the rate of ddq_r at the reset [rad/s^3]

  /// The bias `x` seconds from now, decaying with kappa [1/s], for a bumpless transfer of `T_h` seconds.
  [[nodiscard]] SKINCTL_INLINE BiasNow<N, T> at(const T& x, const detail::Decay<T>& decay,
                                                const T& T_h) const noexcept {
    using R = detail::Row<N, T>;
    R S_d = x > T(0) ? decay.after(x) * R(decaying) : R(decaying);
    R dS_d = T(-decay.kappa()) * S_d;
    const T t = seconds<T>(elapsed) + x;
    if (t < T_h) [[unlikely]] {
      const T r = t / T_h;
      const auto out = quintic(r, T(T(1) / T_h));
      const T rest = T(1) - r;
      const T p = T_h * r * rest * rest * rest * (T(1) + T(3) * r);
      const T dp = rest * rest * (T(1) + r * (T(2) - T(15) * r));
      const T half = T(0.5) * T_h * r * rest * rest;
      const T b = T_h * half * r * rest;
      const T db = half * (T(2) - T(5) * r);
      S_d = S_d + out.rest * R(dv) + p * R(da) + b * R(dj);
      dS_d = dS_d - out.a2 * R(dv) + dp * R(da) + db * R(dj);
    }
    return {JointVelocity<N, T>(S_d), JointAcceleration<N, T>(dS_d)};
  }
  /// The same bias `dt` seconds later.
  [[nodiscard]] SKINCTL_INLINE SurfaceBias advanced(const T& dt, Nanoseconds ns,
                                                    const detail::Decay<T>& decay) const noexcept {
    const detail::Row<N, T> s = decay.after(dt) * detail::Row<N, T>(decaying),
                            tiny = T(detail::smallest_motion);
    return {later(elapsed, ns),
            JointVelocity<N, T>(select(magnitude(s) > tiny, s, T(0))),  // denormal numbers are slow
            dv, da, dj};
  }
  /// The contribution of a `dj` of 1 to dS_d after `x` seconds: `x`, faded out towards T_h.
  [[nodiscard]] static constexpr T bend(const T& x, const T& T_h) noexcept {
    const T r = x / T_h, rest = T(1) - r;
    return x * rest * rest * (T(1) - T(2.5) * r);
  }
  /// Whether the bumpless transfer still goes on.
  [[nodiscard]] SKINCTL_INLINE bool is_transferring(Nanoseconds T_h) const noexcept { return elapsed < T_h; }
};

SKINCTL_END_NAMESPACE
