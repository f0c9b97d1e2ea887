// SPDX-License-Identifier: BSD-3-Clause
// Friction that nobody compensates: a tracking law that learns it, and comes to rest at its target.
#pragma once

#include <algorithm>

#include "skinctl/tracking/detail/learning_law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Rate, bounds and dead zone of the learning.
template <std::size_t N, Real T = double>
struct FrictionLearningSettings {
  /// Rate g of the learning [1/s^2], > 0 and at most a quarter of the law's `lambda` squared: beyond it the
  /// answer to a step of friction oscillates. 100 suits lambda = 20 and faster.
  T rate = T(100);
  JointTorque<N, T> bound;  ///< largest learnt torque [N m]: the friction that is left over, with a margin
  /// Dead zone e_0 [rad]: a joint that rests within this of its target is left alone. Above the encoder's
  /// noise, and above half of the slip that stiction makes. 0.8 mrad: a step of 13 bits.
  T dead_zone = T(0.0008);
  /// Rate [1/s] at which S_q is smoothed before it is compared with the dead zone: noise is shorter.
  T smoothing = T(40);
};

namespace detail {
template <std::size_t N, Real T>
struct LearntFriction {
  JointTorque<N, T> friction;  ///< learnt torque f [N m]
  JointVelocity<N, T> smooth;  ///< smoothed `S_q = dq - dq_r` [rad/s]
};
}  // namespace detail

