// SPDX-License-Identifier: BSD-3-Clause
// The links of a file by name: the model's link that carries each, and its pose there.
#pragma once

#include <array>
#include <string_view>

#include "skinctl/frames/named_frame.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/model/topology.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A link with its name and pose from a file, and the link of the model to which it is fixed.
struct NamedLink {
  const char* name = "";
  int link = -1;           ///< index of the model's link; -1: the base
  Rotation<double> R{};    ///< axes of the named link in `Link<link>`, or in `Base`
  Xyz<double> p{0, 0, 0};  ///< origin of the named link in `Link<link>`, or in `Base` [m]
};

/// A description with links by name, as `urdf_to_model` writes it: an array `named_links` of `NamedLink`.
template <class D>
concept NamesLinks = requires {
  D::named_links.size();
  static_cast<std::string_view>(D::named_links[0].name);
};

namespace detail {
/// Index of `name` in `D::named_links`; their number if it is missing.
template <NamesLinks D>
constexpr std::size_t named_link_entry(std::string_view name) noexcept {
  std::size_t i = 0;
  while (i < D::named_links.size() && name != D::named_links[i].name) ++i;
  return i;
}
/// The link of the model that carries `name`; -1: the base, -2: no link has this name.
template <NamesLinks D>
constexpr int carrier_of(std::string_view name) noexcept {
  const std::size_t entry = named_link_entry<D>(name);
  return entry < D::named_links.size() ? D::named_links[entry].link : -2;
}
template <int L>
struct CarrierFrame {
  using type = Link<std::size_t(L)>;
};
template <>
struct CarrierFrame<-1> {
  using type = Base;
};
}  // namespace detail

/// Whether the file has a link of this name.
template <class D, FrameName Name>
concept HasLink = NamesLinks<D> && detail::carrier_of<D>(Name.view()) >= -1;
/// Whether the file has a link of this name that a joint moves.
template <class D, FrameName Name>
concept MovesLink = NamesLinks<D> && detail::carrier_of<D>(Name.view()) >= 0;

/// The index of the model's link to which the link `Name` of the file is fixed.
template <NamesLinks D, FrameName Name>
  requires MovesLink<D, Name>
[[nodiscard]] constexpr std::size_t named_link_index() noexcept {
  return static_cast<std::size_t>(detail::carrier_of<D>(Name.view()));
}

/// Pose of the file's link `Name` in the model's link that carries it,
/// `Transform<Link<Ix>, NamedFrame<Name>>`; in `Base` if no joint moves it. `link_poses(model, q).get<Ix>()`
/// times this is the pose of the file's link at `q`.
template <NamesLinks D, FrameName Name, Scalar T = double>
  requires HasLink<D, Name>
[[nodiscard]] constexpr auto named_link_pose() noexcept {
  using Carrier = typename detail::CarrierFrame<detail::carrier_of<D>(Name.view())>::type;
  constexpr const NamedLink& at = D::named_links[detail::named_link_entry<D>(Name.view())];
  return Transform<Carrier, NamedFrame<Name>>(at.R, at.p).template cast<T>();
}

// clang-format off
template <NamesLinks D, FrameName Name> requires(!MovesLink<D, Name>)
std::size_t named_link_index() = delete;  // no link of this name, or it is fixed to the base: see named_links of the description
template <NamesLinks D, FrameName Name, Scalar T = double> requires(!HasLink<D, Name>)
void named_link_pose() = delete;  // no link of this name: see named_links of the description
// clang-format on

SKINCTL_END_NAMESPACE
