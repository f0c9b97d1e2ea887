// SPDX-License-Identifier: BSD-3-Clause
// The input of a cycle.
#pragma once

#include <optional>
#include <type_traits>
#include <utility>

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

/// A `std::optional<Goal>` that refuses another type in one line: the standard one lists all its assignments.
template <class Goal>
struct OptionalGoal : std::optional<Goal> {
  using std::optional<Goal>::optional;

  template <class X = Goal>
    requires(!std::is_same_v<std::remove_cvref_t<X>, OptionalGoal>)
  constexpr OptionalGoal& operator=(X&& x) noexcept(std::is_nothrow_assignable_v<std::optional<Goal>&, X>) {
    constexpr bool is_goal = std::is_assignable_v<std::optional<Goal>&, X>;
    static_assert(is_goal, "no goal of this scene's law: JointGoal<6>{{0.1, 0, ...}, 2s}, PoseGoal, ...");
    if constexpr (is_goal) static_cast<std::optional<Goal>&>(*this) = std::forward<X>(x);
    return *this;
  }
};
/// The addition of laws that take goals to the input.
template <class Goal>
struct GoalInput {
  /// Goal, or next sample of a moving target, for this cycle. The same goal of a law in each cycle changes
  /// nothing; a request to a set of skills is carried out each time.
  OptionalGoal<Goal> goal;
};
template <>
struct GoalInput<NoGoal> {};

/// The input of one cycle. Any bit pattern is allowed in it: unusable values are refused with a reason.
/// Limits of the scene may add to it, such as `around` of `ClearanceAround`, and laws, such as `gripper` of
/// skills with a gripper.
/// @tparam Goal    goal of the scene's law; without one there is no `goal`.
/// @tparam Sensed  readings of the scene's sensors besides cells, such as `WristInput`.
template <std::size_t N, Scalar T = double, class Goal = NoGoal, class Sensed = NoSensors>
struct CycleInput : GoalInput<Goal> {
  Nanoseconds now{};               ///< the robot's clock: the end of the interval that is integrated
  State<N, T> measured;            ///< the newest state, with its own stamp
  SampleSpan<CellSample> samples;  ///< readings of cells that arrived since the last cycle
  CycleRequest request = CycleRequest::none;
  Status observed;  ///< faults that the loop found before this cycle: see `TimeBudget`, `PacketWatch`
  [[no_unique_address]] Sensed sensed{};
};

/// Inputs of scenes with optional members: `goal` of laws that take goals, `gripper` of skills with a
/// gripper, `around` of a `ClearanceAround`, `configuration` of `Configurations`.
template <class Input>
concept InputWithGoal = requires(const Input& input) { input.goal; };
template <class Input>
concept InputWithGripper = requires(const Input& input) { input.gripper; };
template <class Input>
concept InputWithSurroundings = requires(const Input& input) { input.around; };
template <class Input>
concept InputWithConfiguration = requires(const Input& input) { input.configuration; };

/// Clears request and goal of an input, for the next cycle.
template <class Input>
void clear_requests(Input& input) noexcept {
  input.request = CycleRequest::none;
  if constexpr (InputWithGoal<Input>) input.goal.reset();
}

SKINCTL_END_NAMESPACE