/// A tracking law `L` whose torque has f [N m] added, learnt by
///
///     df_i = -g M_ii S_q_i    outside of the dead zone,  |S_q_i| (smoothed) > K_c e_0,
///     df_i = 0                inside,
///
/// and kept within `+-bound`. Two cases are faster, in steps of `dt` of the law:
///
/// - `f S_q > 0`: f drives the joint beyond its reference. A joint that breaks loose rubs less than at rest
///   (stiction; a controller that compensates friction by the measured speed), and the torque that broke it
///   loose must not carry it across the target and back for ever. f falls to 0 at most, by `c |S_q_i|` a
///   second: `c = 2 bound_i / e_0` keeps the slip within the dead zone, at least `4 lambda^2 M_ii`, at most
///   what stops a quarter of the excess speed in a step, `M_ii / (4 dt^2)`.
/// - `|dq_i| < |dq_r_i| / 4`, and S_q beyond 1.5 times the dead zone: the joint sticks. No motion answers a
///   torque that friction takes, so nothing can oscillate: `1 / (4 dt)^2` stands in place of g, up to a 16th
///   of the bound a step. A joint that sticks again after each slip is back in seconds.
///
/// By itself `K_d S_q` balances Coulomb friction only with an error of `friction / (lambda M K_c)`: the dead
/// zone that a torque-controlled arm shows. An integral takes it away, and hunts around the target for ever;
/// here it stops inside of the dead zone, and dry friction holds what it has reached. At rest the error is at
/// most `e_0` in each joint. While the skin pushes against the law f stands, and numbers that are not finite
/// do not enter.
///
/// The integrals of the law itself have no dead zone: set `K_i1 = K_i2 = 0` in its settings.
template <class L>
class FrictionLearning
    : public detail::LearningLaw<FrictionLearning<L>, L, detail::LearntFriction<L::N, typename L::T>> {
  using Base = detail::LearningLaw<FrictionLearning<L>, L, detail::LearntFriction<L::N, typename L::T>>;

 public:
  using Base::N;
  using typename Base::Memory;
  using typename Base::Surface;
  using typename Base::T;
  using Settings = FrictionLearningSettings<N, T>;
  static constexpr Needs needs = L::needs | Needs{.mass = true};
  static constexpr const char* name = "friction learning";

  /// Throws `ConfigurationError` for a rate, bound, dead zone or smoothing out of range.
  /// @param of_law  the law's own settings: `K_c`, `lambda` and `dt` are read.
  FrictionLearning(const L& law, const JointControlSettings<N, T>& of_law, const Settings& settings)
      : Base(law),
        settings_(settings),
        release_(square(T(release_over_lambda) * of_law.lambda)),
        stop_(std::max(release_, T(T(step_share) / square(seconds<T>(of_law.dt))))),
        stick_(T(step_share * step_share) / square(seconds<T>(of_law.dt))),
        slip_(T(2) / settings.dead_zone),
        dead_(of_law.K_c * settings.dead_zone) {
    require(of_law.dt > 0ns, "dt of a law that learns friction", milliseconds(of_law.dt), "> 0 ms");
    const T most = square(T(T(0.5) * of_law.lambda));  // critical damping
    require(settings.rate > T(0) && settings.rate <= most, "rate of friction learning",
            static_cast<double>(settings.rate), "> 0, <= lambda^2 / 4, in 1/s^2");
    for (const T& b : settings.bound)
      require(b >= T(0) && b <= T(1e6), "bound of friction", static_cast<double>(b), "0 to 1e6 N m");
    require(settings.dead_zone > T(0) && settings.dead_zone <= T(0.1), "dead zone",
            static_cast<double>(settings.dead_zone), "> 0, <= 0.1 rad");
    require(settings.smoothing > T(0) && settings.smoothing <= T(1e4), "smoothing",
            static_cast<double>(settings.smoothing), "> 0, <= 1e4 1/s");
    require(of_law.K_i1 == T(0) && of_law.K_i2 == T(0), "K_i1 + K_i2 beside friction learning",
            static_cast<double>(of_law.K_i1 + of_law.K_i2), "0: they have no dead zone");
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE const JointTorque<N, T>& learnt_torque(const Memory& memory, const K&,
                                                                      const Surface&) const noexcept {
    return memory.friction;
  }
  template <class K>
  void learn(Memory& memory, const K& known, const T& dt, Opposition opposition,
             const Surface& at_t) const noexcept {
    const T fast = dt * settings_.smoothing, part = fast / (T(1) + fast);
    const auto& M = known.mass();
    for (std::size_t i = 0; i < N; ++i) {
      const T s = at_t.S_q[i];
      if (!(s - s == T(0))) continue;
      memory.smooth[i] = memory.smooth[i] + part * (s - memory.smooth[i]);
      const T size = memory.smooth[i] < T(0) ? T(-memory.smooth[i]) : memory.smooth[i];
      if (opposition == Opposition::lasting || size <= dead_) continue;
      T& f = memory.friction[i];
      const T bound = settings_.bound[i], dq_r = at_t.dq_r[i], dq = s + dq_r;
      if (f * s > T(0)) {
        const T c = std::min(std::max(T(release_ * M(i, i)), T(bound * slip_)), T(stop_ * M(i, i)));
        const T next = f - dt * c * s;
        f = next * f > T(0) ? Base::kept(next, bound, f) : T(0);
      } else if (dq * dq < T(step_share * step_share) * dq_r * dq_r && size > T(stick_from) * dead_) {
        const T most = T(step_share * step_share) * bound, step = dt * stick_ * M(i, i) * s;
        f = Base::kept(f - Base::kept(step, most, T(0)), bound, f);
      } else {
        f = Base::kept(f - dt * settings_.rate * M(i, i) * s, bound, f);
      }
    }
  }

 private:
  /// Share of a speed: what a step may stop, and below what a joint sticks; squared: the share of the bound
  /// by which a torque that friction takes may grow in a step. A quarter leaves a margin of four.
  static constexpr double step_share = 0.25;
  /// Square root of the smallest rate of a release, over lambda: the learnt torque falls faster than it grew.
  static constexpr double release_over_lambda = 2;
  /// Smallest |S_q| of a joint that counts as sticking, in dead zones: not at the edge of one.
  static constexpr double stick_from = 1.5;

  [[nodiscard]] static T square(const T& x) noexcept { return x * x; }

  Settings settings_;
  T release_, stop_, stick_;  ///< rates at a release, at its bound, and while sticking [1/s^2]
  T slip_;                    ///< release rate per speed, in bounds: `2 / e_0` [1/rad]
  T dead_;                    ///< speed of the dead zone, `K_c e_0` [rad/s]
};

SKINCTL_END_NAMESPACE
