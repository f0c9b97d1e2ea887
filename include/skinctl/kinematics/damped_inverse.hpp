// SPDX-License-Identifier: BSD-3-Clause
// The damped inverse of a Jacobian, bounded at singularities.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "skinctl/kinematics/detail/block_inverse.hpp"
#include "skinctl/kinematics/detail/determinant_rate.hpp"
#include "skinctl/kinematics/jacobian_rate.hpp"
#include "skinctl/kinematics/singularity_damping.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The components of a frame's motion that a task controls.
enum class TaskSpace : unsigned char {
  pose,     ///< position and orientation: six numbers
  position  ///< position of the origin: three numbers; angular parts of arguments are ignored
};

/// The damped inverse `J^+ = (J'J + l^2)^-1 J' = J' (J J' + l^2)^-1` of eq. (19), l from
/// `SingularityDamping`. Away from singularities it is the inverse (for more than six joints the
/// pseudo-inverse of minimal joint speed; for fewer, of minimal error), near them it is bounded and smooth.
///
/// `J` is a geometric `Jacobian` along the axes of the base, metres and radians weighted alike; it must
/// outlive this object. With `TaskSpace::position` only its linear rows are inverted. Never divides by zero;
/// NaN gives NaNs or zeros. Six joints and a pose, outside of the zone: J itself is inverted, in blocks, to a
/// few units in the last place times the condition number of J. In the zone, for other numbers of joints, and
/// where the last three axes are nearly in a plane, the smaller of the two products is factorised: a few
/// units times the square of that number.
template <class J, TaskSpace What = TaskSpace::pose>
class DampedInverse;
template <Topology M, LinkMask Columns, Frame Body, Real T, TaskSpace What>
class DampedInverse<Jacobian<M, Columns, Body, Body, Base, T>, What> {
 public:
  using Of = Jacobian<M, Columns, Body, Body, Base, T>;
  using Velocity = Twist<Body, Base, Body, Base, T>;
  using BodyAcceleration = Acceleration<Body, Base, Body, Base, T>;
  static constexpr std::size_t joints = M::joints;

  SKINCTL_INLINE DampedInverse(const Of& J, const SingularityDamping<T>& damping) noexcept
      : DampedInverse(J, damping, [&]() SKINCTL_INLINE_LAMBDA { return damping; }) {}
  /// @param damping  says where damping begins.
  /// @param within   gives the damping that is used there; called only there.
  template <class F>
  SKINCTL_INLINE DampedInverse(const Of& J, const SingularityDamping<T>& damping, const F& within) noexcept
      : J_(J), damping_(damping), blocks_(J) {
    if constexpr (in_blocks) {
      w_squared_ = blocks_.determinant() * blocks_.determinant();
      damped_ = nearness() > T(0);
      if (blocks_.usable() && !damped_) [[likely]]
        return;
    }
    damping_ = within();
    factorise();
  }

  /// Yoshikawa's manipulability, `sqrt(det(J J'))` (of `J'J` for fewer than six joints): 0 at a singularity.
  [[nodiscard]] T manipulability() const noexcept {
    using std::sqrt;
    return sqrt(w_squared_);
  }
  /// Nearness of a singularity, from 0 (outside the zone: no damping) to 1 (at it).
  [[nodiscard]] T nearness() const noexcept { return damping_.nearness(w_squared_); }
  /// The damping l at this pose, in units of the singular values of J.
  [[nodiscard]] T damping() const noexcept {
    using std::sqrt;
    return sqrt(damping_.squared(w_squared_));
  }

  /// Joint velocities `dq_r = J^+ dx_r`. Joints that do not move the body stay at 0.
  [[nodiscard]] JointVelocity<joints, T> solve(const Velocity& dx_r) const noexcept {
    JointVelocity<joints, T> dq;
    apply(dx_r, dq.data);
    return dq;
  }

  /// `J^+ a`: the joint accelerations of the frame's acceleration `a`, without the term `dJ dq`.
  [[nodiscard]] JointAcceleration<joints, T> solve(const BodyAcceleration& a) const noexcept {
    JointAcceleration<joints, T> ddq;
    apply(Velocity{a.linear, a.angular}, ddq.data);
    return ddq;
  }

  /// `J^+' tau`: the load on the frame that is equivalent to these joint torques; exact for
  /// `tau = transpose(J) F` without damping.
  [[nodiscard]] typename Of::Load solve_transposed(const JointTorque<joints, T>& tau) const noexcept {
    if constexpr (by_joints) {
      T b[order], x[order];
      std::size_t k = 0;
      J_.for_each([&](auto i, const auto&) { b[k++] = tau[i.value]; });
      if constexpr (in_blocks) {
        if (!factors_) [[likely]] {
          typename Of::Load F;
          blocks_.solve_transposed(b, F.force, F.moment);
          return F;
        }
      }
      factors_->solve(b, x);
      JointVelocity<joints, T> y;
      k = 0;
      J_.for_each([&](auto i, const auto&) { y[i.value] = x[k++]; });
      const Velocity F = seen(J_ * y);
      return {F.linear, F.angular};
    } else {
      Velocity v;
      J_.for_each([&](auto i, const auto& c) {
        v.linear = v.linear + tau[i.value] * c.linear;
        v.angular = v.angular + tau[i.value] * c.angular;
      });
      const Velocity F = solve_outer(v);
      return {F.linear, F.angular};
    }
  }

