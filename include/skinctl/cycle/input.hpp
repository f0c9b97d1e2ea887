// The input of a cycle.
#pragma once

#include <optional>

#include "skinctl/core/gripper.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/law/law_table.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/sample_span.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A request of the user besides the laws' goals.
enum class CycleRequest : unsigned char {
  none,
  stop,   ///< brake and hold, until `resume`
  resume  ///< go on after a stop, also where the guard waits for consent; after `start_refused`: start here
};

/// The input of one cycle. Any bit pattern is allowed in it: unusable values are refused with a reason.
/// @tparam Sensed  what the sensors of the scene read besides cells, such as `WristInput`.
/// @tparam Gripper  `GripperState` where the law has a gripper, see `OneGripper`.
/// Limits of the scene may add to it, such as `around` of `ClearanceAround`.
template <std::size_t N, Scalar T = double, class Goal = NoGoal, class Sensed = NoSensors,
          class Gripper = NoGripper>
struct CycleInput {
  Nanoseconds now{};               ///< the robot's clock: the end of the interval that is integrated
  State<N, T> measured;            ///< the newest state, with its own stamp
  SampleSpan<CellSample> samples;  ///< arrived since the last cycle
  CycleRequest request = CycleRequest::none;
  Status observed;  ///< faults that the loop found before this cycle: see `TimeBudget`, `PacketWatch`
  std::optional<Goal> goal;  ///< for this cycle: a goal, or the next sample of a moving target
  [[no_unique_address]] Sensed sensed{};
  [[no_unique_address]] Gripper gripper{};  ///< what the gripper reported last
};

SKINCTL_END_NAMESPACE
