// SPDX-License-Identifier: BSD-3-Clause
// Inertia, damping and friction of a virtual robot besides the links of its model.
#pragma once

#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Virtual inertia and friction: `M_v = M + diag(inertia)`, friction
/// `(diag(viscous) + damping M_v) v + coulomb sign(v)`. The virtual robot has them, and a tracking law
/// compensates them (`Y_r Theta` contains `B dq_r`), so both need the same values. Zero by default.
template <std::size_t N, Scalar T = double>
struct VirtualDynamics {
  JointTorque<N, T> viscous;  ///< viscous friction per joint [N m s/rad], >= 0
  JointTorque<N, T> coulomb;  ///< Coulomb friction per joint [N m], >= 0
  JointTorque<N, T> inertia;  ///< inertia per joint, like a rotor's [kg m^2], >= 0
  T damping = T(0);           ///< decay rate of free motion, exp(-damping t), in every direction [1/s], >= 0
};

SKINCTL_END_NAMESPACE
