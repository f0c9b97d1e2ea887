// The memory of a skin, and its constant tables.
#pragma once

#include <array>
#include <bit>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/detail/cell_table.hpp"
#include "skinctl/tactile/skin_settings.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <std::size_t N>
constexpr std::array<Nanoseconds, N> all_at(Nanoseconds time) noexcept {
  std::array<Nanoseconds, N> stamps{};
  for (auto& t : stamps) t = time;
  return stamps;
}

/// The readings of a cell that make up a wrench.
enum class Reading { both, force, proximity };

/// See `Skin::Memory`. Cells are in the order of the patches, in blocks of 64.
template <std::size_t Cells, std::size_t Patches, class Wrenches>
struct SkinMemory {
  static constexpr std::size_t cells = Cells;
  static constexpr std::size_t blocks = (Cells + 63) / 64;

  std::array<ExactSums, Patches> sums{};      ///< over the cells that are not silent
  Nanoseconds begin = Nanoseconds::min();     ///< no missing impulse is added before this time
  std::array<Nanoseconds, blocks> oldest{};   ///< lower bound of the stamps of the block's non-silent cells
  std::array<std::uint64_t, blocks> heard{};  ///< a bit per cell: not silent, its reading is in the sums
  /// Impulse to be added in the next interval [N s], [N m s]; in `force` where the two are not told apart.
  TouchWrenches<Wrenches> owed{};
  std::array<Nanoseconds, Cells> stamp = all_at<Cells>(Nanoseconds::min());  ///< of the last sample
  std::array<CellCounts, Cells> held{};                                      ///< counts of it after the gates

  [[nodiscard]] bool hears(std::size_t i) const noexcept { return (heard[i / 64] >> (i % 64)) & 1u; }
  /// Whether every cell of block `b` is heard, that is, not silent.
  [[nodiscard]] bool hears_all_of(std::size_t b) const noexcept {
    constexpr std::uint64_t all = ~std::uint64_t(0), rest = Cells % 64;
    return heard[b] == (b + 1 < blocks || rest == 0 ? all : (std::uint64_t(1) << rest) - 1);
  }
  /// Whether each of `count` cells from `first` on is heard.
  [[nodiscard]] bool hears_all_from(std::size_t first, std::size_t count) const noexcept {
    const std::size_t end = first + count;
    bool all = true;
    for (std::size_t b = first / 64; b * 64 < end; ++b) {
      const std::size_t from = first > b * 64 ? first - b * 64 : 0, to = end - b * 64;
      const std::uint64_t wanted =
          (~std::uint64_t(0) << from) & (to >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << to) - 1);
      all = all && (heard[b] & wanted) == wanted;
    }
    return all;
  }
  /// Number of the `count` cells from `first` on that are heard.
  [[nodiscard]] SKINCTL_INLINE std::size_t heard_from(std::size_t first, std::size_t count) const noexcept {
    const std::size_t end = first + count;
    int n = 0;
    for (std::size_t b = first / 64; b * 64 < end; ++b) {
      const std::size_t from = first > b * 64 ? first - b * 64 : 0, to = end - b * 64;
      const std::uint64_t wanted =
          (~std::uint64_t(0) << from) & (to >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << to) - 1);
      n += std::popcount(heard[b] & wanted);
    }
    return static_cast<std::size_t>(n);
  }
  /// Whether a cell of block `b` may be pressed: false if none is. As fast as reading the block.
  [[nodiscard]] SKINCTL_INLINE bool may_press(std::size_t b) const noexcept {
    if (heard[b] == 0) return false;
    constexpr auto forces = std::bit_cast<std::uint32_t>(CellCounts{0xFFFF, 0});
    const auto any = [&](std::size_t first, auto count) SKINCTL_INLINE_LAMBDA {
      std::uint32_t either = 0;
      for (std::size_t k = 0; k < count; ++k) either |= std::bit_cast<std::uint32_t>(held[first + k]);
      return (either & forces) != 0;
    };
    if (Cells % 64 == 0 || b + 1 < blocks) return any(64 * b, std::integral_constant<std::size_t, 64>{});
    return any(64 * b, std::integral_constant<std::size_t, Cells % 64>{});
  }
  friend bool operator==(const SkinMemory&, const SkinMemory&) noexcept = default;
};

/// The constant data of a skin.
template <Real T, std::size_t Patches>
struct SkinTables {
  SkinSettings settings;
  EventGate<std::int32_t> force_gate, proximity_gate;     ///< on counts
  std::array<T, Patches> force_gain{}, proximity_gain{};  ///< [N] per count
  CellTable cells;

  SkinTables(const SkinSettings& s, std::size_t count)
      : settings(s),
        force_gate(s.force.counted(CellCounts::force_unit)),
        proximity_gate(s.proximity.counted(CellCounts::proximity_unit)),
        cells(count) {}

  /// The push on a cell by its readings of one kind, or of both [N].
  template <Reading R>
  SKINCTL_INLINE T push_on(const CellEntry& cell, CellCounts c) const noexcept {
    if constexpr (R == Reading::force) return force_gain[cell.patch] * static_cast<T>(c.force);
    if constexpr (R == Reading::proximity) return proximity_gain[cell.patch] * static_cast<T>(c.proximity);
    return force_gain[cell.patch] * static_cast<T>(c.force) +
           proximity_gain[cell.patch] * static_cast<T>(c.proximity);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
