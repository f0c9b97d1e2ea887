// SPDX-License-Identifier: BSD-3-Clause
// All that changes of a trusted skin.
#pragma once

#include <array>
#include <bit>
#include <limits>

#include "skinctl/sensing/cell_health.hpp"
#include "skinctl/sensing/detail/cell_life.hpp"
#include "skinctl/sensing/detail/cross_talk.hpp"
#include "skinctl/sensing/rest_level.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The memory of a `TrustedSkin`. Trivially copyable; only the skin reads and writes its members.
template <class S>
struct TrustMemory : S::Memory {
  using Touch = typename S::Touch;
  using Table = KindTable<typename S::kind>;
  static constexpr std::size_t patches = S::patches, cells = S::cells;
  using Health = CellHealth<cells, typename S::kind>;
  using Cross = CrossTalk<cells>;
  using Life = CellLife<cells>;
  using Row = HealthRow::Row;
  static constexpr std::size_t rows = Health::rows, pressures = Table::pressures, cones = Table::cones;

  typename Health::Memory health;
  std::array<std::array<RestRow, rows>, pressures> rest{};  ///< rest levels of each pressure
  /// Reading of each pressure, now and a frame ago [steps]; NaN of cells that were not heard.
  std::array<std::array<Row, rows>, pressures> now = unheard(), last = unheard();
  std::array<std::array<Row, rows>, cones> shear{}, shear_rest{};  ///< reading of each cone, at rest [counts]
  typename Cross::Memory cross;
  typename Life::Memory life;
  /// Joint positions up to which the displacements of pressed places have been counted [rad], [m]; and when.
  std::array<typename S::Wrenches::scalar, S::Wrenches::model_type::joints> counted_q{};
  Nanoseconds counted_at = Nanoseconds::min();
  std::array<std::uint16_t, rows> pushing{};  ///< cells that count for something
  /// Median, per pressure and patch, of the cells' readings above their rest levels [steps].
  std::array<std::array<float, patches>, pressures> median{};
  Nanoseconds median_at = Nanoseconds::min();
  std::uint32_t median_of = 0;              ///< patch whose median is next
  Nanoseconds newest = Nanoseconds::min();  ///< newest stamp of a sample
  float lone_share = 1;                     ///< share of its lone force for each cell without witness
  Touch filled{};                           ///< wrenches of the cells that are filled in

  [[nodiscard]] static constexpr auto unheard() noexcept {
    std::array<std::array<Row, rows>, pressures> all{};
    for (auto& of_pressure : all) of_pressure.fill(HealthRow::nothing);
    return all;
  }
  friend bool operator==(const TrustMemory& a, const TrustMemory& b) noexcept {
    const auto same = [](const auto& x, const auto& y) {
      using Bytes = std::array<unsigned char, sizeof(x)>;
      return std::is_empty_v<std::remove_cvref_t<decltype(x)>> ||
             std::bit_cast<Bytes>(x) == std::bit_cast<Bytes>(y);
    };
    return static_cast<const typename S::Memory&>(a) == static_cast<const typename S::Memory&>(b) &&
           a.health == b.health && same(a.rest, b.rest) && same(a.now, b.now) && same(a.last, b.last) &&
           same(a.shear, b.shear) && same(a.shear_rest, b.shear_rest) && a.cross == b.cross &&
           a.life == b.life && a.counted_q == b.counted_q && a.counted_at == b.counted_at &&
           a.pushing == b.pushing && same(a.median, b.median) && a.median_at == b.median_at &&
           a.median_of == b.median_of && a.newest == b.newest && a.lone_share == b.lone_share &&
           a.filled == b.filled;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
