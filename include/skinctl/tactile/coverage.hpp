// SPDX-License-Identifier: BSD-3-Clause
// How much of a skin feels.
#pragma once

#include <cstddef>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Number of cells of a skin whose readings count, and of all its cells: it tells a blind skin from an
/// untouched one.
struct Coverage {
  std::size_t usable = 0, cells = 0;
  std::size_t blind_patches = 0;  ///< number of patches none of whose cells is usable

  /// Adds a patch of `of` > 0 cells, of which `usable_of_it` are usable.
  SKINCTL_INLINE constexpr void add(std::size_t usable_of_it, std::size_t of) noexcept {
    usable += usable_of_it;
    cells += of;
    blind_patches += usable_of_it == 0 ? 1u : 0u;
  }
  /// The coverage of two skins together.
  [[nodiscard]] friend constexpr Coverage together(const Coverage& a, const Coverage& b) noexcept {
    return {a.usable + b.usable, a.cells + b.cells, a.blind_patches + b.blind_patches};
  }
  friend constexpr bool operator==(const Coverage&, const Coverage&) noexcept = default;
};

SKINCTL_END_NAMESPACE
