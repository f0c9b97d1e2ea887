// Names of coordinate frames, as types.
#pragma once

#include <cstddef>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What every frame derives from. A frame of your own is one line: `struct Table : skinctl::FrameTag {};`
struct FrameTag {};

/// The name of a coordinate frame: an empty type derived from `FrameTag`. A named point is the origin of a
/// frame, a named body is the rigid body to which a frame is fixed; so one kind of name serves for all three.
template <class F>
concept Frame = std::is_base_of_v<FrameTag, F> && std::is_empty_v<F> && !std::is_const_v<F>;

struct World : FrameTag {};   ///< at rest; z points up where gravity matters
struct Base : FrameTag {};    ///< where the robot stands: before the first joint
struct Flange : FrameTag {};  ///< the robot's mounting face, fixed to its last link
struct Tool : FrameTag {};    ///< the working point of what is mounted on the flange
struct Root : FrameTag {};    ///< the root cell of a skin patch, in which the patch's cells are known
struct Cell : FrameTag {};    ///< a skin cell: z is its outward normal

/// Link `I` of the robot: the body that joint `I` moves, counted from 0 (the paper's Link_{I+1}); its z axis
/// is the joint's axis. What stands before joint 0 is `Base`. A link of a URDF has other axes: it is a
/// `NamedFrame` (frames/named_frame.hpp), fixed to a `Link<I>`.
template <std::size_t I>
struct Link : FrameTag {
  static constexpr std::size_t index = I;
};

SKINCTL_END_NAMESPACE