  /// The time derivative of `solve(dx_r)` while the joints move at the dq of `dJ`, including that of the
  /// damping:
  ///
  ///     ddq_r = J^+ (ddx_r - dJ dq_r) + (J'J + l^2)^-1 (dJ' (dx_r - J dq_r) - 2 l dl dq_r)
  [[nodiscard]] JointAcceleration<joints, T> solve_rate(const JacobianRate<Of>& dJ, const Velocity& dx_r,
                                                        const BodyAcceleration& ddx_r) const noexcept {
    return solve_rate(dJ, dx_r, ddx_r, solve(dx_r));
  }
  /// As `solve_rate(dJ, dx_r, ddx_r)`, where `dq_r = solve(dx_r)` is known already.
  [[nodiscard]] JointAcceleration<joints, T> solve_rate(const JacobianRate<Of>& dJ, const Velocity& dx_r,
                                                        const BodyAcceleration& ddx_r,
                                                        const JointVelocity<joints, T>& dq_r) const noexcept {
    const BodyAcceleration missing = ddx_r - dJ * dq_r;
    if constexpr (square) {
      if (!damped_) [[likely]]
        return solve(missing);  // dx_r - J dq_r is zero
    }
    return solve_rate_damped(dJ, dx_r, missing, dq_r);
  }
  /// As `solve_rate(dJ, dx_r, ddx_r, dq_r)` for joints that move at `dq` and a frame that moves at
  /// `V = J dq`. Cheaper where nothing is damped: `dJ dq_r` is computed without dJ.
  [[nodiscard]] SKINCTL_INLINE JointAcceleration<joints, T> solve_rate(
      const JointVelocity<joints, T>& dq, const Velocity& V, const Velocity& dx_r,
      const BodyAcceleration& ddx_r, const JointVelocity<joints, T>& dq_r) const noexcept {
    if constexpr (square) {
      if (!damped_) [[likely]]
        return solve(ddx_r - jacobian_rate_times(J_, dq, dq_r, V));
    }
    return solve_rate_at(dq, dx_r, ddx_r, dq_r);
  }

 private:
  [[nodiscard]] SKINCTL_NOINLINE auto solve_rate_at(const JointVelocity<joints, T>& dq, const Velocity& dx_r,
                                                    const BodyAcceleration& ddx_r,
                                                    const JointVelocity<joints, T>& dq_r) const noexcept {
    return solve_rate(jacobian_rate(J_, dq), dx_r, ddx_r, dq_r);
  }
  [[nodiscard]] JointAcceleration<joints, T> solve_rate_damped(
      const JacobianRate<Of>& dJ, const Velocity& dx_r, const BodyAcceleration& missing,
      const JointVelocity<joints, T>& dq_r) const noexcept {
    JointAcceleration<joints, T> ddq;
    const T dl2 = damping_rate(dJ);
    if constexpr (by_joints) {
      const Velocity left = dx_r - J_ * dq_r;
      T b[order], x[order];
      std::size_t k = 0;
      J_.for_each([&](auto i, const auto& c) {
        const auto& d = dJ.template column<i.value>();
        b[k++] = along(c, missing) + along(d, left) - dl2 * dq_r[i.value];
      });
      factors_->solve(b, x);
      k = 0;
      J_.for_each([&](auto i, const auto&) { ddq[i.value] = x[k++]; });
    } else {
      // The same with `(J'J + l^2)^-1 = (1 - J^+ J) / l^2` inserted, which avoids the division by l^2.
      const Velocity y = solve_outer(dx_r);
      JointVelocity<joints, T> turned;
      J_.for_each([&](auto i, const auto&) {
        const auto& d = dJ.template column<i.value>();
        turned[i.value] = along(d, y);
      });
      const Velocity back = J_ * turned + dl2 * y;
      apply(Velocity{missing.linear - back.linear, missing.angular - back.angular}, ddq.data);
      for (std::size_t i = 0; i < joints; ++i) ddq[i] = ddq[i] + turned[i];
    }
    return ddq;
  }

  static constexpr auto moving = static_cast<std::size_t>(std::popcount(Columns));
  static constexpr std::size_t rows_count = What == TaskSpace::pose ? 6 : 3;
  static constexpr bool by_joints = moving <= rows_count, square = moving == rows_count;
  static constexpr std::size_t order = by_joints ? moving : rows_count;
  static constexpr bool in_blocks = square && order == 6;
  using Matrix = std::array<T, order * order>;
  using Blocks = std::conditional_t<in_blocks, detail::BlockInverse<T>, detail::NoBlockInverse>;

