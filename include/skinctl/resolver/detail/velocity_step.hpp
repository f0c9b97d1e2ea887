// SPDX-License-Identifier: BSD-3-Clause
// The virtual robot's velocity after a sub-step, by any of the integrators.
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/math/detail/block_ldlt.hpp"
#include "skinctl/resolver/detail/stick_or_slip.hpp"
#include "skinctl/resolver/integrator.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/robot/virtual_dynamics.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Velocity after a sub-step, and whether a matrix could not be factorised.
template <std::size_t N, Real T>
struct VelocityStep {
  JointVelocity<N, T> velocity;
  bool singular = false;
};

template <Real T, class K, class A>
SKINCTL_INLINE JointTorque<K::joints, T> bias_at_start(const K& known, const A& angles) noexcept {
  if constexpr (K::needs.gravity && K::needs.coriolis) {
    return known.coriolis() + known.gravity();
  } else {
    return bias_torque(known.model(), angles, known.dq());
  }
}

/// Whether a law's mass matrix is that of the integrator's pose, without the shape of a tool.
template <class Policy, class K, bool Shaped = false>
inline constexpr bool shares_mass = !Policy::midpoint && K::needs.mass && !(Shaped && K::is_virtual);
/// Whether a law's mass matrix is that of the integrator and includes the joints' virtual inertia.
template <class Policy, class K, bool Shaped = false>
inline constexpr bool shares_inertia = shares_mass<Policy, K, Shaped> && K::is_virtual;

/// The velocity of all joints half a sub-step ahead, by the accelerations `last` of the joints of `S`.
template <class S, class K, Real T>
[[nodiscard]] SKINCTL_INLINE JointVelocity<K::joints, T> middle_velocity(
    const K& known, const JointAcceleration<S::count, T>& last) noexcept {
  const T half = T(0.5) * known.dt();
  if constexpr (S::is_all) {
    return integrate(known.dq(), last, half);
  } else {
    JointVelocity<K::joints, T> v = known.dq();
    S::put(integrate(S::of(v), last, half), v);
    return v;
  }
}
/// `(M ddq)_S` of the accelerations `driven` of the joints that are not in `S`, as if those of `S` had none.
template <class S, std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE JointTorque<S::count, T> reaction_of(
    const MassMatrix<N, T>& m, const JointAcceleration<N, T>& driven) noexcept {
  JointTorque<S::count, T> tau;
  for (std::size_t i = 0; i < S::count; ++i)
    for (const std::size_t j : S::Others::index) tau[i] = tau[i] + m(S::index[i], j) * driven[j];
  return tau;
}

