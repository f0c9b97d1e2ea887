// SPDX-License-Identifier: BSD-3-Clause
// Skins of a program as skin files. Needs no parser.
#pragma once

#include <map>

#include "skinctl/io/skin_contents.hpp"
#include "skinctl/model/named_links.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/robots/ur5_skin.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The cells at ports 1 to 4 of each: those whose port lies where this one's does, to within 1 % of the
/// pitch.
[[nodiscard]] SKINCTL_COLD inline std::vector<std::vector<std::uint32_t>> joined_by_ports(
    const std::vector<AnyCell>& cells, const HexagonalCell& size) {
  const double x = size.scale * HexagonalCell::port_x, y = size.scale * HexagonalCell::port_y;
  const double near = 0.01 * size.scale * HexagonalCell::flat_pitch;
  const Xyz<double> ports[4] = {{x, y, 0}, {x, -y, 0}, {-x, y, 0}, {-x, -y, 0}};
  using Box = std::array<long, 3>;
  const auto box = [&](const Xyz<double>& p) {
    return Box{std::lround(p.x / near), std::lround(p.y / near), std::lround(p.z / near)};
  };
  struct Port {
    std::size_t cell, port;
    Xyz<double> place;
  };
  std::multimap<Box, Port> all;
  std::vector<std::vector<std::uint32_t>> out(cells.size(), std::vector<std::uint32_t>(4, SkinFile::nobody));
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t a = 0; a < 4; ++a) {
      const Xyz<double> place = cells[i].X_LC.origin() + cells[i].X_LC.axes() * ports[a];
      const Box at = box(place);
      for (long k = 0; k < 27; ++k) {
        const auto [from, to] =
            all.equal_range({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
        for (auto other = from; other != to; ++other) {
          const auto& [j, b, theirs] = other->second;
          const Xyz<double> gap = theirs - place;
          if (j == i || dot(gap, gap) > near * near) continue;
          if (out[i][a] != SkinFile::nobody || out[j][b] != SkinFile::nobody) continue;
          out[i][a] = cells[j].id, out[j][b] = cells[i].id;
        }
      }
      all.emplace(at, Port{i, a, place});
    }
  return out;
}

/// `X` rounded to whole nanometres, and its quaternion to billionths: files that a person reads, and that are
/// the same from every compiler.
inline SkinPose rounded(SkinPose X) {
  const auto round = [](double& x) { x = std::round(1e9 * x) / 1e9; };
  round(X.p.x), round(X.p.y), round(X.p.z);
  for (double& q : X.q) round(q);
  // q and -q are one rotation: w is positive, or else the first that is not 0.
  for (const std::size_t i : {3u, 0u, 1u, 2u}) {
    if (X.q[i] == 0) continue;
    if (X.q[i] < 0)
      for (double& q : X.q) q = -q;
    break;
  }
  return X;
}

}  // namespace detail

/// Adds a patch to `file` as a skin file writes it: in the frame of the link `link` of `D`'s file, its root
/// at its first cell, its cells joined by the ports of `size`. Throws `ConfigurationError` for a link that
/// `D` does not have or that is another link than the patch's.
///
/// @param radius, length  sizes of the tube that stands for the link in pictures [m].
template <NamesLinks D, std::size_t Ix, std::size_t N>
SKINCTL_COLD void add_patch(SkinFile& file, const std::string& name, const std::string& link,
                            const Patch<Ix, N>& patch, const HexagonalCell& size = {}, double radius = 0,
                            double length = 0) {
  const NamedLink* frame = nullptr;
  for (const NamedLink& f : D::named_links)
    if (f.name == link) frame = &f;
  if (frame == nullptr || frame->link != static_cast<int>(Ix))
    refuse("skinctl: patch " + detail::skin_quoted(name) + ": " + detail::skin_quoted(link) +
           " is not the name of link " + std::to_string(Ix));
  const Rotation<double> R_UL = frame->R.transpose();
  bool known = false;
  for (const SkinFile::Link& l : file.links) known = known || l.name == link;
  if (!known) file.links.push_back({link, radius, length, R_UL.z, 0});

  const auto& cells = patch.any();
  const auto ports = detail::joined_by_ports(cells, size);
  SkinFile::Patch out;
  out.name = name;
  out.link = link;
  out.gains = patch.gains();
  const auto& root = cells.front().X_LC;
  out.X_LinkRoot = detail::rounded(SkinPose::of(R_UL * root.axes(), R_UL * (root.origin() - frame->p)));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    SkinFile::Cell cell;
    cell.id = cells[i].id;
    cell.X_RootCell =
        detail::rounded(SkinPose::of(root.axes().transpose() * cells[i].X_LC.axes(),
                                     root.axes().transpose() * (cells[i].X_LC.origin() - root.origin())));
    cell.neighbours = ports[i];
    out.cells.push_back(std::move(cell));
  }
  file.patches.push_back(std::move(out));
}

/// The skin of `ur5_skin<Cells>(gains)` as a file, in the frames of `ur5::Ros2Links`; poses are rounded to
/// whole nanometres.
template <std::size_t Cells>
[[nodiscard]] SKINCTL_COLD SkinFile ur5_skin_file(const std::array<CellGains, 6>& gains) {
  SkinFile file;
  file.source = "ur5_skin<" + std::to_string(Cells) + ">";
  static constexpr const char* names[] = {"shoulder", "upper arm", "forearm",
                                          "wrist 1",  "wrist 2",   "wrist 3"};
  const auto patches = ur5::skin_patches<Cells>(gains);
  [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
    (add_patch<ur5::Ros2Links>(file, names[Ix], ur5::Ros2Links::named_links[Ix].name, std::get<Ix>(patches),
                               largest_cell(ur5::surface<Ix>(), ur5::skin_cells<Cells>[Ix]),
                               ur5::tubes[Ix].radius, ur5::detail::length(ur5::tubes[Ix])),
     ...);
  }(std::make_index_sequence<6>{});
  file.check();
  return file;
}

SKINCTL_END_NAMESPACE