  static void store(const Velocity& v, T* x) noexcept {
    x[0] = v.linear.x, x[1] = v.linear.y, x[2] = v.linear.z;
    if constexpr (What == TaskSpace::pose) x[3] = v.angular.x, x[4] = v.angular.y, x[5] = v.angular.z;
  }
  /// The controlled components of a velocity.
  static Velocity seen(const Velocity& v) noexcept {
    if constexpr (What == TaskSpace::pose) return v;
    return {v.linear, {T(0), T(0), T(0)}};
  }
  template <class V>
  static T along(const typename Of::Column& c, const V& v) noexcept {
    if constexpr (What == TaskSpace::pose) return dot(c.linear, v.linear) + dot(c.angular, v.angular);
    return dot(c.linear, v.linear);
  }
  template <class Columns6>
  static void rows(const Columns6& J, T (&r)[moving][rows_count]) noexcept {
    std::size_t k = 0;
    J.for_each([&](auto, const auto& c) { store({c.linear, c.angular}, r[k++]); });
  }
  Matrix normal() const noexcept {
    T r[moving][rows_count];
    rows(J_, r);
    Matrix m;
    for (std::size_t i = 0; i < order; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        m[i * order + j] = m[j * order + i] = detail::row_product<by_joints>(r, r, i, j);
    return m;
  }
  /// Factors of the smaller product, damped next to a singularity.
  SKINCTL_NOINLINE void factorise() noexcept {
    factors_.emplace(normal().data());
    w_squared_ = factors_->determinant();
    damped_ = !factors_->positive_definite() || nearness() > T(0);
    if (damped_) [[unlikely]]
      damp();
  }
  /// Next to a singularity: finds the determinant with pivots, and factors the damped matrix.
  SKINCTL_COLD void damp() noexcept {
    Matrix m = normal();
    T a[order][order], still[order][order] = {};
    for (std::size_t i = 0; i < order; ++i)
      for (std::size_t j = 0; j < order; ++j) a[i][j] = m[i * order + j];
    w_squared_ = detail::determinant(a, still).value;
    const T l2 = damping_.squared(w_squared_);
    for (std::size_t i = 0; i < order; ++i) m[i * order + i] = m[i * order + i] + l2;
    factors_.emplace(m.data());
  }
  T damping_rate(const JacobianRate<Of>& dJ) const noexcept {
    if (nearness() == T(0)) return T(0);
    T r[moving][rows_count], d[moving][rows_count], a[order][order], da[order][order];
    rows(J_, r);
    rows(dJ, d);
    for (std::size_t i = 0; i < order; ++i)
      for (std::size_t j = 0; j < order; ++j) {
        a[i][j] = detail::row_product<by_joints>(r, r, i, j);
        da[i][j] = detail::row_product<by_joints>(d, r, i, j) + detail::row_product<by_joints>(d, r, j, i);
      }
    return damping_.squared_rate(w_squared_, detail::determinant(a, da).rate);
  }
  /// The product `(J J' + l^2)^-1 v`.
  Velocity solve_outer(const Velocity& v) const noexcept {
    T x[6] = {};
    store(v, x);
    factors_->solve(x, x);
    return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
  }
  SKINCTL_INLINE void apply(const Velocity& v, T* out) const noexcept {
    if constexpr (in_blocks) {
      if (!factors_) [[likely]] {
        T x[6];
        blocks_.solve(v.linear, v.angular, x);
        std::size_t k = 0;
        J_.for_each([&](auto i, const auto&) SKINCTL_INLINE_LAMBDA { out[i.value] = x[k++]; });
        return;
      }
    }
    apply_factors(v, out);
  }
  SKINCTL_NOINLINE void apply_factors(const Velocity& v, T* out) const noexcept {
    if constexpr (by_joints) {
      T b[order], x[order];
      std::size_t row = 0, k = 0;
      J_.for_each([&](auto, const auto& c) { b[row++] = along(c, v); });
      factors_->solve(b, x);
      J_.for_each([&](auto i, const auto&) { out[i.value] = x[k++]; });
    } else {
      const Velocity y = solve_outer(v);
      J_.for_each([&](auto i, const auto& c) { out[i.value] = along(c, y); });
    }
  }

  const Of& J_;
  SingularityDamping<T> damping_;
  T w_squared_;
  bool damped_;
  [[no_unique_address]] Blocks blocks_;
  std::optional<math::Ldlt<order, T>> factors_;  ///< factors of the smaller product, unless the blocks serve
};

/// The damped inverse of a Jacobian.
template <TaskSpace What = TaskSpace::pose, Topology M, LinkMask C, Frame Body, Real T>
[[nodiscard]] auto damped_inverse(const Jacobian<M, C, Body, Body, Base, T>& J,
                                  const SingularityDamping<T>& damping) noexcept {
  return DampedInverse<Jacobian<M, C, Body, Body, Base, T>, What>(J, damping);
}
SKINCTL_END_NAMESPACE
