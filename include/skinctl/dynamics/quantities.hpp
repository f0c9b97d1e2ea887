// SPDX-License-Identifier: BSD-3-Clause
// The known state of a cycle, as laws read it: the state and the quantities that follow from it, each
// computed once and only if needed.
#pragma once

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/law/law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The touch of a scene without skin.
struct NoTouch {};

/// `needs` with its dependencies: a Jacobian needs the poses of the links on the path, everything the angles.
template <Topology M>
constexpr Needs complete(Needs needs) noexcept {
  needs.poses |= closure<M>(needs.jacobians);
  needs.mass = needs.mass || needs.mass_factors;
  needs.angles = needs.angles || needs.poses != 0 || needs.any_mass() || needs.touch;
  return needs;
}

/// The links whose poses, masses or wrenches are in `needs`; joints behind the last of them are not read.
template <Topology M>
constexpr LinkMask links_for(const Needs& needs) noexcept {
  return needs.any_mass() || needs.angles ? all_links(M::joints) : closure<M>(needs.poses | needs.jacobians);
}

namespace detail {
/// A value that exists only if it is needed.
template <bool Wanted, class V>
struct Computed {
  V value;
  template <class F>
  SKINCTL_INLINE explicit Computed(F&& f) noexcept : value(f(0)) {}
};
template <class V>
struct Computed<false, V> {
  static const V value;  ///< never defined: it is named only after the error that says so
  template <class F>
  SKINCTL_INLINE explicit Computed(F&&) noexcept {}
};
/// Stand-in for additions to the model of a robot: there are none.
struct NothingAdded {
  using Limits = void;
  static constexpr bool is_virtual = false;
};
}  // namespace detail

/// The state of a robot and quantities at that state: angles, poses, G, M, C dq, as far as `Asked` includes
/// them. Quantities outside `Asked` are neither computed nor stored, and reading them does not compile.
///
/// `Touch` holds the skin's wrenches on the links over the interval (see tactile/), or is `NoTouch`. `Added`
/// is what a resolver adds to the model (see robot/virtual_mass.hpp): the limits of its joints, and the
/// inertia that a virtual robot has besides that of its model: `mass()` and what follows from it include it,
/// the other quantities are the model's.
template <RobotModel M, Needs Asked, Scalar T = double, class Touch = NoTouch,
          class Added = detail::NothingAdded>
class Quantities {
 public:
  using model_type = M;
  using scalar = T;
  using touch_type = Touch;
  /// Whether `mass()` includes the inertia of a virtual robot.
  static constexpr bool is_virtual = Added::is_virtual;
  static constexpr bool has_limits = !std::is_same_v<Added, detail::NothingAdded>;
  static constexpr std::size_t joints = M::joints;
  static constexpr Needs needs = complete<M>(Asked);
  static constexpr LinkMask links = links_for<M>(complete<M>(Asked));
  using Angles = JointAngles<M, T, links>;
  using Middle = JointAngles<M, T>;

  /// @param model, state  the model and its state; both must outlive this object.
  /// @param dt     interval [s] for which a torque computed from this will be held; >= 0.
  /// @param touch  mean wrenches of the skin on the links over that interval; must outlive this object.
  /// @param added  inertia of a virtual robot.
  SKINCTL_INLINE Quantities(const M& model, const State<joints, T>& state, const T& dt, const Touch& touch,
                            const Added& added = Added()) noexcept
      : model_(model),
        state_(state),
        touch_(touch),
        dt_(dt),
        limits_([&](auto) SKINCTL_INLINE_LAMBDA {
          if constexpr (has_limits) return &added.limits();
        }),
        angles_([&](auto) SKINCTL_INLINE_LAMBDA { return Angles(model_, state_.q); }),
        middle_([&](auto) SKINCTL_INLINE_LAMBDA {
          return Middle(model_, integrate(state_.q, state_.dq, T(T(0.5) * dt_)));
        }),
        poses_([&](auto) SKINCTL_INLINE_LAMBDA { return Poses<M, needs.poses, T>(model_, angles()); }),
        gravity_([&](auto) SKINCTL_INLINE_LAMBDA { return gravity_torque(model_, angles()); }),
        mass_([&](auto) SKINCTL_INLINE_LAMBDA {
          auto m = mass_matrix(model_, angles());
          if constexpr (has_limits) added.add_to(m, model_, angles());
          return m;
        }),
        factors_([&](auto) SKINCTL_INLINE_LAMBDA { return MassFactors<M, T>(mass()); }),
        coriolis_([&](auto) SKINCTL_INLINE_LAMBDA { return coriolis_torque(model_, angles(), state_.dq); }) {}

