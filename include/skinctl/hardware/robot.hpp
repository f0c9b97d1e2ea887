// SPDX-License-Identifier: BSD-3-Clause
// Concepts of drivers: a robot, a skin.
#pragma once

#include <concepts>
#include <span>

#include "skinctl/core/command.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The result of waiting for a robot's next state.
enum class Heard : unsigned char {
  state,   ///< a new state: run a cycle
  silent,  ///< no state within the allowed time: run a cycle on the last state
  lost     ///< the connection is gone or the robot has stopped: leave the loop
};

/// A robot on the other end of a driver, for `N` joints.
///
/// - `wait(state)` paces the loop: it returns when the next state has arrived, or after its time limit. It
///   may block and make system calls; the loop runs no cycle meanwhile.
/// - `send(command)` sends a command; false if that failed.
/// - `packet()`, optional, is the number of the newest packet; `PacketWatch` counts gaps.
/// - `wrenches()`, optional, gives the samples of a wrist sensor that arrived since the last call, in order;
///   the span stays valid until the next call.
/// - `motor_torque()`, optional, is the motors' torque at the joints of the newest state [N m].
/// - `told()`, optional, is the position that the robot's controller was commanded to reach, at the newest
///   state. The loop asks a robot by position for it once, at its start, so that a servo that droops does not
///   step.
/// - `stop()` brings the robot to rest by its own means; it must work at any time and not throw.
///
/// @tparam Command  what the scene sends: a `RobotCommand`.
template <class R, class Command, std::size_t N, class T>
concept RobotDriver = requires(R& robot, State<N, T>& state, const Command& command) {
  { robot.wait(state) } noexcept -> std::same_as<Heard>;
  { robot.send(command) } noexcept -> std::same_as<bool>;
  { robot.stop() } noexcept;
};

// What a driver has that may leave it out.
template <class R>
concept TellsWrenches = requires(R& robot) { robot.wrenches(); };
template <class R, class Torque>
concept TellsMotorTorque = requires(R& robot) {
  { robot.motor_torque() } -> std::convertible_to<Torque>;
};
template <class R>
concept NumbersPackets = requires(R& robot) {
  { robot.packet() } noexcept -> std::convertible_to<std::uint32_t>;
};
/// A driver of a robot by position that reports the position commanded last, for a scene that starts there.
template <class R, class C>
concept TellsPosition = requires(const C& cycle, typename C::Memory& memory, const typename C::Input& input,
                                 R& robot) { cycle.start(memory, input.measured, robot.told()); };

/// A skin on the other end of a driver: `poll()` gives the samples that arrived since the last call, in the
/// order of their stamps for each cell; the span stays valid until the next call. It does not block.
template <class S>
concept SkinSource = requires(S& skin) {
  { skin.poll() } noexcept -> std::same_as<std::span<const CellSample>>;
};

SKINCTL_END_NAMESPACE
