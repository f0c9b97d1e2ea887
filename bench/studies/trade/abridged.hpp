// Parts of the model that are computed less often, or not at all: what that costs in accuracy. For the study
// alone.
#pragma once

#include <array>
#include <bit>

#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/robots/ur5.hpp"

namespace trade {

enum class Abridgement {
  mass_once,    ///< M every so many sub-steps
  no_coriolis,  ///< C dq = 0
  diagonal      ///< M without what is off its diagonal
};
/// `Base` with one abridgement. Integrators find the functions below by their argument; they are more
/// constrained than the library's.
template <class Base, Abridgement what, unsigned Every = 1>
struct Abridged : Base {
  using Unabridged = Base;
  static constexpr Abridgement abridgement = what;
  static constexpr unsigned every = Every;
};

template <skinctl::RobotModel M, skinctl::Scalar T, skinctl::LinkMask Mask>
  requires(M::abridgement == Abridgement::mass_once || M::abridgement == Abridgement::diagonal)
skinctl::MassMatrix<M::joints, T> mass_matrix(const M&,
                                              const skinctl::JointAngles<M, T, Mask>& angles) noexcept {
  using Base = typename M::Unabridged;
  const auto now = [&] {
    return skinctl::mass_matrix(Base{}, std::bit_cast<skinctl::JointAngles<Base, T, Mask>>(angles));
  };
  if constexpr (M::abridgement == Abridgement::mass_once) {
    static skinctl::MassMatrix<M::joints, T> last;
    static unsigned age = 0;
    if (age++ % M::every == 0) last = now();
    return last;
  } else {
    auto m = now();
    for (std::size_t i = 0; i < M::joints; ++i)
      for (std::size_t j = 0; j < M::joints; ++j)
        if (i != j) m(i, j) = T(0);
    return m;
  }
}
template <skinctl::RobotModel M, skinctl::Scalar T, skinctl::LinkMask Mask>
  requires(M::abridgement == Abridgement::no_coriolis)
skinctl::JointTorque<M::joints, T> coriolis_torque(const M&, const skinctl::JointAngles<M, T, Mask>&,
                                                   const skinctl::JointVelocity<M::joints, T>&) noexcept {
  return {};
}

template <skinctl::RobotModel M, skinctl::Scalar T, skinctl::LinkMask Mask>
  requires(M::abridgement == Abridgement::no_coriolis)
skinctl::JointTorque<M::joints, T> bias_torque(const M& model, const skinctl::JointAngles<M, T, Mask>& angles,
                                               const skinctl::JointVelocity<M::joints, T>&) noexcept {
  return skinctl::gravity_torque(model, angles);
}

/// `SkinJointControl` by the angles of a cycle's first sub-step of four.
struct SkinOnceACycle : skinctl::Composable {
  static constexpr skinctl::Needs needs = {.angles = true, .touch = true};
  static constexpr skinctl::LawRole role = skinctl::LawRole::reactive;
  static constexpr const char* name = "skin_once_a_cycle";
  using Angles = skinctl::JointAngles<skinctl::ur5::Model, double>;
  struct Memory {
    unsigned substep = 0;
    std::array<std::byte, sizeof(Angles)> first{};  ///< a cycle's first angles
  };
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  SKINCTL_INLINE skinctl::JointTorque<6> torque(const Memory& m, const K& known) const noexcept {
    return skinctl::skin_torque(
        known.model(), m.substep % 4 == 0 ? known.angles() : std::bit_cast<Angles>(m.first), known.touch());
  }
  template <class K>
  SKINCTL_INLINE Memory advance(const Memory& m, const K& known, const double&,
                                skinctl::Opposition) const noexcept {
    return {m.substep + 1, m.substep % 4 == 0
                               ? std::bit_cast<std::array<std::byte, sizeof(Angles)>>(known.angles())
                               : m.first};
  }
};

}  // namespace trade
