// SPDX-License-Identifier: BSD-3-Clause
// Joint Control: tracks positions and velocities that come from outside, section 4.2.1.
#pragma once

#include "skinctl/tracking/target_plan.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Law whose joint torques track a target that the application sends, eqs. (8)-(14). A goal is a
/// `JointReference`: `receive` starts the time base for it, `follow` takes the next sample of a moving
/// target. `JointControl(arm)` for a described robot.
template <std::size_t N, Real T = double, class Damping = InertialDamping<T>>
class JointControl : public Tracking<JointSpace<N, T>, TargetPlan<JointSpace<N, T>>, Damping> {
 public:
  using Tracking<JointSpace<N, T>, TargetPlan<JointSpace<N, T>>, Damping>::Tracking;
};
template <DescribedRobot R>
JointControl(const R&) -> JointControl<R::joints, typename R::scalar>;

SKINCTL_END_NAMESPACE