/// The mass matrix where the policy takes it; with the virtual inertia if `shares_inertia`.
template <class Policy, bool Shaped = false, class K>
[[nodiscard]] SKINCTL_INLINE MassMatrix<K::joints, typename K::scalar> mass_where(const K& known) noexcept {
  if constexpr (Policy::midpoint) {
    return mass_matrix(known.model(), known.middle());
  } else if constexpr (shares_mass<Policy, K, Shaped>) {
    return MassMatrix<K::joints, typename K::scalar>(known.mass());
  } else {
    return mass_matrix(known.model(), known.angles());
  }
}
/// `C v + G` where the policy takes it.
/// @param last  acceleration of the last sub-step, for the velocity at the midpoint.
template <class Policy, class S, class K, Real T>
[[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, T> bias_where(
    const K& known, const JointAcceleration<S::count, T>& last) noexcept {
  if constexpr (Policy::midpoint) {
    const JointVelocity<K::joints, T> v_mid = middle_velocity<S>(known, last);
    // Where laws of the half step evaluate the model too, so that compensated gravity cancels.
    if constexpr (K::needs.gravity) {
      return coriolis_torque(known.model(), known.middle(), v_mid) + known.gravity();
    } else {
      return bias_torque(known.model(), known.middle(), v_mid);
    }
  } else {
    return bias_at_start<T>(known, known.angles());
  }
}

/// The velocity after `h` seconds of `m dv = tau - bias - B v - tau_c(v)`; see `step_velocity`.
///
/// The damping in proportion to `m` moves all joints from v to `v + free`, whatever `m` is; forces and
/// friction act from there, so that no product with `m` is needed. `more(m, impulse, free)` adds further
/// friction.
template <class Policy, std::size_t n, Real T, class More>
[[nodiscard]] SKINCTL_INLINE VelocityStep<n, T> solve_step(MassMatrix<n, T>& m, const JointTorque<n, T>& bias,
                                                           const JointVelocity<n, T>& v,
                                                           const VirtualDynamics<n, T>& shape,
                                                           bool has_coulomb, const JointTorque<n, T>& tau,
                                                           const T& h, const More& more) noexcept {
  using R = Row<n, T>;
  const T decay = h * shape.damping, decayed = T(1) + Policy::weight(decay, T(1)) * decay;
  const R free = T(-h / decayed) * shape.damping * R(v), begin = R(v) + free;
  const R b = h * R(shape.viscous);
  T kept[n];  // joint by joint: the tip's inertia is known long before that of the base
  for_each_index<n>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    const T own = m(i, i) > T(0) ? m(i, i) : T(1);
    kept[i] = Policy::weight(b[i], own) * b[i];
  });
  const R driven = h * (R(tau) - R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return bias[i]; })) - b * R(v);
  JointTorque<n, T> impulse(driven - R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return kept[i]; }) * free);
  for_each_index<n>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    for_each_index<n>([&](std::size_t j) SKINCTL_INLINE_LAMBDA { m(i, j) = m(i, j) * decayed; });
    m(i, i) = m(i, i) + kept[i];
  });
  more(m, impulse, free);
  const math::detail::OneSystem<n, T> factors(m.data);
  if (!factors.positive_definite()) [[unlikely]]
    return {v, true};
  T dv[n];
  factors.solve(impulse.data, dv);
  const R moved = begin + R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return dv[i]; });
  if (!has_coulomb) return {JointVelocity<n, T>(moved), false};
  // On copies: what a call may read cannot stay in registers above.
  const MassMatrix<n, T> mass = m;
  const JointTorque<n, T> whole = impulse;
  VelocityStep<n, T> out{JointVelocity<n, T>(moved), false};
  stick_or_slip(mass, h * shape.coulomb, whole, JointVelocity<n, T>(begin), out.velocity);
  return out;
}

/// `m += diag(inertia)`.
template <std::size_t n, Real T>
SKINCTL_INLINE void add_inertia(const VirtualDynamics<n, T>& shape, MassMatrix<n, T>& m) noexcept {
  for_each_index<n>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { m(i, i) = m(i, i) + shape.inertia[i]; });
}

/// `step_velocity_of` for a virtual robot with the virtual dynamics of `tool` at its tool; `m` is the joints'
/// own inertia, `reaction` the torque by which the other joints' accelerations act.
template <class Policy, class S, class K, Real T, class Tool>
[[nodiscard]] SKINCTL_INLINE VelocityStep<S::count, T> step_shaped(
    const K& known, const VirtualDynamics<S::count, T>& shape, bool has_coulomb,
    const JointTorque<S::count, T>& tau, const JointAcceleration<S::count, T>& last, const Tool& tool,
    const MassMatrix<S::count, T>& m, [[maybe_unused]] const JointTorque<S::count, T>& reaction) noexcept {
  constexpr std::size_t n = S::count;
  const auto& v = S::of(known.dq());
  const T h = known.dt();
  const auto step = [&](const auto& angles, const JointVelocity<K::joints, T>& moving) SKINCTL_INLINE_LAMBDA {
    ToolTerms<n, Tool::rows, T> terms;
    const JointTorque<n, T> coriolis = S::of(coriolis_torque(known.model(), angles, moving));
    if (!tool.template terms<Policy, S>(known.model(), angles, moving, m, coriolis, h, terms))
      return VelocityStep<n, T>{v, true};
    if constexpr (K::needs.gravity) {
      terms.coriolis += S::of(known.gravity());
    } else {
      terms.coriolis += S::of(gravity_torque(known.model(), angles));
    }
    if constexpr (!S::is_all) terms.coriolis += reaction;
    const JointTorque<n, T> drag = terms.friction * JointAcceleration<n, T>(h * Row<n, T>(v));
    return solve_step<Policy>(terms.mass, terms.coriolis, v, shape, has_coulomb, tau, h,
                              [&](auto& mass, auto& impulse, const auto& free) SKINCTL_INLINE_LAMBDA {
                                impulse -= drag + terms.implicit * JointAcceleration<n, T>(free);
                                for (std::size_t i = 0; i < n * n; ++i)
                                  mass.data[i] = mass.data[i] + terms.implicit.data[i];
                              });
  };
  if constexpr (Policy::midpoint) {
    return step(known.middle(), middle_velocity<S>(known, last));
  } else {
    return step(known.angles(), known.dq());
  }
}

