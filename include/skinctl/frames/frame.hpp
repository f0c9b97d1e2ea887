// SPDX-License-Identifier: BSD-3-Clause
// Names of coordinate frames, as types.
#pragma once

#include <cstddef>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Base class of all frames. An own frame is one line: `struct Table : skinctl::FrameTag {};`
struct FrameTag {};

/// The name of a coordinate frame: an empty type derived from `FrameTag`. A frame also names a point, its
/// origin, and a body, to which it is fixed.
template <class F>
concept Frame = std::is_base_of_v<FrameTag, F> && std::is_empty_v<F> && !std::is_const_v<F>;

struct World : FrameTag {};   ///< inertial frame; z points up where gravity matters
struct Base : FrameTag {};    ///< frame fixed to the robot's foot, before the first joint
struct Flange : FrameTag {};  ///< the robot's mounting face, fixed to its last link
struct Tool : FrameTag {};    ///< the working point of the tool on the flange
struct Root : FrameTag {};    ///< the root cell of a skin patch, the reference of its cells' poses
struct Cell : FrameTag {};    ///< a skin cell: z is its outward normal

/// Link `Ix` of the robot: the body that joint `Ix` moves, counted from 0 (the paper's Link_{Ix+1}); its z
/// axis is the joint's axis. The body before joint 0 is `Base`. A link of a URDF has other axes: it is a
/// `NamedFrame` (frames/named_frame.hpp), fixed to a `Link<Ix>`.
template <std::size_t Ix>
struct Link : FrameTag {
  static constexpr std::size_t index = Ix;
};

SKINCTL_END_NAMESPACE
