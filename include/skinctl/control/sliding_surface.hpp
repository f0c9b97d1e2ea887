// The sliding surface of a tracking law at one instant, eqs. (9)-(14).
#pragma once

#include "skinctl/control/settings.hpp"
#include "skinctl/control/sign.hpp"
#include "skinctl/control/surface_bias.hpp"
#include "skinctl/math/sum.hpp"
#include "skinctl/trajectory/spline.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Integrals of one kind, a compensated sum per joint: at 1 kHz a plain float sum stops growing after hours.
template <std::size_t N, Scalar T = double>
struct Integrals {
  T sum[N] = {};
  T carry[N] = {};  ///< what the sums lack

  /// Adds `dt * rate`; a rate that is not finite adds nothing.
  SKINCTL_INLINE constexpr void add(std::size_t i, const T& rate, const T& dt) noexcept {
    const T step = dt * rate;
    math::add_compensated(sum[i], carry[i], step - step == T(0) ? step : T(0));
  }
  /// The integrals `dt` seconds later.
  [[nodiscard]] SKINCTL_INLINE constexpr Integrals advanced(const JointVelocity<N, T>& rate,
                                                            const T& dt) const noexcept {
    Integrals next;
    detail::for_each_index<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      next.sum[i] = sum[i];
      next.carry[i] = carry[i];
      next.add(i, rate[i], dt);
    });
    return next;
  }
};

/// Where the state is on the surface, and the reference motion that follows from it.
template <std::size_t N, Scalar T = double>
struct SlidingSurface {
  JointVelocity<N, T> S_delta;    ///< `S - S_d`, eq. (12)
  JointVelocity<N, T> dI1;        ///< rate of the integral of S_delta
  JointVelocity<N, T> dI2;        ///< rate of the integral of its sign
  JointVelocity<N, T> dq_r;       ///< eq. (10)
  JointAcceleration<N, T> ddq_r;  ///< its derivative in time
  JointVelocity<N, T> S_q;        ///< `dq - dq_r`, eq. (9)
};

/// What the surface is computed from, beside the state: all at the same instant.
///
/// `N` coordinates, of the joints or of operational space; a bias and integrals in them.
template <std::size_t N, Scalar T = double, class Target = JointReference<N, T>>
struct SurfaceInputs {
  Target target;
  Gain<T> K_p;
  BiasNow<N, T> bias;
  T I1[N];
  T I2[N];
  bool held;                 ///< the integrals stand still
  const T* twist = nullptr;  ///< what the sign integrates by itself
};

/// Gains of the surface, in the form in which the loop reads them.
template <Real T = double, class Sign = TanhSign>
struct SurfaceGains {
  T K_i1, K_i2, mu;
  T slope;               ///< the steepest of the sign
  T I1_limit, I2_limit;  ///< where the integrals stop

  template <std::size_t N>
  explicit SurfaceGains(const JointControlSettings<N, T>& s) noexcept
      : K_i1(s.K_i1),
        K_i2(s.K_i2),
        mu(s.mu),
        slope(Sign::slope(s.mu, s.K_i2, s.dt)),
        I1_limit(s.K_i1 > T(0) ? T(s.integral_limit / s.K_i1) : T(1)),
        I2_limit(s.K_i2 > T(0) ? T(s.integral_limit / s.K_i2) : T(1)) {}

  /// The part of its rate that an integral takes: all of it up to half the limit and on the way back, then
  /// less, smoothly, and none at the limit.
  [[nodiscard]] static SKINCTL_INLINE constexpr T taken(const T& integral, const T& rate,
                                                        const T& limit) noexcept {
    const T size = integral < T(0) ? T(-integral) : integral;
    if (!(T(2) * size > limit) || !(integral * rate > T(0))) [[likely]]
      return rate;
    return rate * quintic(T(T(2) * size / limit - T(1))).rest;
  }
};

/// Errors of the coordinates, and what the target itself does in them.
template <std::size_t N, Scalar T = double>
struct SurfaceErrors {
  T e[N];      ///< of position, eqs. (13), (20)
  T de[N];     ///< of velocity, as S reads it, eqs. (12), (21)
  T slope[N];  ///< the true derivative of `e`: `de` in joint space
  T v_d[N];    ///< velocity of the target
  T a_d[N];    ///< its acceleration
};

/// Eqs. (10)-(13), or (18)-(21), and the derivative of (10), without `S_q`. A NaN gives NaNs and nothing
/// worse.
template <std::size_t N, Real T, class Sign, class Target>
SKINCTL_INLINE void sliding_surface(SlidingSurface<N, T>& s, const SurfaceGains<T, Sign>& gains,
                                    const SurfaceInputs<N, T, Target>& in,
                                    const SurfaceErrors<N, T>& error) noexcept {
  for (std::size_t i = 0; i < N; ++i) s.S_delta[i] = error.de[i] + in.K_p.K * error.e[i] - in.bias.S_d[i];
  Sign::template rates<N>(s.S_delta.data, gains.slope, gains.mu, in.twist, s.dI2.data);
  for (std::size_t i = 0; i < N; ++i) {
    s.dI1[i] = in.held ? T(0) : gains.taken(in.I1[i], s.S_delta[i], gains.I1_limit);
    s.dI2[i] = in.held ? T(0) : gains.taken(in.I2[i], s.dI2[i], gains.I2_limit);
  }
  for (std::size_t i = 0; i < N; ++i) {
    s.dq_r[i] =
        error.v_d[i] - in.K_p.K * error.e[i] + in.bias.S_d[i] - gains.K_i1 * in.I1[i] - gains.K_i2 * in.I2[i];
    s.ddq_r[i] = error.a_d[i] - in.K_p.K * error.slope[i] - in.K_p.dK * error.e[i] + in.bias.dS_d[i] -
                 gains.K_i1 * s.dI1[i] - gains.K_i2 * s.dI2[i];
  }
}

SKINCTL_END_NAMESPACE
