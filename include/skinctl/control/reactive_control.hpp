// Joint and Operational Control with a target from a sensor that may jump.
#pragma once

#include "skinctl/tracking/operational_space.hpp"
#include "skinctl/tracking/reactive_plan.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Eqs. (8)-(14) after a `JointReference` from a sensor: see `ReactivePlan`.
template <std::size_t N, Real T = double, class Damping = InertialDamping<T>, class Sign = TanhSign>
using ReactiveJoint = Tracking<JointSpace<N, T>, ReactivePlan<JointSpace<N, T>>, Damping, Sign>;

/// Eqs. (15)-(21) after a `PoseReference` of the tool `P` on link `I` from a sensor.
template <std::size_t N, std::size_t I, Frame P = Tool, Real T = double, Task What = Task::pose,
          class Orientation = RotationVectorError, class Null = DampedNullSpace,
          class Damping = InertialDamping<T>, class Sign = TanhSign>
using ReactiveOperational =
    Tracking<OperationalSpace<N, I, P, T, What, Orientation, Null>,
             ReactivePlan<OperationalSpace<N, I, P, T, What, Orientation, Null>>, Damping, Sign>;

SKINCTL_END_NAMESPACE
