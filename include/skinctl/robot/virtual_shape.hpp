// What joints have besides the links they carry: rotor inertia and friction.
#pragma once

#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What shapes a robot besides its links: `M_v = M + diag(inertia)`, friction
/// `(diag(viscous) + decay M_v) v + coulomb sign(v)`. A resolver gives it to its virtual robot, a tracking
/// law holds against it (`Y_r Theta` has `B dq_r`): both need the same. Zero by default.
template <std::size_t N, Scalar T = double>
struct VirtualShape {
  JointTorque<N, T> viscous;  ///< per joint [N m s/rad], >= 0
  JointTorque<N, T> coulomb;  ///< per joint [N m], >= 0
  JointTorque<N, T> inertia;  ///< per joint, as of a motor's rotor [kg m^2], >= 0
  T decay = T(0);             ///< [1/s], >= 0: free motion dies out as exp(-decay t) in every direction
};

SKINCTL_END_NAMESPACE
