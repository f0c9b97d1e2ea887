// SPDX-License-Identifier: BSD-3-Clause
// Presets: choices of speed against accuracy that were measured together.
#pragma once

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A preset is a type whose members are the choices, each used where it belongs:
///
///     using Chosen = preset::Fast;
///     const auto arm = by_position<Chosen::scalar>(
///         ur5::Model{}, {.limits = limits_of<ur5::Description, Chosen::scalar>(15),
///                        .period = 8ms,
///                        .virtual_damping = 4,
///                        .substep = Chosen::substep});
///
/// `skinctl_trade` (bench/studies/trade) measures what each costs, and how far it leads a robot off the path
/// of the unabridged computation.
namespace preset {

/// The defaults of the library.
struct Balanced {
  static constexpr const char* name = "balanced";
  using scalar = double;
  static constexpr Nanoseconds substep = 2ms;  ///< longest sub-step of the virtual robot
  /// Change of a cell's reading from which on the cell sends it [N]; see `SendOnDelta`.
  static constexpr double event = 0.1;
  static constexpr Nanoseconds patience = Nanoseconds::max();
};

/// A preset with at most one evaluation of the laws in 8 ms, and float: 2.7 to 4 times cheaper, and within
/// 0.1 mm of `Balanced` in the scenes of `skinctl_trade`. Coarser messages of cells are no part of it: from
/// 0.5 N on they save 2 % of a cycle, and lead the robot off by millimetres.
struct Fast {
  static constexpr const char* name = "fast";
  using scalar = float;
  static constexpr Nanoseconds substep = 8ms;
  static constexpr double event = Balanced::event;
  static constexpr Nanoseconds patience = Balanced::patience;
};

/// `Fast` for a microcontroller with a floating-point unit for float: no heap, room for fewer commands under
/// way.
struct Tiny : Fast {
  static constexpr const char* name = "tiny";
  /// Commands under way, for `CommandHistory`: enough for a robot whose delay is at most six periods.
  static constexpr std::size_t commands = 8;
};

}  // namespace preset
SKINCTL_END_NAMESPACE
