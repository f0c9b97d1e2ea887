// SPDX-License-Identifier: BSD-3-Clause
// The constants of the cells of a trusted skin.
#pragma once

#include <array>
#include <vector>

#include "skinctl/tactile/detail/skin_tables.hpp"
#include "skinctl/tactile/trust_settings.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The constants of a cell of a trusted skin.
template <class Kind>
struct TrustCell {
  std::uint32_t id = 0, patch = 0;
  std::size_t link = 0;
  std::array<float, 3> place{}, normal{};            ///< place on the link [m]; outward normal
  PerChannel<Kind, double> gain{};                   ///< gain of each channel [N] per unit of it
  PerChannel<Kind, EventGate<std::int32_t>> gate{};  ///< gates on counts
  double lone = 0;                                   ///< lone force F_1 [N]
  float rest = 0;                                    ///< initial rest level of one sensor [steps]
  bool masked = false;                               ///< whether masked for good, by the skin's file
};
/// Whether one body hardly touches both: they are on two links, or farther apart than a hand is long.
template <class Kind>
[[nodiscard]] bool apart(const TrustCell<Kind>& a, const TrustCell<Kind>& b) noexcept {
  float square = 0;
  for (std::size_t k = 0; k < 3; ++k) square += (a.place[k] - b.place[k]) * (a.place[k] - b.place[k]);
  return a.link != b.link || square > 0.04f;
}
/// The constants of the cells of a skin with these tables.
template <class Kind, class T>
[[nodiscard]] SKINCTL_COLD std::vector<TrustCell<Kind>> trust_cells(const TrustSettings& trust,
                                                                    const SkinTables<Kind, T>& skin) {
  trust.check(skin.cells.size());
  const auto numbers = [](const Xyz<double>& x) {
    return std::array{static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)};
  };
  std::vector<TrustCell<Kind>> out;
  for (std::size_t i = 0; i < skin.cells.size(); ++i) {
    const auto one = [i](const auto& list) { return list[list.size() == 1 ? 0 : i]; };
    const GivenCell<Kind>& given = skin.given[i];
    TrustCell<Kind> cell{.id = given.placed.id, .patch = skin.cells[i].patch, .link = skin.patch_of(i).link};
    cell.place = numbers(given.placed.X_LC.origin()), cell.normal = numbers(given.placed.X_LC.axis_z());
    cell.gain = given.gain, cell.masked = given.masked;
    for (std::size_t c = 0; c < cell.gate.size(); ++c)
      cell.gate[c] = given.gates[c].counted(KindTable<Kind>::step(c));
    cell.lone = one(trust.lone_force), cell.rest = one(trust.noise).rest;
    out.push_back(cell);
  }
  return out;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
