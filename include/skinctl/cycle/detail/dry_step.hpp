// SPDX-License-Identifier: BSD-3-Clause
// A step that nobody sees.
#pragma once

#include <cstring>

#include "skinctl/core/time.hpp"
#include "skinctl/cycle/input.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Steps `cycle` on a copy of `memory` in `scratch`, `after` later than `input` and without its request and
/// goals.
template <class C, class Watch>
void dry_step(const C& cycle, typename C::Memory& scratch, const typename C::Memory& memory,
              typename C::Input input, Nanoseconds after, Watch& watch) noexcept {
  std::memcpy(static_cast<void*>(&scratch), &memory, sizeof memory);
  input.now += after;
  input.measured.time += after;
  clear_requests(input);
  static_cast<void>(cycle.step(scratch, input, watch));
}

}  // namespace detail
SKINCTL_END_NAMESPACE
