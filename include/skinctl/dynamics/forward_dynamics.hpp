// SPDX-License-Identifier: BSD-3-Clause
// Joint accelerations from torques.
#pragma once

#include <type_traits>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Result of `forward_dynamics`: the joints' acceleration, and whether the mass matrix was positive definite.
template <std::size_t N, Scalar T = double>
struct ForwardDynamics {
  JointAcceleration<N, T> acceleration;  ///< acceleration of each joint [rad/s^2]
  bool positive_definite = true;         ///< whether M was positive definite; false: see `MassFactors`
};

/// A mass matrix factorised as `L' D L`, where L has the zeros of the tree: row k of L has entries only for
/// the joints that carry link k, so separate branches cost nothing (Featherstone, Rigid Body Dynamics
/// Algorithms, section 6.5).
template <Topology M, Scalar T = double>
class MassFactors {
 public:
  static constexpr std::size_t joints = M::joints;

  /// Factorises a mass matrix. A pivot that is not positive (no mass there, or NaN) is removed: that joint
  /// does not accelerate, and `positive_definite()` is false.
  SKINCTL_INLINE explicit MassFactors(const MassMatrix<joints, T>& mass) noexcept {
    factorise<false>(mass);
    if (!positive_definite_) [[unlikely]] {
      const MassFactors careful = without_bad_pivots(mass);
      for_each_entry([&](auto i, auto j) SKINCTL_INLINE_LAMBDA { l_(i, j) = careful.l_(i, j); });
      detail::unrolled<joints>([&](std::size_t i)
                                   SKINCTL_INLINE_LAMBDA { inverse_[i] = careful.inverse_[i]; });
    }
  }

  /// The acceleration under `tau`: `M^-1 tau` [rad/s^2].
  [[nodiscard]] SKINCTL_INLINE JointAcceleration<joints, T> solve(
      const JointTorque<joints, T>& tau) const noexcept {
    JointAcceleration<joints, T> x;
    detail::unrolled<joints>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { x[i] = tau[i]; });
    for_each_pair_from_the_tips([&](auto k, auto carriers) SKINCTL_INLINE_LAMBDA {
      for_each_bit<carriers.value>(
          [&](auto j) SKINCTL_INLINE_LAMBDA { x[j.value] = x[j.value] - l_(k.value, j.value) * x[k.value]; });
    });
    [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      const auto one = [&](auto k) SKINCTL_INLINE_LAMBDA {
        T sum = x[k.value] * inverse_[k.value];
        // Subtract the joint computed last at the end: the others are subtracted while it is still being
        // computed.
        detail::unrolled<k.value>([&](auto j) SKINCTL_INLINE_LAMBDA {
          if constexpr ((carriers_of(k.value) >> j) & 1u) sum = sum - l_(k.value, j) * x[j];
        });
        x[k.value] = sum;
      };
      (one(std::integral_constant<std::size_t, K>{}), ...);
    }(std::make_index_sequence<joints>{});
    return x;
  }

  /// `MassFactors(mass).solve(tau)` for one torque, without keeping the factors for the case of a bad pivot.
  [[nodiscard]] static SKINCTL_INLINE ForwardDynamics<joints, T> solved(
      const MassMatrix<joints, T>& mass, const JointTorque<joints, T>& tau) noexcept {
    const MassFactors factors(mass, WithoutCare{});
    ForwardDynamics<joints, T> out{factors.solve(tau), factors.positive_definite_};
    if (!out.positive_definite) [[unlikely]]
      out.acceleration = solved_with_care(mass, tau);
    return out;
  }

  /// Whether the mass matrix was positive definite: false if a joint was removed, in any lane.
  [[nodiscard]] SKINCTL_INLINE bool positive_definite() const noexcept { return positive_definite_; }

 private:
  static constexpr LinkMask carriers_of(std::size_t k) noexcept {
    return ancestors<M>(k) & ~(LinkMask(1) << k);
  }

  /// Calls `f(i)` for each set bit of `Mask`, highest first.
  template <LinkMask Mask, class F>
  static SKINCTL_INLINE void for_each_bit(F&& f) noexcept {
    if constexpr (Mask != 0) {
      constexpr auto top = static_cast<std::size_t>(std::bit_width(Mask)) - 1;
      f(std::integral_constant<std::size_t, top>{});
      for_each_bit<Mask & ~link_bit<top>>(f);
    }
  }
  template <class F>
  static SKINCTL_INLINE void for_each_pair_from_the_tips(F&& f) noexcept {
    for_each_bit<all_links(joints)>([&](auto k) SKINCTL_INLINE_LAMBDA {
      f(k, std::integral_constant<LinkMask, carriers_of(k.value)>{});
    });
  }
  /// Calls `f(i, j)` for the entries on and below the diagonal that are not zero by topology.
  template <class F>
  static SKINCTL_INLINE void for_each_entry(F&& f) noexcept {
    for_each_pair_from_the_tips([&](auto k, auto carriers) SKINCTL_INLINE_LAMBDA {
      f(k, k);
      for_each_bit<carriers.value>([&](auto i) SKINCTL_INLINE_LAMBDA { f(k, i); });
    });
  }

  /// Pivots are checked during the divisions, and only a matrix with a bad pivot is factorised again with
  /// care: a check before each division would lengthen the critical path, which is the chain of divisions.
  template <bool Careful>
  SKINCTL_INLINE void factorise(const MassMatrix<joints, T>& mass) noexcept {
    for_each_entry([&](auto i, auto j) SKINCTL_INLINE_LAMBDA { l_(i, j) = mass(i, j); });
    auto good = T(1) > T(0);
    for_each_pair_from_the_tips([&](auto k, auto carriers) SKINCTL_INLINE_LAMBDA {
      const T pivot = l_(k, k);
      const auto positive = pivot > T(0);
      good = good & positive;
      if constexpr (Careful) {
        inverse_[k] = select(positive, T(1) / select(positive, pivot, T(1)), T(0));
      } else {
        inverse_[k] = T(1) / pivot;
      }
      for_each_bit<carriers.value>([&](auto i) SKINCTL_INLINE_LAMBDA {
        const T a = l_(k, i) * inverse_[k];
        for_each_bit<carriers.value & all_links(i.value + 1)>(
            [&](auto j) SKINCTL_INLINE_LAMBDA { l_(i, j) = l_(i, j) - a * l_(k, j); });
      });
      for_each_bit<carriers.value>([&](auto i) SKINCTL_INLINE_LAMBDA { l_(k, i) = l_(k, i) * inverse_[k]; });
    });
    if constexpr (is_lane<T>) {
      positive_definite_ = all(good);
    } else {
      positive_definite_ = good;
    }
  }
  struct WithoutCare {};
  SKINCTL_INLINE MassFactors(const MassMatrix<joints, T>& mass, WithoutCare) noexcept {
    factorise<false>(mass);
  }
  struct WithCare {};
  explicit MassFactors(const MassMatrix<joints, T>& mass, WithCare) noexcept { factorise<true>(mass); }
  /// The factors without bad pivots; `mass` by value, so that in the usual case it may stay in registers.
  [[gnu::cold, gnu::noinline]] static MassFactors without_bad_pivots(MassMatrix<joints, T> mass) noexcept {
    return MassFactors(mass, WithCare{});
  }
  [[gnu::cold, gnu::noinline]] static JointAcceleration<joints, T> solved_with_care(
      MassMatrix<joints, T> mass, JointTorque<joints, T> tau) noexcept {
    return MassFactors(mass, WithCare{}).solve(tau);
  }

  MassMatrix<joints, T> l_;
  T inverse_[joints];
  bool positive_definite_ = true;
};

