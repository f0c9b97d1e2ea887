// The links of a file by their names: which link of the model carries each, and where.
#pragma once

#include <array>
#include <string_view>

#include "skinctl/frames/named_frame.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/model/topology.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A link as a file names and places it, and the link of the model to which it is fixed.
struct NamedLink {
  const char* name = "";
  int link = -1;           ///< index of the model's link; -1: the base
  Rotation<double> R{};    ///< axes of the named link in `Link<link>`, or in `Base`
  Xyz<double> p{0, 0, 0};  ///< origin of the named link there [m]
};

/// A description that knows its links by name, as `urdf_to_model` writes it: an array `named_links` of
/// `NamedLink`.
template <class D>
concept NamesLinks = requires {
  D::named_links.size();
  static_cast<std::string_view>(D::named_links[0].name);
};

namespace detail {
/// Where `name` stands in `D::named_links`; their number if it does not.
template <NamesLinks D>
constexpr std::size_t named_link_entry(std::string_view name) noexcept {
  std::size_t i = 0;
  while (i < D::named_links.size() && name != D::named_links[i].name) ++i;
  return i;
}
template <NamesLinks D, FrameName Name>
struct NamedLinkOf {
  static constexpr std::size_t entry = named_link_entry<D>(Name.view());
  static_assert(entry < D::named_links.size(), "no link of this name: see named_links of the description");
  static constexpr int link = D::named_links[entry].link;
};
template <int L>
struct CarrierFrame {
  using type = Link<std::size_t(L)>;
};
template <>
struct CarrierFrame<-1> {
  using type = Base;
};
}  // namespace detail

/// The index of the model's link to which the link `Name` of the file is fixed. A name that the file does not
/// have, and a link that no joint moves, do not compile.
template <NamesLinks D, FrameName Name>
[[nodiscard]] constexpr std::size_t named_link_index() noexcept {
  static_assert(detail::NamedLinkOf<D, Name>::link >= 0, "no joint moves this link: it is fixed to the base");
  return static_cast<std::size_t>(detail::NamedLinkOf<D, Name>::link);
}

/// Pose of the link `Name` of the file in the model's link that carries it, `Transform<Link<I>,
/// NamedFrame<Name>>`; in `Base` where no joint moves it. `link_poses(model, q).get<I>()` times this is the
/// pose that the file gives the link at `q`.
template <NamesLinks D, FrameName Name, Scalar T = double>
[[nodiscard]] constexpr auto named_link_pose() noexcept {
  using Of = detail::NamedLinkOf<D, Name>;
  using Pose = Transform<typename detail::CarrierFrame<Of::link>::type, NamedFrame<Name>, double>;
  constexpr const NamedLink& at = D::named_links[Of::entry];
  return Pose(at.R, at.p).template cast<T>();
}

SKINCTL_END_NAMESPACE
