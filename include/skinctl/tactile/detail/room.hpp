// For how many cells and patches a skin's memory has room.
#pragma once

#include <cstddef>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <class S>
inline constexpr std::size_t most_cells_of = [] {
  if constexpr (requires { S::capacity; }) {
    return S::capacity;
  } else {
    return S::cells;
  }
}();
template <class S>
inline constexpr std::size_t most_patches_of = [] {
  if constexpr (requires { S::most_patches; }) {
    return S::most_patches;
  } else {
    return S::patches;
  }
}();

}  // namespace detail
SKINCTL_END_NAMESPACE
