// SPDX-License-Identifier: BSD-3-Clause
// The sliding surface of a tracking law at one instant, eqs. (9)-(14).
#pragma once

#include "skinctl/math/sum.hpp"
#include "skinctl/math/tanh.hpp"
#include "skinctl/tracking/settings.hpp"
#include "skinctl/tracking/surface_bias.hpp"
#include "skinctl/trajectory/spline.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Integrals of one kind, a compensated sum per joint: at 1 kHz a plain float sum stops growing after hours.
template <std::size_t N, Scalar T = double>
struct Integrals {
  T sum[N] = {};
  T carry[N] = {};  ///< rounding errors of the sums

  /// The integrals `dt` seconds later; a rate that is not finite adds nothing.
  [[nodiscard]] SKINCTL_INLINE Integrals advanced(const JointVelocity<N, T>& rate,
                                                  const T& dt) const noexcept {
    using R = detail::Row<N, T>;
    const R step = dt * R(rate);
    R total(sum), rest(carry);
    const R added = select(step - step == R(T(0)), step, T(0));
    R::each_block([&](auto k) SKINCTL_INLINE_LAMBDA {
      math::add_compensated(total.block[k], rest.block[k], added.block[k]);
    });
    Integrals next;
    total.store(next.sum);
    rest.store(next.carry);
    return next;
  }
};

/// How much of their limits the integrals use, 0 to 1, with the signs of the rates that use more.
template <std::size_t N, Scalar T = double>
struct IntegralsUsed {
  JointVelocity<N, T> I1, I2;
};

/// The state on the surface, and the reference motion that follows from it, in units of the velocity of the
/// coordinates: joints [rad/s], or a frame [m/s], [rad/s].
template <std::size_t N, Scalar T = double>
struct SlidingSurface {
  JointVelocity<N, T> S_delta;    ///< distance from the biased surface, `S - S_d`, eq. (12)
  JointVelocity<N, T> dI1;        ///< rate of the integral of S_delta
  JointVelocity<N, T> dI2;        ///< rate of the integral of tanh(mu S_delta)
  JointVelocity<N, T> dq_r;       ///< reference velocity, eq. (10)
  JointAcceleration<N, T> ddq_r;  ///< derivative of dq_r in time
  JointVelocity<N, T> S_q;        ///< sliding variable `dq - dq_r`, eq. (9)
};

/// The inputs of the surface beside the state, all at the same instant: a bias and integrals in `N`
/// coordinates, of the joints or of operational space.
template <std::size_t N, Scalar T = double, class Target = JointReference<N, T>>
struct SurfaceInputs {
  Target target;
  Gain<T> K_p;
  BiasNow<N, T> bias;
  JointVelocity<N, T> I1;  ///< integral of S_delta
  JointVelocity<N, T> I2;  ///< integral of tanh(mu S_delta)
  IntegralsUsed<N, T> used;
  bool held;  ///< whether the integrals are stopped
};

/// Gains of the surface, in the form in which the loop reads them.
template <Real T = double>
struct SurfaceGains {
  T K_i1, K_i2, mu;

  template <std::size_t N>
  explicit SurfaceGains(const JointControlSettings<N, T>& s) noexcept
      : K_i1(s.K_i1), K_i2(s.K_i2), mu(s.mu) {}

  /// The rate at which an integral grows: all of `rate` on the way back to zero, else the part that `used`
  /// leaves.
  template <std::size_t N>
  [[nodiscard]] static SKINCTL_INLINE detail::Row<N, T> taken(const JointVelocity<N, T>& used,
                                                              const detail::Row<N, T>& rate) noexcept {
    const detail::Row<N, T> share = used;
    return select(share * rate > detail::Row<N, T>(T(0)), rate - magnitude(share) * rate, rate);
  }
  /// How much of its limit > 0 a load uses, both of any unit: 0 up to half of it, then smoothly to 1, with
  /// the sign of the load.
  [[nodiscard]] static T used(const T& load, const T& limit) noexcept {
    const T share = T(2) * detail::magnitude(load) / limit - T(1);
    if (!(share > T(0))) return T(0);
    const T part = quintic(share).a1;
    return load < T(0) ? T(-part) : part;
  }
};

/// Errors of the coordinates, joints [rad] or a pose [m], [rad], and the motion of the target in them.
template <std::size_t N, Scalar T = double>
struct SurfaceErrors {
  T e[N];      ///< error of position, eqs. (13), (20)
  T de[N];     ///< error of velocity, as the sliding surface reads it, eqs. (12), (21)
  T slope[N];  ///< the true derivative of `e`: `de` in joint space
  T v_d[N];    ///< velocity of the target
  T a_d[N];    ///< acceleration of the target
};

/// The errors of `SurfaceErrors`, in lanes.
template <std::size_t N, Real T = double>
struct SurfaceErrorRows {
  detail::Row<N, T> e, de, slope, v_d, a_d;

  [[nodiscard]] SurfaceErrors<N, T> stored() const noexcept {
    SurfaceErrors<N, T> error;
    e.store(error.e), de.store(error.de), slope.store(error.slope), v_d.store(error.v_d),
        a_d.store(error.a_d);
    return error;
  }
};

/// The sliding surface and the reference motion in joint space, eqs. (10)-(13), or of a pose, eqs. (18)-(21),
/// with the derivative of (10); `rest(dq_r)` gives `S_q`. NaN in, NaN out.
template <std::size_t N, Real T, class Target, class Errors, class Rest>
[[nodiscard]] SKINCTL_INLINE SlidingSurface<N, T> sliding_surface(const SurfaceGains<T>& gains,
                                                                  const SurfaceInputs<N, T, Target>& in,
                                                                  const Errors& error, Rest&& rest) noexcept {
  using R = detail::Row<N, T>;
  const R e(error.e), de(error.de), slope(error.slope), v_d(error.v_d), a_d(error.a_d);
  const R S_d = in.bias.S_d, K = in.K_p.K, K_i1 = gains.K_i1, K_i2 = gains.K_i2;
  const R S_delta = de + K * e - S_d;
  R dI1 = T(0), dI2 = T(0);
  if (!in.held) [[likely]] {
    dI1 = gains.taken(in.used.I1, S_delta);
    dI2 = gains.taken(in.used.I2, math::tanh(gains.mu * S_delta));
  }
  const R dq_r = v_d - K * e + S_d - K_i1 * in.I1 - K_i2 * in.I2;
  const R ddq_r = a_d - K * slope - in.K_p.dK * e + in.bias.dS_d - K_i1 * dI1 - K_i2 * dI2;
  using Velocity = JointVelocity<N, T>;
  return {Velocity(S_delta), Velocity(dI1), Velocity(dI2), Velocity(dq_r), JointAcceleration<N, T>(ddq_r),
          rest(dq_r)};
}

SKINCTL_END_NAMESPACE
