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
  friend constexpr bool operator==(const Coverage&, const Coverage&) noexcept = default;
};

namespace detail {
/// Whether a skin says how many of its cells are usable.
template <class Skin>
concept CountsCells =
    requires(const Skin& skin, const typename Skin::Memory& memory) { skin.usable(memory); };
/// The coverage of a skin; of one that only counts its cells, they are one patch.
template <CountsCells Skin>
[[nodiscard]] SKINCTL_INLINE Coverage coverage_of(const Skin& skin,
                                                  const typename Skin::Memory& memory) noexcept {
  if constexpr (requires { skin.coverage(memory); }) {
    return skin.coverage(memory);
  } else {
    Coverage out;
    if (Skin::cells > 0) out.add(skin.usable(memory), Skin::cells);
    return out;
  }
}
}  // namespace detail
SKINCTL_END_NAMESPACE
