// SPDX-License-Identifier: BSD-3-Clause
// With what a scene can be started.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A scene that starts from these: a measured state, perhaps where the robot was told to be.
template <class C, class... Begin>
concept StartsWith = requires(const C& cycle, typename C::Memory& memory, const Begin&... begin) {
  cycle.start(memory, begin...);
};

}  // namespace detail
SKINCTL_END_NAMESPACE
