// Cross-talk: a cell whose changes are a share of those of a cell elsewhere.
#pragma once

#include <array>
#include <cstdint>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Follows up to `slots` cells that move: their changes within 20 ms, over the last second. One of them a frame is
/// compared with all others.
///
/// With `S_ab = sum of a's changes times b's`, noise of variance `2 sigma^2` in each of n changes, and the gain
/// `g = S_ab / S_bb > 0` of the stronger cell b, cell a is explained by b if
///
///     S_aa - g S_ab - 2 n sigma^2 (1 + g^2) <= share (S_aa - 2 n sigma^2),
///
/// where its own changes are 20 times its noise at least. Time and memory are bounded: 50 products a pair.
template <std::size_t Cells, std::size_t Slots = 64>
class CrossTalk {
 public:
  static constexpr std::size_t slots = Slots, ticks = 50, none = ~std::size_t(0);
  static constexpr Nanoseconds tick = 20ms;
  struct Memory {
    std::array<std::array<std::int16_t, ticks>, slots> change{};  ///< [steps]
    std::array<std::uint32_t, slots> cell{};                      ///< index of the cell and 1; 0: free
    std::array<float, slots> base{};                              ///< force at the last tick [steps]
    std::array<std::uint16_t, slots> known{}, idle{};             ///< ticks
    std::array<std::uint64_t, (Cells + 63) / 64> followed{};      ///< a bit per cell
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
    m.cell[s] = static_cast<std::uint32_t>(i + 1), m.base[s] = force, m.known[s] = m.idle[s] = 0;
    m.change[s] = {};
    word |= bit;
    --m.free;
  }
  /// Every 20 ms: notes the changes. `force(i)` and `sigma(i)` are in steps.
  template <class Force, class Sigma>
  static void note(Memory& m, Nanoseconds now, const Force& force, const Sigma& sigma) noexcept {
    if (m.next != Nanoseconds::min() && now < m.next) return;
    m.next = now + tick;
    m.at = static_cast<std::uint16_t>((m.at + 1) % ticks);
    for (std::size_t s = 0; s < slots; ++s) {
      if (m.cell[s] == 0) continue;
      const std::size_t i = m.cell[s] - 1;
      const float x = force(i), d = x - m.base[s], size = d < 0 ? -d : d;
      m.base[s] = x;
      m.change[s][m.at] = static_cast<std::int16_t>(size < 32000 ? d : 0);
      m.known[s] = static_cast<std::uint16_t>(m.known[s] < ticks ? m.known[s] + 1 : ticks);
      m.idle[s] = static_cast<std::uint16_t>(size > 6 * sigma(i) ? 0 : m.idle[s] + 1);
      if (m.idle[s] <= ticks) continue;
      m.followed[i / 64] &= ~(std::uint64_t(1) << (i % 64));
      m.cell[s] = 0;
      ++m.free;
    }
  }
  /// Looks at one of the cells that are followed; the index of the cell if it is explained by another, else `none`.
  ///
  /// @param share  `share(i)`: what may be left unexplained of cell `i`; 0: it is not suspected
  /// @param apart  `apart(i, j)`: whether j is elsewhere, and counts
  template <class Sigma, class Share, class Apart>
  [[nodiscard]] static std::size_t look(Memory& m, const Sigma& sigma, const Share& share,
                                        const Apart& apart) noexcept {
    m.suspect = static_cast<std::uint16_t>((m.suspect + 1) % slots);
    const std::size_t a = m.suspect;
    if (m.cell[a] == 0 || m.known[a] < ticks / 2) return none;
    const std::size_t i = m.cell[a] - 1;
    const auto n = static_cast<float>(m.known[a]);
    const float noise = 2 * n * sigma(i) * sigma(i), own = product(m, a, a), left = share(i);
    if (!(left > 0) || own < 20 * noise) return none;
    for (std::size_t b = 0; b < slots; ++b) {
      if (b == a || m.cell[b] == 0 || m.known[b] < m.known[a] || !apart(i, m.cell[b] - 1)) continue;
      const float other = product(m, b, b), both = product(m, a, b);
      if (!(both > 0) || !(other > own)) continue;
      const float gain = both / other;
      if (own - gain * both - noise * (1 + gain * gain) <= left * (own - noise)) return i;
    }
    return none;
  }

 private:
  static float product(const Memory& m, std::size_t a, std::size_t b) noexcept {
    std::int64_t sum = 0;
    for (std::size_t k = 0; k < ticks; ++k)
      sum += std::int32_t(m.change[a][k]) * std::int32_t(m.change[b][k]);
    return static_cast<float>(sum);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
