// Patches whose cells are placed by hand on links that a file names.
//
// A whole surface is covered likewise: `cover(named_link_pose<D, "forearm_link">() * X_NS, surface, count, id)`.
#pragma once

#include "skinctl/model/named_links.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A cell placed in the frame of a link that a file names: measured in a drawing, in a viewer of the URDF.
template <FrameName Name>
struct NamedCell {
  std::uint32_t id = 0;
  Transform<NamedFrame<Name>, Cell> X_NC;  ///< z is the outward normal
};

namespace detail {
template <std::size_t I, FrameName Name, std::size_t N>
[[nodiscard]] SKINCTL_COLD Patch<I, N> place_patch(const Transform<Link<I>, NamedFrame<Name>>& X_LN,
                                                   const NamedCell<Name> (&cells)[N],
                                                   const CellGains& gains) {
  std::vector<PlacedCell<I>> placed;
  for (const NamedCell<Name>& cell : cells) placed.push_back({cell.id, X_LN * cell.X_NC});
  return Patch<I, N>(placed, gains);
}
}  // namespace detail

/// A patch on the link `Name` of a description that `urdf_to_model` wrote, its cells placed in the frame that
/// the file gives that link: `patch_on<robot::Description, "forearm_link">({{1, X_NC}}, {.force = 20})`. A
/// name that the file does not have, and a link that no joint moves, do not compile. Throws
/// `ConfigurationError` where `Patch` does.
template <NamesLinks D, FrameName Name, std::size_t N>
[[nodiscard]] auto patch_on(const NamedCell<Name> (&cells)[N], const CellGains& gains = {}) {
  static_assert(MovesLink<D, Name>, "no link of this name, or it is fixed to the base: see named_links of D");
  if constexpr (MovesLink<D, Name>)
    return detail::place_patch<named_link_index<D, Name>(), Name, N>(named_link_pose<D, Name>(), cells,
                                                                     gains);
}

SKINCTL_END_NAMESPACE
