// SPDX-License-Identifier: BSD-3-Clause
// Joint and Operational Control with a target from a sensor, which may jump.
#pragma once

#include "skinctl/tracking/operational_space.hpp"
#include "skinctl/tracking/reactive_plan.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Joint Control, eqs. (8)-(14) of the paper that README.md names, for a `JointReference` from a sensor: see
/// `ReactivePlan`.
template <std::size_t N, Real T = double, class Damping = InertialDamping<T>>
class ReactiveJoint : public Tracking<JointSpace<N, T>, ReactivePlan<JointSpace<N, T>>, Damping> {
 public:
  using Tracking<JointSpace<N, T>, ReactivePlan<JointSpace<N, T>>, Damping>::Tracking;
};
template <DescribedRobot R>
ReactiveJoint(const R&) -> ReactiveJoint<R::joints, typename R::scalar>;

/// Operational Control, eqs. (15)-(21) of that paper, for a `PoseReference` of the tool `P` on link `Ix` from
/// a sensor.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double, TaskSpace What = TaskSpace::pose,
          class Orientation = RotationVectorError, class Null = DampedNullSpace,
          class Damping = InertialDamping<T>>
class ReactiveOperational
    : public Tracking<OperationalSpace<N, Ix, P, T, What, Orientation, Null>,
                      ReactivePlan<OperationalSpace<N, Ix, P, T, What, Orientation, Null>>, Damping> {
 public:
  using Tracking<OperationalSpace<N, Ix, P, T, What, Orientation, Null>,
                 ReactivePlan<OperationalSpace<N, Ix, P, T, What, Orientation, Null>>, Damping>::Tracking;
};
template <DescribedRobot R, std::size_t Ix, Frame P>
ReactiveOperational(const R&, const Transform<Link<Ix>, P, typename R::scalar>&)
    -> ReactiveOperational<R::joints, Ix, P, typename R::scalar>;

SKINCTL_END_NAMESPACE
