// SPDX-License-Identifier: BSD-3-Clause
// Cross-talk: a cell whose changes are a share of those of a cell elsewhere.
#pragma once

#include <array>
#include <cstdint>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Follows up to `slots` cells that move: their changes within 20 ms, over half a second. One of them a frame
/// is compared with all others.
///
/// With `S_ab = sum of a's changes times b's`, noise of variance `2 sigma^2` in each of n changes, and the
/// gain `g = S_ab / S_bb > 0` of the stronger cell b, cell a is explained by b if
///
///     S_aa - g S_ab - 2 n sigma^2 (1 + g^2) <= share (S_aa - 2 n sigma^2),
///
/// where its own changes are 6 times its noise at least. It is found when the same cell explains it at every
/// look for more than half a second, so in two windows that have no change in common: fingers that close on
/// something at once are alike for one. Time and memory are bounded: 32 products a pair.
template <std::size_t Cells, std::size_t Slots = 128>
class CrossTalk {
 public:
  static constexpr std::size_t slots = Slots, ticks = 25, none = ~std::size_t(0);
  static constexpr Nanoseconds tick = 20ms;
  /// Changes beyond this [units of `force`] are cut off: sums of products are whole numbers of 32 bits.
  static constexpr float most = 4095;
  /// 25 changes, and zeros up to whole registers.
  using Changes = std::array<std::int16_t, 32>;
  struct Memory {
    alignas(64) std::array<Changes, slots> change{};
    std::array<std::int32_t, slots> energy{};                       ///< sum of squared changes, S_aa
    std::array<std::uint32_t, slots> cell{};                        ///< index of the cell and 1; 0: free
    std::array<float, slots> base{};                                ///< force at the last tick
    std::array<std::uint16_t, slots> known{}, idle{}, explained{};  ///< numbers of ticks
    std::array<std::uint16_t, slots> by{};                          ///< slot of the cell that explains it
    std::array<std::uint64_t, (Cells + 63) / 64> followed{};        ///< a bit per cell
    Nanoseconds next = Nanoseconds::min();
    std::uint16_t at = 0, suspect = 0, free = slots;
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// Begins to follow cell `i`, which moves, if there is room.
  static void follow(Memory& m, std::size_t i, float force) noexcept {
    std::uint64_t& word = m.followed[i / 64];
    const std::uint64_t bit = std::uint64_t(1) << (i % 64);
    if (m.free == 0 || (word & bit) != 0) return;
    std::size_t s = 0;
    while (m.cell[s] != 0) ++s;
    m.cell[s] = static_cast<std::uint32_t>(i + 1), m.base[s] = force;
    m.known[s] = m.idle[s] = m.explained[s] = 0;
    m.change[s] = {}, m.energy[s] = 0;
    word |= bit;
    --m.free;
  }
  /// Every 20 ms: notes the changes of `force(i)`, of noise `sigma(i)` in the same unit.
  template <class Force, class Sigma>
  static void note(Memory& m, Nanoseconds now, const Force& force, const Sigma& sigma) noexcept {
    if (m.next != Nanoseconds::min() && now < m.next) return;
    m.next = now + tick;
    m.at = static_cast<std::uint16_t>((m.at + 1) % ticks);
    if (m.free == slots) return;
    const auto more = [](std::uint16_t n) { return static_cast<std::uint16_t>(n < 60000 ? n + 1 : n); };
    for (std::size_t s = 0; s < slots; ++s) {
      if (m.cell[s] == 0) continue;
      const std::size_t i = m.cell[s] - 1;
      const float x = force(i), d = x - m.base[s], size = d < 0 ? -d : d;
      m.base[s] = x;
      m.change[s][m.at] = static_cast<std::int16_t>(size <= most  ? d
                                                    : size > most ? (d < 0 ? -most : most)
                                                                  : 0);
      m.energy[s] = product(m.change[s], m.change[s]);
      m.known[s] = static_cast<std::uint16_t>(m.known[s] < ticks ? m.known[s] + 1 : ticks);
      m.idle[s] = size > 6 * sigma(i) ? std::uint16_t(0) : more(m.idle[s]);
      if (m.explained[s] > 0) m.explained[s] = more(m.explained[s]);
      if (m.idle[s] <= 2 * ticks) continue;
      m.followed[i / 64] &= ~(std::uint64_t(1) << (i % 64));
      m.cell[s] = 0;
      ++m.free;
    }
  }
  /// Looks at one of the cells that are followed; returns the index of the cell if its cross-talk is found,
  /// else `none`.
  ///
  /// @param share  `share(i)`: share of cell `i`'s changes that may be left unexplained
  /// @param apart  `apart(i, j)`: whether j is elsewhere, and counts
  template <class Sigma, class Share, class Apart>
  [[nodiscard]] static std::size_t look(Memory& m, const Sigma& sigma, const Share& share,
                                        const Apart& apart) noexcept {
    if (m.free == slots) return none;
    do m.suspect = static_cast<std::uint16_t>((m.suspect + 1) % slots);
    while (m.cell[m.suspect] == 0);
    const std::size_t a = m.suspect;
    if (m.known[a] < ticks / 2) return none;
    const std::size_t i = m.cell[a] - 1;
    const auto n = static_cast<float>(m.known[a]);
    const float noise = 2 * n * sigma(i) * sigma(i), own = static_cast<float>(m.energy[a]), left = share(i);
    if (own < 6 * noise) return none;
    const auto explains = [&](std::size_t b) {
      if (b == a || m.cell[b] == 0 || m.known[b] < m.known[a] || m.energy[b] <= m.energy[a]) return false;
      if (!apart(i, m.cell[b] - 1)) return false;
      const auto both = static_cast<float>(product(m.change[a], m.change[b]));
      if (!(both > 0)) return false;
      const float gain = both / static_cast<float>(m.energy[b]);
      return own - gain * both - noise * (1 + gain * gain) <= left * (own - noise);
    };
    if (m.explained[a] > 0) {
      if (explains(m.by[a])) return m.explained[a] > ticks ? i : none;
      m.explained[a] = 0;
    }
    for (std::size_t b = 0; b < slots; ++b)
      if (explains(b)) {
        m.explained[a] = 1, m.by[a] = static_cast<std::uint16_t>(b);
        break;
      }
    return none;
  }

 private:
  [[nodiscard]] static std::int32_t product(const Changes& a, const Changes& b) noexcept {
    std::int32_t sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += std::int32_t(a[k]) * std::int32_t(b[k]);
    return sum;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
