// SPDX-License-Identifier: BSD-3-Clause
// Spline Joint Control: goes to a static goal along a spline, section 4.2.4.
#pragma once

#include "skinctl/tracking/spline_plan.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Law whose joint torques track the spline of eq. (22) to a static goal, eqs. (8)-(14). A goal is a
/// `JointGoal`: a position, with or without a duration. `SplineJoint(arm)` for a described robot.
template <std::size_t N, Real T = double, class Damping = InertialDamping<T>>
class SplineJoint : public Tracking<JointSpace<N, T>, SplinePlan<JointSpace<N, T>>, Damping> {
 public:
  using Tracking<JointSpace<N, T>, SplinePlan<JointSpace<N, T>>, Damping>::Tracking;
};
template <DescribedRobot R>
SplineJoint(const R&) -> SplineJoint<R::joints, typename R::scalar>;

SKINCTL_END_NAMESPACE
