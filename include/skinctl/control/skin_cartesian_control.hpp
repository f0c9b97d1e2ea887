// Skin Cartesian Control: the tool gives way to touch, in the directions that are chosen, section 4.1.
#pragma once

#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/kinematics/damped_inverse.hpp"
#include "skinctl/tracking/redundancy.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Which motions of a tool the skin may cause.
enum class Yields : unsigned char { translation, rotation, both };

/// The part of a velocity or load that `What` lets through.
template <Yields What, class V>
[[nodiscard]] SKINCTL_INLINE constexpr V chosen(const V& v) noexcept {
  auto [linear, angular] = v;
  if constexpr (What == Yields::translation) angular = {};
  if constexpr (What == Yields::rotation) linear = {};
  return {linear, angular};
}

/// The load on a tool that stands for all that the skin does, `J^+' tau_skin`: exactly the load of the cells
/// that the tool's own link bears; what presses elsewhere as far as it moves the tool. Bounded next to
/// singularities.
template <class Inverse, class K>
[[nodiscard]] SKINCTL_INLINE auto touch_on_tool(const Inverse& inverse, const K& known) noexcept {
  return inverse.solve_transposed(SkinJointControl{}.torque(known));
}

/// `tau = J'S J^+' tau_skin - rate M (1 - J^+ S J) dq`: the skin's load on the frame `P` of link `I`, S of
/// its six components, as joint torques. What the joints do beside the chosen motion of the tool (its other
/// motion included) is free, or with `DampedNullSpace` comes to rest at `rate`. Zero, but for that, without
/// skin. On a robot of six joints and with everything chosen it is `SkinJointControl`, away from
/// singularities; next to them motion that the tool cannot make is left out.
template <std::size_t I, Frame P = Tool, Real T = double, Yields What = Yields::both,
          class Null = FreeNullSpace>
class SkinCartesianControl : public StatelessLaw<SkinCartesianControl<I, P, T, What, Null>> {
  static constexpr bool damped = std::same_as<Null, DampedNullSpace>;
  static_assert(damped || std::same_as<Null, FreeNullSpace>, "the null space is free or damped");

 public:
  using scalar = T;
  static constexpr Needs needs = {.jacobians = link_bit<I>, .angles = true, .mass = damped, .touch = true};
  static constexpr const char* name = "skin_cartesian";

  /// @param X_LP  the tool's frame in its link.
  /// @param rate  of a damped null space [1/s], > 0; `rate dt <= 0.5`. Throws `ConfigurationError`.
  explicit SkinCartesianControl(const Transform<Link<I>, P, T>& X_LP, const T& rate = T(10),
                                const SingularityDamping<T>& singularities = SingularityDamping<T>())
      : X_LP_(X_LP), rate_(rate), singularities_(singularities) {
    require(rate > T(0) && rate <= T(1e4), "rate of the null space", static_cast<double>(rate), "> 0 1/s");
  }
  template <class K>
  [[nodiscard]] JointTorque<K::joints, T> torque(const K& known) const noexcept {
    const auto J = known.template jacobian<I>(X_LP_);
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
  Transform<Link<I>, P, T> X_LP_;
  T rate_;
  SingularityDamping<T> singularities_;
};

SKINCTL_END_NAMESPACE
