// SPDX-License-Identifier: BSD-3-Clause
// Room for values that are written before they are read.
#pragma once

#include <cstddef>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
/// `N` values of a type without resources; memory is touched only by writes.
template <class V, std::size_t N>
union Unwritten {
  static_assert(std::is_trivially_copyable_v<V>);
  V data[N];
  Unwritten() noexcept {}
};
}  // namespace detail
SKINCTL_END_NAMESPACE
