// SPDX-License-Identifier: BSD-3-Clause
// The state of a measured or virtual robot: joint positions and velocities at a time.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Joint positions `q` and velocities `dq` of a measured or virtual robot at `time`.
template <std::size_t N, Scalar T = double>
struct State {
  Nanoseconds time{};
  JointPosition<N, T> q;
  JointVelocity<N, T> dq;
};

SKINCTL_END_NAMESPACE
