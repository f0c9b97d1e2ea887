// SPDX-License-Identifier: BSD-3-Clause
// A skin for a simulated UR5: any number of cells on all six links.
#pragma once

#include <tuple>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/cover.hpp"
#include "skinctl/tactile/skin.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace ur5 {

/// The part of link `i` that cells can cover: a cylinder between `from` and `to` [m, link's frame] that
/// represents the tube or housing.
///
/// Radii and offsets: UR ROS 2 description, config/ur5/physical_parameters.yaml (BSD-3), "manually measured";
/// the ends are chosen here such that the neighbouring housings stay free.
struct Tube {
  double radius;
  Xyz<double> from, to;
};
inline constexpr std::array<Tube, 6> tubes = {{
    {0.060, {0, 0, 0.03}, {0, 0, 0.15}},
    {0.054, {-0.06, 0, 0.13585}, {-0.365, 0, 0.13585}},
    {0.040, {-0.06, 0, 0.0165}, {-0.347, 0, 0.0165}},
    {0.045, {0, 0, 0.039}, {0, 0, 0.139}},
    {0.045, {0, 0, 0.025}, {0, 0, 0.125}},
    {0.0375, {0, 0, 0.0373}, {0, 0, 0.0823}},
}};

/// Number of cells of TUM's size that fit on each link, 383 together.
inline constexpr std::array<std::size_t, 6> room = {52, 144, 99, 40, 40, 8};

namespace detail {
constexpr double length(const Tube& t) noexcept {
  const Xyz<double> d = t.to - t.from;  // along one axis
  const double sum = d.x + d.y + d.z;
  return sum < 0 ? -sum : sum;
}
/// Cells per link in proportion to `room`, at least one each; cells lost by rounding go to the largest
/// remainders.
constexpr std::array<std::size_t, 6> share_cells(std::size_t cells) noexcept {
  std::size_t all = 0, given = 6;
  for (const std::size_t r : room) all += r;
  std::array<std::size_t, 6> share{}, rest{};
  for (std::size_t i = 0; i < 6; ++i) {
    share[i] = 1 + (cells - 6) * (room[i] - 1) / (all - 6);
    rest[i] = (cells - 6) * (room[i] - 1) % (all - 6);
    given += share[i] - 1;
  }
  for (; given < cells; ++given) {
    std::size_t most = 0;
    for (std::size_t i = 1; i < 6; ++i)
      if (rest[i] > rest[most]) most = i;
    ++share[most];
    rest[most] = 0;
  }
  return share;
}
}  // namespace detail

namespace detail {
inline Transform<skinctl::detail::AnyLink, Surface> tube_pose(const Tube& t) noexcept {
  const Xyz<double> middle = 0.5 * (t.from + t.to);
  if (t.from.x != t.to.x) return {{{0.0, 1.0, 0.0}, {0.0, 0.0, -1.0}, {-1.0, 0.0, 0.0}}, middle};
  return {Rotation<double>{}, middle};
}
}  // namespace detail

/// The cylinder that cells cover on link `Ix`.
template <std::size_t Ix>
[[nodiscard]] constexpr CylinderSurface surface() noexcept {
  return {tubes[Ix].radius, detail::length(tubes[Ix])};
}

/// Number of cells on each link of a UR5 with `Cells` cells.
template <std::size_t Cells>
inline constexpr std::array<std::size_t, 6> skin_cells = detail::share_cells(Cells);

namespace detail {
/// The patch of link `Ix`; its first id follows the last one of the link before.
template <std::size_t Cells, std::size_t Ix>
SKINCTL_COLD auto make_patch(const CellGains& gains) {
  static_assert(Cells >= 6, "at least one cell a link");
  constexpr std::size_t n = skin_cells<Cells>[Ix];
  std::uint32_t first = 1;
  for (std::size_t i = 0; i < Ix; ++i) first += static_cast<std::uint32_t>(skin_cells<Cells>[i]);
  return Patch<Ix, n>(skinctl::detail::cover_any(tube_pose(tubes[Ix]), surface<Ix>(), n, first), gains);
}
template <class M, class T, std::size_t Cells, class Ix>
struct SkinType;
template <class M, class T, std::size_t Cells, std::size_t... Ix>
struct SkinType<M, T, Cells, std::index_sequence<Ix...>> {
  using type = Skin<M, T, Patch<Ix, skin_cells<Cells>[Ix]>...>;
  static type make(const std::array<CellGains, 6>& gains, const SkinSettings& settings) {
    return type(make_patch<Cells, Ix>(gains[Ix])..., settings);
  }
};
}  // namespace detail

/// The patches of a skin for a UR5, one per link, as a tuple; ids count from 1. Up to 383 cells have TUM's
/// size (pitch 27.8 mm). Most of 1260 cells have 0.53 to 0.61 of it, most of 10 000 have 0.20 to 0.22
/// (pitch 5.5 mm), in one layer. `largest_cell(surface<Ix>(), skin_cells<Cells>[Ix])` gives the exact size.
/// @param gains  gains of each link's cells: lower ones where the skin has a long lever keep the contact
///               calm.
template <std::size_t Cells>
[[nodiscard]] auto skin_patches(const std::same_as<std::array<CellGains, 6>> auto& gains) {
  return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
    return std::tuple{detail::make_patch<Cells, Ix>(gains[Ix])...};
  }(std::make_index_sequence<6>{});
}
template <std::size_t Cells>
[[nodiscard]] auto skin_patches(const CellGains& gains = {}) {
  return skin_patches<Cells>(std::array<CellGains, 6>{gains, gains, gains, gains, gains, gains});
}

}  // namespace ur5

/// A skin of `Cells` cells on the six links of a UR5.
template <std::size_t Cells, Real T = double, Topology M = ur5::Model>
using Ur5Skin = typename ur5::detail::SkinType<M, T, Cells, std::make_index_sequence<6>>::type;

/// Makes a skin of `Cells` cells on a UR5, as `ur5_skin<260>()`: see `ur5::skin_patches`; `gains` for all
/// links, or an array of six.
template <std::size_t Cells, Real T = double, Topology M = ur5::Model>
[[nodiscard]] Ur5Skin<Cells, T, M> ur5_skin(const std::same_as<std::array<CellGains, 6>> auto& gains,
                                            const SkinSettings& settings = {}) {
  return ur5::detail::SkinType<M, T, Cells, std::make_index_sequence<6>>::make(gains, settings);
}
template <std::size_t Cells, Real T = double, Topology M = ur5::Model>
[[nodiscard]] Ur5Skin<Cells, T, M> ur5_skin(const CellGains& gains = {}, const SkinSettings& settings = {}) {
  return ur5_skin<Cells, T, M>(std::array<CellGains, 6>{gains, gains, gains, gains, gains, gains}, settings);
}

SKINCTL_END_NAMESPACE
