// The joints under torques: rigid links, turning motors, viscous and dry friction.
#pragma once

#include "examples/simulated_ur5/geometry.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/model/topology.hpp"

namespace simulated_ur5 {

/// The links as they are. The maker's numbers, by which the controller holds the arm's weight, may be others.
using Bodies = skinctl::CalibratedModel<skinctl::Chain<joint_count>>;
/// A UR5 that weighs what its maker says.
Bodies makers_bodies();

/// Of every joint; what an arm has is a parameter of the simulation, not a measurement of a UR5.
struct JointDrives {
  Joints rotor_inertia = {0.5, 0.5, 0.5, 0.1, 0.1, 0.1};  ///< of motor and gear, seen at the joint [kg m^2]
  Joints viscous = {7, 7, 5, 1.5, 1.5, 1.5};              ///< [N m s/rad]
  Joints coulomb = {6, 6, 4, 1.5, 1.5, 1.5};  ///< [N m]: holds a joint at rest against up to as much
  double presliding = 1.4e-3;                 ///< way in which dry friction turns round [rad]
};

/// Joint speeds a time `h` [s] later under `torque` [N m] of motors and world, gravity not included:
///
///     M dq' + h (viscous dq' + f) = M dq + h (torque - C dq - G),  |f| <= coulomb
///
/// with f such that a joint that f can hold stands still and one that moves is slowed by all of it. Friction
/// is implicit: it takes energy at any step.
/// @param held  f of the step before, replaced by that of this one: where the search for it begins.
Joints speeds_after(const Joints& q, const Joints& dq, const Joints& torque, const Bodies& bodies,
                    const JointDrives& drives, double h, Joints& held);

/// What motors give that move the joints so, gravity included, friction and what the world does not [N m].
Joints torque_of_motion(const Joints& q, const Joints& dq, const Joints& ddq, const Bodies& bodies,
                        const JointDrives& drives);

/// Kinetic energy [J].
double kinetic_energy(const Joints& q, const Joints& dq, const Bodies& bodies, const JointDrives& drives);

}  // namespace simulated_ur5