/// `M^-1 (tau - C dq - G)`: the acceleration of the robot under joint torques, by mass matrix and
/// factorisation, which is faster than the articulated-body recursion for the 3 to 16 joints of arms and
/// hands.
///
/// The result is the exact acceleration under a torque that differs from `tau` by some 20 units in the last
/// place of the links' torques. The error of the acceleration is that times the condition number of M: some
/// 500 units for a UR5, 1200 for two arms with hands; where light links carry masses 1e12 times their own the
/// accelerations keep 8 digits in double and none in float. For a UR5 with rates within 3 rad/s and 3 rad/s^2
/// that torque is within 6.6e-13 N m (float: 3.6e-4) of `tau` (proven, `bench/studies/bounds`; found:
/// 9.7e-14, 4.9e-5).
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE ForwardDynamics<M::joints, T> forward_dynamics(
    const M& model, const JointPosition<M::joints, T>& q, const JointVelocity<M::joints, T>& dq,
    const JointTorque<M::joints, T>& tau) noexcept {
  const JointAngles<M, T> angles(model, q);
  const JointTorque<M::joints, T> free = tau - bias_torque(model, angles, dq);
  return MassFactors<M, T>::solved(mass_matrix(model, angles), free);
}
// clang-format off
template <RobotModel M, Scalar T> requires(is_fixed_point<T>)
void forward_dynamics(const M&, const JointPosition<M::joints, T>&, const JointVelocity<M::joints, T>&, const JointTorque<M::joints, T>&) = delete;  // its pivots lose their digits in fixed point: forward dynamics need float
template <RobotModel M, Scalar T> requires(!computes_in<M, T>)
void forward_dynamics(const M&, const JointPosition<M::joints, T>&, const JointVelocity<M::joints, T>&, const JointTorque<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
template <RobotModel M, class... Q, std::enable_if_t<any_eigen<Q...>, int> = 0>  // shorter errors than of `requires`
void forward_dynamics(const M&, const Q&...) = delete;  // an Eigen vector has no kind: name it, JointPosition<N>(v)
// clang-format on

SKINCTL_END_NAMESPACE
