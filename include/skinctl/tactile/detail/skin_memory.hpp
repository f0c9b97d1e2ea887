// SPDX-License-Identifier: BSD-3-Clause
// The memory of a skin: a record a cell, and the sums.
#pragma once

#include <array>
#include <bit>

#include "skinctl/tactile/detail/skin_tables.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The changing data of one cell.
template <class Kind>
struct alignas(8) CellRecord {
  Nanoseconds stamp = Nanoseconds::min();  ///< stamp of the last sample
  PerChannel<Kind, std::uint16_t> held{};  ///< counts of that sample after the gates
  friend bool operator==(const CellRecord&, const CellRecord&) noexcept = default;
};

/// The sums of a patch, for each channel: over its cells that are heard, of unit wrench times count, in whole
/// steps. So they are exact in any order.
template <class Kind>
struct PatchSums {
  PerChannel<Kind, std::array<std::int64_t, 6>> steps{};

  SKINCTL_INLINE void add(const CellRow<Kind>& cell, const PerChannel<Kind, std::int32_t>& change) noexcept {
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      const UnitWrench& unit = cell.unit[KindTable<Kind>::line[c]];
      for (std::size_t r = 0; r < 6; ++r) steps[c][r] += std::int64_t(unit[r]) * change[c];
    });
  }
  friend bool operator==(const PatchSums&, const PatchSums&) noexcept = default;
};

/// The states of 64 cells, a bit a cell.
struct BlockStates {
  std::uint64_t heard = 0;    ///< cells whose readings are in the sums
  std::uint64_t pressed = 0;  ///< cells with a pressure that is not 0
  std::uint64_t seeing = 0;   ///< cells that see something

  SKINCTL_INLINE void set(std::uint64_t BlockStates::* state, std::size_t cell, bool value) noexcept {
    const std::uint64_t at = cell % 64;
    this->*state = (this->*state & ~(std::uint64_t(1) << at)) | (std::uint64_t(value) << at);
  }
  friend bool operator==(const BlockStates&, const BlockStates&) noexcept = default;
};

template <std::size_t N>
constexpr std::array<Nanoseconds, N> all_at(Nanoseconds time) noexcept {
  std::array<Nanoseconds, N> stamps{};
  for (auto& t : stamps) t = time;
  return stamps;
}

/// All that changes of a skin: see `Skin::Memory`. Cells are in the order of the patches, in blocks of 64.
template <class Kind, std::size_t Cells, std::size_t Patches, class Wrenches>
struct SkinMemory {
  static constexpr std::size_t blocks = (Cells + 63) / 64;
  std::array<PatchSums<Kind>, Patches> sums{};  ///< sums over the cells that are not silent
  /// Per block, lower bound of the stamps of its cells that are not silent.
  std::array<Nanoseconds, blocks> oldest = all_at<blocks>(Nanoseconds::max());
  std::array<BlockStates, blocks> states{};
  std::array<CellRecord<Kind>, Cells> records{};

  std::uint32_t heard = 0;                 ///< number of cells that are not silent
  bool owes = false;                       ///< whether impulse is `owed`
  Nanoseconds begin = Nanoseconds::min();  ///< time before which no missing impulse is added
  /// Impulse to be added in the next interval [N s], [N m s]; in `force` where the two are not told apart.
  TouchWrenches<Wrenches> owed{};

  [[nodiscard]] SKINCTL_INLINE bool hears(std::size_t i) const noexcept {
    return ((states[i / 64].heard >> (i % 64)) & 1u) != 0;
  }
  [[nodiscard]] bool presses(std::size_t i) const noexcept {
    return ((states[i / 64].pressed >> (i % 64)) & 1u) != 0;
  }
  /// Calls `f(i)` for each of `count` cells from `first` on that is in the state `state`.
  template <class F>
  SKINCTL_INLINE void each_cell(std::uint64_t BlockStates::* state, std::size_t first, std::size_t count,
                                const F& f) const noexcept {
    for (std::size_t b = first / 64; b * 64 < first + count; ++b)
      for (std::uint64_t rest = states[b].*state & among(b, first, count); rest != 0; rest &= rest - 1)
        f(64 * b + static_cast<std::size_t>(std::countr_zero(rest)));
  }
  /// Number of the `count` cells from `first` on that are heard.
  [[nodiscard]] SKINCTL_INLINE std::size_t heard_from(std::size_t first, std::size_t count) const noexcept {
    int n = 0;
    for (std::size_t b = first / 64; b * 64 < first + count; ++b)
      n += std::popcount(states[b].heard & among(b, first, count));
    return static_cast<std::size_t>(n);
  }
  /// Sets whether cell `i` is heard, or silent, from now on.
  SKINCTL_INLINE void enter(std::size_t i, bool is_heard) noexcept {
    heard = heard + (is_heard ? 1u : 0u) - (hears(i) ? 1u : 0u);
    states[i / 64].set(&BlockStates::heard, i, is_heard);
    follow(i, is_heard);
  }
  /// Updates the state of cell `i` from the counts that it holds.
  SKINCTL_INLINE void follow(std::size_t i, bool is_heard = true) noexcept {
    bool pressed = false, seeing = false;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      const bool holds = is_heard && records[i].held[c] != 0;
      if constexpr (KindTable<Kind>::is_pressure(c)) pressed = pressed || holds;
      if constexpr (KindTable<Kind>::is_seen(c)) seeing = seeing || holds;
    });
    states[i / 64].set(&BlockStates::pressed, i, pressed);
    states[i / 64].set(&BlockStates::seeing, i, seeing);
  }
  friend bool operator==(const SkinMemory&, const SkinMemory&) noexcept = default;

 private:
  /// The bits of block `b` that are among `count` cells from `first` on.
  static SKINCTL_INLINE std::uint64_t among(std::size_t b, std::size_t first, std::size_t count) noexcept {
    const std::size_t from = first > b * 64 ? first - b * 64 : 0, to = first + count - b * 64;
    return (~std::uint64_t(0) << from) & (to >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << to) - 1);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