  [[nodiscard]] SKINCTL_INLINE const M& model() const noexcept { return model_; }
  [[nodiscard]] SKINCTL_INLINE const State<joints, T>& state() const noexcept { return state_; }
  [[nodiscard]] SKINCTL_INLINE const JointPosition<joints, T>& q() const noexcept { return state_.q; }
  [[nodiscard]] SKINCTL_INLINE const JointVelocity<joints, T>& dq() const noexcept { return state_.dq; }
  [[nodiscard]] SKINCTL_INLINE Nanoseconds time() const noexcept { return state_.time; }
  /// Interval [s] for which the torque will be held.
  [[nodiscard]] SKINCTL_INLINE const T& dt() const noexcept { return dt_; }
  /// Mean wrenches of the skin on the links over the interval.
  [[nodiscard]] SKINCTL_INLINE const Touch& touch() const noexcept { return touch_; }

  /// The limits of the robot's joints, where a resolver gives them.
  [[nodiscard]] SKINCTL_INLINE const auto& limits() const noexcept
    requires(has_limits)
  {
    return *limits_.value;
  }

  [[nodiscard]] SKINCTL_INLINE const Angles& angles() const noexcept {
    static_assert(needs.angles, "not asked for: set needs.angles");
    return angles_.value;
  }
  /// The angles half an interval ahead at constant velocity: `q + dq dt/2`.
  [[nodiscard]] SKINCTL_INLINE const Middle& middle() const noexcept {
    static_assert(needs.middle, "not asked for: set needs.middle");
    return middle_.value;
  }
  /// Poses `X_BaseLink` of the links in `needs.poses`.
  [[nodiscard]] SKINCTL_INLINE const Poses<M, needs.poses, T>& poses() const noexcept {
    static_assert(needs.poses != 0, "not asked for: set needs.poses");
    return poses_.value;
  }
  /// Pose `X_BaseLink` of link `Ix`.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE Transform<Base, Link<Ix>, T> pose() const noexcept {
    return poses().template get<Ix>();
  }
  /// Jacobian of the frame fixed to link `Ix` at `X_LP`, or of the link itself.
  template <std::size_t Ix, class... X>
  [[nodiscard]] SKINCTL_INLINE auto jacobian(const X&... X_LP) const noexcept {
    static_assert((needs.jacobians >> Ix) & 1u, "not asked for: set the link's bit in needs.jacobians");
    return skinctl::jacobian<Ix>(poses_.value, X_LP...);
  }
  /// Gravity torques G(q) [N m].
  [[nodiscard]] SKINCTL_INLINE const JointTorque<joints, T>& gravity() const noexcept {
    static_assert(needs.gravity, "not asked for: set needs.gravity");
    return gravity_.value;
  }
  /// Mass matrix M(q), or that of the virtual robot [kg m^2].
  [[nodiscard]] SKINCTL_INLINE const MassMatrix<joints, T>& mass() const noexcept {
    static_assert(needs.mass, "not asked for: set needs.mass");
    return mass_.value;
  }
  /// The mass matrix of `mass()`, factorised.
  [[nodiscard]] SKINCTL_INLINE const MassFactors<M, T>& mass_factors() const noexcept {
    static_assert(needs.mass_factors, "not asked for: set needs.mass_factors");
    return factors_.value;
  }
  /// Coriolis and centrifugal torques C(q, dq) dq [N m].
  [[nodiscard]] SKINCTL_INLINE const JointTorque<joints, T>& coriolis() const noexcept {
    static_assert(needs.coriolis, "not asked for: set needs.coriolis");
    return coriolis_.value;
  }

 private:
  const M& model_;
  const State<joints, T>& state_;
  const Touch& touch_;
  T dt_;
  [[no_unique_address]] detail::Computed<has_limits, const typename Added::Limits*> limits_;
  [[no_unique_address]] detail::Computed<needs.angles, Angles> angles_;
  [[no_unique_address]] detail::Computed<needs.middle, Middle> middle_;
  [[no_unique_address]] detail::Computed<needs.poses != 0, Poses<M, needs.poses, T>> poses_;
  [[no_unique_address]] detail::Computed<needs.gravity, JointTorque<joints, T>> gravity_;
  [[no_unique_address]] detail::Computed<needs.mass, MassMatrix<joints, T>> mass_;
  [[no_unique_address]] detail::Computed<needs.mass_factors, MassFactors<M, T>> factors_;
  [[no_unique_address]] detail::Computed<needs.coriolis, JointTorque<joints, T>> coriolis_;
};

SKINCTL_END_NAMESPACE
