// SPDX-License-Identifier: BSD-3-Clause
// Frames named in a file: the links of a URDF.
#pragma once

#include <cstddef>
#include <string_view>

#include "skinctl/frames/frame.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A name as a template argument. Names are equal if their bytes are; any text is allowed, also UTF-8 and C++
/// keywords.
template <std::size_t N>
struct FrameName {
  char text[N] = {};

  // NOLINTNEXTLINE: a name is written as a literal.
  constexpr FrameName(const char (&name)[N]) noexcept {
    for (std::size_t i = 0; i < N; ++i) text[i] = name[i];
  }
  [[nodiscard]] constexpr std::string_view view() const noexcept { return {text, N - 1}; }
};

/// The frame that a file calls `Name`, with the file's origin and axes: `NamedFrame<"wrist_3_link">`.
///
/// The frame `Link<Ix>` of a model has its z axis on the joint, and x and y axes chosen by the algorithms; a
/// link of a URDF has axes chosen by its author. Both are fixed to the same body, but poses in one are wrong
/// in the other. The type distinguishes them, and `named_link_pose` converts.
template <FrameName Name>
struct NamedFrame : FrameTag {
  static constexpr std::string_view name = Name.view();
};

SKINCTL_END_NAMESPACE
