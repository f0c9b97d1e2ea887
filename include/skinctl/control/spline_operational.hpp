// SPDX-License-Identifier: BSD-3-Clause
// Spline Operational Control: brings a tool to a static goal along a spline, section 4.2.5.
#pragma once

#include "skinctl/tracking/operational_space.hpp"
#include "skinctl/tracking/spline_plan.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Law whose joint torques move a tool along the spline of eq. (22) to a static goal, eqs. (8), (15)-(21), in
/// a straight line and by the shortest turn. A goal is a `PoseGoal`: a pose of the tool `P` on link `Ix`,
/// with or without a duration.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double, TaskSpace What = TaskSpace::pose,
          class Orientation = RotationVectorError, class Null = DampedNullSpace,
          class Damping = InertialDamping<T>>
class SplineOperational
    : public Tracking<OperationalSpace<N, Ix, P, T, What, Orientation, Null>,
                      SplinePlan<OperationalSpace<N, Ix, P, T, What, Orientation, Null>>, Damping> {
 public:
  using Tracking<OperationalSpace<N, Ix, P, T, What, Orientation, Null>,
                 SplinePlan<OperationalSpace<N, Ix, P, T, What, Orientation, Null>>, Damping>::Tracking;
};
/// A Spline Operational Control of the tool at `X_LT` on its link: `SplineOperational(arm, X_LT)`.
template <DescribedRobot R, std::size_t Ix, Frame P>
SplineOperational(const R&, const Transform<Link<Ix>, P, typename R::scalar>&)
    -> SplineOperational<R::joints, Ix, P, typename R::scalar>;
/// A Spline Operational Control with settings of one's own: `auto s = operational_settings(arm)`, then the
/// changes.
template <std::size_t Ix, Frame P, std::size_t N, Real T>
SplineOperational(const Transform<Link<Ix>, P, T>&, const OperationalSettings<N, T>&)
    -> SplineOperational<N, Ix, P, T>;

SKINCTL_END_NAMESPACE
