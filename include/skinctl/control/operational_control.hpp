// SPDX-License-Identifier: BSD-3-Clause
// Operational Control: tracks poses and velocities of a tool that come from outside, section 4.2.2.
#pragma once

#include "skinctl/tracking/operational_space.hpp"
#include "skinctl/tracking/target_plan.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Law whose joint torques make a tool `P` on link `Ix` of a robot with `N` joints track a target that the
/// application sends, eqs. (8), (15)-(21). A goal is a `PoseReference`: `receive` starts the time base for
/// it, `follow` takes the next sample of a moving target.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double, TaskSpace What = TaskSpace::pose,
          class Orientation = RotationVectorError, class Null = DampedNullSpace,
          class Damping = InertialDamping<T>>
class OperationalControl
    : public Tracking<OperationalSpace<N, Ix, P, T, What, Orientation, Null>,
                      TargetPlan<OperationalSpace<N, Ix, P, T, What, Orientation, Null>>, Damping> {
 public:
  using Tracking<OperationalSpace<N, Ix, P, T, What, Orientation, Null>,
                 TargetPlan<OperationalSpace<N, Ix, P, T, What, Orientation, Null>>, Damping>::Tracking;
};
/// An Operational Control of the tool at `X_LT` on its link, for a described robot:
/// `OperationalControl(arm, X_LT)`.
template <DescribedRobot R, std::size_t Ix, Frame P>
OperationalControl(const R&, const Transform<Link<Ix>, P, typename R::scalar>&)
    -> OperationalControl<R::joints, Ix, P, typename R::scalar>;
/// An Operational Control with settings of one's own: `auto s = operational_settings(arm)`, then the changes.
template <std::size_t Ix, Frame P, std::size_t N, Real T>
OperationalControl(const Transform<Link<Ix>, P, T>&, const OperationalSettings<N, T>&)
    -> OperationalControl<N, Ix, P, T>;

SKINCTL_END_NAMESPACE
