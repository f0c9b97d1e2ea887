// SPDX-License-Identifier: BSD-3-Clause
// Patches whose cells are placed by hand on links of a file, by name.
//
// A cover of a whole surface works likewise:
// `cover(named_link_pose<D, "forearm_link">() * X_NS, surface, count, id)`.
#pragma once

#include "skinctl/model/named_links.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A cell with its pose in a named link of a file, as measured in a drawing or a viewer of the URDF.
template <FrameName Name>
struct NamedCell {
  std::uint32_t id = 0;
  Transform<NamedFrame<Name>, Cell> X_NC;  ///< pose of the cell in the named link; z is the outward normal
};

namespace detail {
template <std::size_t Ix, FrameName Name, std::size_t N>
[[nodiscard]] SKINCTL_COLD Patch<Ix, N> place_patch(const Transform<Link<Ix>, NamedFrame<Name>>& X_LN,
                                                    const NamedCell<Name> (&cells)[N],
                                                    const CellGains& gains) {
  std::vector<PlacedCell<Ix>> placed;
  for (const NamedCell<Name>& cell : cells) placed.push_back({cell.id, X_LN * cell.X_NC});
  return Patch<Ix, N>(placed, gains);
}
}  // namespace detail

/// A patch on the link `Name` of a description from `urdf_to_model`, its cells placed in the file's frame of
/// that link: `patch_on<robot::Description, "forearm_link">({{1, X_NC}}, {.force = 20})`. A name that is not
/// in the file, or a link that no joint moves, does not compile. Throws `ConfigurationError` as `Patch` does.
template <NamesLinks D, FrameName Name, std::size_t N>
[[nodiscard]] auto patch_on(const NamedCell<Name> (&cells)[N], const CellGains& gains = {}) {
  static_assert(MovesLink<D, Name>, "no link of this name, or it is fixed to the base: see named_links of D");
  if constexpr (MovesLink<D, Name>)
    return detail::place_patch<named_link_index<D, Name>(), Name, N>(named_link_pose<D, Name>(), cells,
                                                                     gains);
}

SKINCTL_END_NAMESPACE