/// The velocity of the joints of `S` after `known.dt()` seconds of `M_v dv = tau - (C + B) v - G - tau_c(v)`.
/// The others move as `known` says, with the accelerations `driven`: they react by `-(M driven)_S`, and by
/// their part of `C v`.
///
/// @param last     acceleration of the last sub-step, for the velocity at the midpoint.
/// @param tool     virtual dynamics at the tool, or `NoToolShape`.
template <class Policy, class S, class K, Real T, class Tool = NoToolShape>
[[nodiscard]] SKINCTL_INLINE VelocityStep<S::count, T> step_velocity_of(
    const K& known, const VirtualDynamics<S::count, T>& shape, bool has_coulomb,
    const JointTorque<S::count, T>& tau, const JointAcceleration<S::count, T>& last, const Tool& tool = {},
    [[maybe_unused]] const JointAcceleration<K::joints, typename K::scalar>* driven = nullptr) noexcept {
  constexpr std::size_t n = S::count;
  constexpr bool shaped = !std::same_as<Tool, NoToolShape>;
  const auto& v = S::of(known.dq());
  const T h = known.dt();
  JointTorque<n, T> bias;
  if constexpr (!shaped) bias = S::of(bias_where<Policy, S, K, T>(known, last));
  MassMatrix<K::joints, T> whole = mass_where<Policy, shaped>(known);
  JointTorque<n, T> reaction;
  if constexpr (!S::is_all)
    if (driven != nullptr) reaction = reaction_of<S>(whole, *driven);
  const auto go_on = [&](MassMatrix<n, T>& m) SKINCTL_INLINE_LAMBDA {
    if constexpr (!shares_inertia<Policy, K, shaped>) add_inertia(shape, m);
    if constexpr (shaped) {
      return step_shaped<Policy, S>(known, shape, has_coulomb, tau, last, tool, m, reaction);
    } else {
      if constexpr (!S::is_all) bias += reaction;
      return solve_step<Policy>(m, bias, v, shape, has_coulomb, tau, h,
                                [](auto&, auto&, const auto&) SKINCTL_INLINE_LAMBDA {});
    }
  };
  if constexpr (S::is_all) {
    return go_on(whole);
  } else {
    MassMatrix<n, T> m = block_of<S>(whole);
    return go_on(m);
  }
}

/// `step_velocity_of` for all joints.
template <class Policy, class K, Real T, class Tool = NoToolShape>
[[nodiscard]] SKINCTL_INLINE VelocityStep<K::joints, T> step_velocity(
    const K& known, const VirtualDynamics<K::joints, T>& shape, bool has_coulomb,
    const JointTorque<K::joints, T>& tau, const JointAcceleration<K::joints, T>& last,
    const Tool& tool = {}) noexcept {
  return step_velocity_of<Policy, AllJoints<K::joints>>(known, shape, has_coulomb, tau, last, tool);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
