// The memory of a skin: a record a cell, and the sums.
#pragma once

#include <array>
#include <bit>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/detail/cell_table.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// All that changes of one cell.
struct alignas(16) CellRecord {
  Nanoseconds stamp = Nanoseconds::min();  ///< of the last sample
  CellCounts held;                         ///< counts of it after the gates
  std::uint32_t state = 0;                 ///< bits, see below; 0: silent

  static constexpr std::uint32_t pressed = 1;  ///< its force is not 0
  static constexpr std::uint32_t seeing = 2;   ///< its proximity is not 0
  static constexpr std::uint32_t heard = 4;    ///< its reading is in the sums
  [[nodiscard]] static SKINCTL_INLINE std::uint32_t state_of(CellCounts held) noexcept {
    return heard | (held.force != 0 ? pressed : 0u) | (held.proximity != 0 ? seeing : 0u);
  }
  friend bool operator==(const CellRecord&, const CellRecord&) noexcept = default;
};

/// The states of 64 cells once more, a bit a cell.
struct BlockStates {
  std::uint64_t heard = 0, pressed = 0, seeing = 0;

  SKINCTL_INLINE void set(std::size_t cell, std::uint32_t state) noexcept {
    const std::uint64_t at = cell % 64, bit = std::uint64_t(1) << at;
    set_held(cell, state);
    heard = (heard & ~bit) | (std::uint64_t((state >> 2) & 1u) << at);
  }
  /// The same for a cell that was heard before.
  SKINCTL_INLINE void set_held(std::size_t cell, std::uint32_t state) noexcept {
    const std::uint64_t at = cell % 64, bit = std::uint64_t(1) << at;
    pressed = (pressed & ~bit) | (std::uint64_t(state & 1u) << at);
    seeing = (seeing & ~bit) | (std::uint64_t((state >> 1) & 1u) << at);
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
template <std::size_t Cells, std::size_t Sums, class Wrenches>
struct SkinMemory {
  static constexpr std::size_t blocks = (Cells + 63) / 64;
  std::array<ExactSums, Sums> sums{};  ///< over the cells that are not silent
  /// Of each block the lower bound of the stamps of its cells that are not silent.
  std::array<Nanoseconds, blocks> oldest = all_at<blocks>(Nanoseconds::max());
  std::array<BlockStates, blocks> states{};
  std::array<CellRecord, Cells> records{};

  std::uint32_t heard = 0;                 ///< number of cells that are not silent
  bool owes = false;                       ///< whether impulse is `owed`
  Nanoseconds begin = Nanoseconds::min();  ///< no missing impulse is added before this time
  /// Impulse to be added in the next interval [N s], [N m s]; in `force` where the two are not told apart.
  TouchWrenches<Wrenches> owed{};

  [[nodiscard]] bool hears(std::size_t i) const noexcept {
    return (records[i].state & CellRecord::heard) != 0;
  }
  /// Calls `f(i)` for each of `count` cells from `first` on that is in a state.
  template <class F>
  SKINCTL_INLINE void each_cell(std::uint64_t BlockStates::* state, std::size_t first, std::size_t count,
                                const F& f) const noexcept {
    for (std::size_t b = first / 64; b * 64 < first + count; ++b)
      for (std::uint64_t rest = states[b].*state & among(b, first, count); rest != 0; rest &= rest - 1)
        f(64 * b + static_cast<std::size_t>(std::countr_zero(rest)));
  }
  /// Whether each of `count` cells from `first` on is heard.
  [[nodiscard]] bool hears_all_from(std::size_t first, std::size_t count) const noexcept {
    bool all = true;
    for (std::size_t b = first / 64; b * 64 < first + count; ++b)
      all = all && (~states[b].heard & among(b, first, count)) == 0;
    return all;
  }
  /// Number of the `count` cells from `first` on that are heard.
  [[nodiscard]] SKINCTL_INLINE std::size_t heard_from(std::size_t first, std::size_t count) const noexcept {
    int n = 0;
    for (std::size_t b = first / 64; b * 64 < first + count; ++b)
      n += std::popcount(states[b].heard & among(b, first, count));
    return static_cast<std::size_t>(n);
  }
  /// Cell `i` is in `state` from now on.
  SKINCTL_INLINE void enter(std::size_t i, std::uint32_t state) noexcept {
    heard += state / CellRecord::heard - records[i].state / CellRecord::heard;
    records[i].state = state;
    states[i / 64].set(i, state);
  }
  /// The state of cell `i`, which was heard before and is, follows what it holds.
  SKINCTL_INLINE void follow(std::size_t i) noexcept {
    const std::uint32_t state = CellRecord::state_of(records[i].held);
    records[i].state = state;
    states[i / 64].set_held(i, state);
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
