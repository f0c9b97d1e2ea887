// SPDX-License-Identifier: BSD-3-Clause
// Settings, memory and result of a guard.
#pragma once

#include <optional>

#include "skinctl/core/command.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/resolver/interval.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The kind of `GuardSettings`, for `Cycle::without`.
struct GuardPart {};

/// Settings of a guard beyond the robot's description; each has a usable default.
template <std::size_t N, Real T = double>
struct GuardSettings {
  using Kind = GuardPart;
  /// Largest distance [rad] of a start from the first measured position, and by position of every command
  /// from the measured one. Default: that of a robot at full speed, `RobotConfiguration::largest_distance`;
  /// for commands, which have to be able to stop within it, the way of a stop from top speed more.
  std::optional<JointPosition<N, T>> lead = {};
  /// Torque interface: fastest change of a torque, in units of the torque limit per second; also the rate of
  /// the change to the fallback.
  T torque_rate = T(50);
  /// Largest distance beyond a position limit at which a measured position is accepted [rad], [m].
  T beyond = T(1);
  /// Largest measured velocity that is accepted, in units of the velocity limit.
  T overspeed = T(10);
  /// Reasons of other stages on which the command brakes, in addition to those of the table: for example
  /// `sample_stale`, for a robot that must not move unless all of its skin reports.
  Status brakes_on = {};
  /// Reasons after which the motion goes on only on request, in addition to those of the table: for example
  /// `state_stale`.
  Status consent = {};

  /// The settings for the joints of a subset.
  template <class Set>
  [[nodiscard]] GuardSettings<Set::count, T> part() const {
    GuardSettings<Set::count, T> out{.torque_rate = torque_rate,
                                     .beyond = beyond,
                                     .overspeed = overspeed,
                                     .brakes_on = brakes_on,
                                     .consent = consent};
    if (lead) out.lead = Set::of(*lead);
    return out;
  }
};

/// The memory of a guard: the last command that it passed. Trivially copyable.
template <std::size_t N, Real T = double>
struct GuardMemory {
  JointCommand<N, T> command;  ///< the last command; not valid after a start that is refused
  Status latched;              ///< faults that wait for the user's consent
  bool begun = false;          ///< whether a measured state has shown the robot where it was started
};

/// The command that the guard passes; `altered` means that it differs from the one given (the resolver must
/// learn of it, see `Resolver::sent`).
template <std::size_t N, Real T = double>
struct Guarded {
  JointCommand<N, T> command;
  Status status;
  bool altered = false;
  bool brakes = false;  ///< whether it brakes or fades whatever is asked for, until a fault is over
};

SKINCTL_END_NAMESPACE
