// Frames that a file names: the links of a URDF.
#pragma once

#include <cstddef>
#include <string_view>

#include "skinctl/frames/frame.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A name as a template argument. Two names are the same if their bytes are: any text will do, UTF-8 and
/// keywords of C++ included.
template <std::size_t N>
struct FrameName {
  char text[N] = {};

  // NOLINTNEXTLINE: a name is written as a literal.
  constexpr FrameName(const char (&name)[N]) noexcept {
    for (std::size_t i = 0; i < N; ++i) text[i] = name[i];
  }
  [[nodiscard]] constexpr std::string_view view() const noexcept { return {text, N - 1}; }
};

/// The frame that a file calls `Name`, placed and turned as the file says: `NamedFrame<"wrist_3_link">`.
///
/// The frame `Link<I>` of a model has its z axis on the joint and is turned about it as the algorithms need;
/// a link of a URDF has the axes that its author chose. Both are fixed to the same body, but poses in one are
/// wrong numbers in the other. The type keeps them apart, and `named_link_pose` leads from one to the other.
template <FrameName Name>
struct NamedFrame : FrameTag {
  static constexpr std::string_view name = Name.view();
};

SKINCTL_END_NAMESPACE
