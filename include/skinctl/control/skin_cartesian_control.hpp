// SPDX-License-Identifier: BSD-3-Clause
// Skin Cartesian Control: the tool gives way to touch in chosen directions, section 4.1.
#pragma once

#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/kinematics/damped_inverse.hpp"
#include "skinctl/tracking/redundancy.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The motions of a tool that the skin may cause.
enum class Yields : unsigned char { translation, rotation, both };

/// The part of a velocity or load that `What` keeps.
template <Yields What, class V>
[[nodiscard]] SKINCTL_INLINE constexpr V chosen(const V& v) noexcept {
  auto [linear, angular] = v;
  if constexpr (What == Yields::translation) angular = {};
  if constexpr (What == Yields::rotation) linear = {};
  return {linear, angular};
}

/// The load on the tool that is equivalent to all touches, `J^+' tau_skin`: exactly the load of the cells on
/// the tool's own link; touches elsewhere count as far as they move the tool. Bounded next to singularities.
template <class Inverse, class K>
[[nodiscard]] SKINCTL_INLINE auto touch_on_tool(const Inverse& inverse, const K& known) noexcept {
  return inverse.solve_transposed(SkinJointControl{}.torque(known));
}

/// `tau = J'S J^+' tau_skin - rate M (1 - J^+ S J) dq`: the skin's load on the frame `P` of link `Ix`, of
/// which S selects components, as joint torques. All other motion of the joints, that of the tool in other
/// directions included, is free, or with `DampedNullSpace` comes to rest at `rate`. Without skin only that
/// damping remains. On a robot of six joints with both translation and rotation it is `SkinJointControl`,
/// away from singularities; next to them motion that the tool cannot make is left out.
template <std::size_t Ix, Frame P = Tool, Real T = double, Yields What = Yields::both,
          class Null = FreeNullSpace>
class SkinCartesianControl : public StatelessLaw<SkinCartesianControl<Ix, P, T, What, Null>> {
  static constexpr bool damped = std::same_as<Null, DampedNullSpace>;
  static_assert(damped || std::same_as<Null, FreeNullSpace>, "the null space is free or damped");

 public:
  using scalar = T;
  static constexpr Needs needs = {.jacobians = link_bit<Ix>, .angles = true, .mass = damped, .touch = true};
  static constexpr const char* name = "skin_cartesian";

  /// @param X_LP  the tool's frame in its link.
  /// @param rate  decay of the motion in a damped null space [1/s], > 0; `rate dt <= 0.5`. Throws
  ///              `ConfigurationError` for a rate out of range.
  explicit SkinCartesianControl(const Transform<Link<Ix>, P, T>& X_LP, const T& rate = T(10),
                                const SingularityDamping<T>& singularities = SingularityDamping<T>())
      : X_LP_(X_LP), rate_(rate), singularities_(singularities) {
    require(rate > T(0) && rate <= T(1e4), "rate of the null space", static_cast<double>(rate), "> 0 1/s");
  }
  template <class K>
  [[nodiscard]] JointTorque<K::joints, T> torque(const K& known) const noexcept {
    const auto J = known.template jacobian<Ix>(X_LP_);
    const auto inverse = damped_inverse(J, singularities_);
    JointTorque<K::joints, T> tau = transpose(J) * chosen<What>(touch_on_tool(inverse, known));
    if constexpr (damped) {
      const auto moving = inverse.solve(chosen<What>(J * known.dq()));
      JointAcceleration<K::joints, T> braking;
      for (std::size_t i = 0; i < K::joints; ++i) braking[i] = rate_ * (known.dq()[i] - moving[i]);
      tau -= known.mass() * braking;
    }
    return tau;
  }

 private:
  Transform<Link<Ix>, P, T> X_LP_;
  T rate_;
  SingularityDamping<T> singularities_;
};

SKINCTL_END_NAMESPACE
