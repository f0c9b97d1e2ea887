// How much of a skin feels.
#pragma once

#include <cstddef>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The cells of a skin whose readings count, of all that it has: what tells a blind skin from an untouched one.
struct Coverage {
  std::size_t usable = 0, cells = 0;
  double least = 1;  ///< share of usable cells of the patch that has the smallest, in [0, 1]
  static constexpr std::size_t whole = static_cast<std::size_t>(-1);
  /// Index of a cell that is neither usable nor within `TrustSettings::reach` of a usable one of its patch; `whole`: none.
  std::size_t hole = whole;

  /// One more patch of `of` > 0 cells.
  SKINCTL_INLINE constexpr void add(std::size_t usable_of_it, std::size_t of) noexcept {
    usable += usable_of_it;
    cells += of;
    const double share = static_cast<double>(usable_of_it) / static_cast<double>(of);
    if (share < least) least = share;
  }
  /// That of two skins, the cells of the second behind those of the first.
  [[nodiscard]] friend constexpr Coverage together(const Coverage& a, const Coverage& b) noexcept {
    Coverage out = a;
    out.usable += b.usable, out.cells += b.cells;
    if (b.least < out.least) out.least = b.least;
    if (out.hole == whole && b.hole != whole) out.hole = a.cells + b.hole;
    return out;
  }
  friend constexpr bool operator==(const Coverage&, const Coverage&) noexcept = default;
};

SKINCTL_END_NAMESPACE
