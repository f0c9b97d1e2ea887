// SPDX-License-Identifier: BSD-3-Clause
// Which of the cells that are pressed show life, and how far their places have given way to those that do
// not.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "skinctl/sensing/detail/frame_scan.hpp"
#include "skinctl/sensing/life_settings.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The life of 16 cells.
struct alignas(64) LifeRow {
  using Row = HealthRow::Row;
  static constexpr std::size_t slots = 13;  ///< number of readings kept: 96 ms and the newest
  std::array<Row, slots> past{};            ///< forces in each of the last ticks [steps]
  Row age{};                                ///< ticks since the cell has been pressed
  Row tremor{}, rim_tremor{};  ///< means of squared second differences [their variance by noise alone], of
                               ///< the cell and of the sum with its neighbours
  Row alive{}, rim_alive{};    ///< time left of its life, of the sum's life [s]
  Row way{}, speed{};          ///< distance that the place has given way [m], speed inwards [m/s]
  Row calm{};                  ///< time without a push [s]
};

/// Looks for life in `Cells` cells, tick by tick. A pressed cell lives for `held` after it
/// - moves: its force differs from that of 8, 24, 48 or 96 ms ago by more than 12 sigma; or
/// - trembles: the second differences over 48 ms, squared, each capped at 36 times their variance by noise,
///   are in the mean of 0.3 s (of 0.2 s at least) above 6.25 times it: a single step is at most 2 of the 36
///   that count. Windows begin one tick after the first in which it is pressed, or after a jump: a step alone
///   proves nothing. A sensor at the top of its range shows nothing: it lives if a neighbour does.
template <std::size_t Cells>
class CellLife {
 public:
  static constexpr std::size_t rows = (Cells + 15) / 16;
  using Bits = std::array<std::uint16_t, rows>;
  /// `Memory{}`: nothing is pressed.
  struct Memory {
    std::array<LifeRow, rows> row{};
    Bits pressed{}, lives{}, rim_lives{};  ///< states of the cells in the last tick
    Bits quiet{};                          ///< cells that gave way without life, and pushed within `calm`
    Nanoseconds at = Nanoseconds::min();   ///< time of the last tick
    std::uint32_t slot = 0;                ///< slot of the newest reading
    friend bool operator==(const Memory& a, const Memory& b) noexcept {
      using Bytes = std::array<unsigned char, sizeof(a.row)>;
      return std::bit_cast<Bytes>(a.row) == std::bit_cast<Bytes>(b.row) && a.pressed == b.pressed &&
             a.lives == b.lives && a.rim_lives == b.rim_lives && a.quiet == b.quiet && a.at == b.at &&
             a.slot == b.slot;
    }
  };
  [[nodiscard]] static SKINCTL_INLINE bool in(const Bits& bits, std::size_t i) noexcept {
    return ((bits[i / 16] >> (i % 16)) & 1u) != 0;
  }
  static SKINCTL_INLINE void set(Bits& bits, std::size_t i, bool on) noexcept {
    const auto bit = static_cast<std::uint16_t>(1u << (i % 16));
    bits[i / 16] = static_cast<std::uint16_t>(on ? bits[i / 16] | bit : bits[i / 16] & ~bit);
  }
  template <class F>
  static SKINCTL_INLINE void each(const Bits& bits, F&& f) {
    for (std::size_t b = 0; b < rows; ++b)
      for (std::uint32_t rest = bits[b]; rest != 0; rest &= rest - 1)
        f(16 * b + static_cast<std::size_t>(std::countr_zero(rest)));
  }

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit CellLife(const LifeSettings& settings) : s_(settings) { settings.check(); }
  [[nodiscard]] const LifeSettings& settings() const noexcept { return s_; }

  /// Whether a tick is due: every 8 ms, or every frame if these are longer.
  [[nodiscard]] static bool is_due(const Memory& m, Nanoseconds now) noexcept {
    return m.at == Nanoseconds::min() || now < m.at || now - m.at >= 7ms;
  }
  /// Ends a tick at `now`. `health` is the memory of a `CellHealth`.
  /// @param limits   `limits(b)`: `HealthLimitsRow` of the cells of row `b`.
  /// @param pressed  cells that push.
  /// @param near     `near(i)`: neighbours of cell `i` whose readings count.
  template <class Health, class Limits, class Near>
  void tick(Memory& m, Nanoseconds now, Health& health, const Limits& limits, const Bits& pressed,
            const Near& near) const noexcept {
    const bool begun = m.at != Nanoseconds::min() && now > m.at;
    const float dt = begun ? seconds<float>(now - m.at < 1s ? now - m.at : Nanoseconds(1s)) : 0;
    m.at = now, m.slot = (m.slot + 1) % LifeRow::slots;
    for (std::size_t b = 0; b < rows; ++b) {
      m.row[b].past[m.slot] = health.row[b].force;
      const std::uint32_t now_on = pressed[b], before = m.pressed[b], jumped = health.jumped[b];
      const std::uint32_t goes_on = now_on & before & ~jumped;
      for (std::uint32_t rest = now_on | before; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(rest));
        judge(m, m.row[b], k, ((goes_on >> k) & 1u) != 0, limits(b), dt);
      }
      health.jumped[b] = 0;
      m.pressed[b] = pressed[b];
      if (m.quiet[b] != 0) rest_row(m, b, dt);
    }
    each(m.pressed, [&](std::size_t i) {
      const LifeRow& r = m.row[i / 16];
      bool lives = r.alive[i % 16] > 0;
      if (in(health.at_top, i)) {
        lives = false;
        for (const std::size_t n : near(i))
          lives = lives || (alive(m, n) && in(m.pressed, n) && !in(health.at_top, n));
      }
      set(m.lives, i, lives);
      if (!lives) look_around(m, i, limits(i / 16), near, dt);
      set(m.rim_lives, i, lives || m.row[i / 16].rim_alive[i % 16] > 0);
    });
    for (std::size_t b = 0; b < rows; ++b) m.lives[b] &= m.pressed[b], m.rim_lives[b] &= m.pressed[b];
  }

  /// Adds the distance `inwards` that the place of pressed cell `i` has given way [m], at `speed` inwards
  /// [m/s].
  void give(Memory& m, std::size_t i, float inwards, float speed) const noexcept {
    LifeRow& r = m.row[i / 16];
    r.speed[i % 16] = speed;
    r.way[i % 16] += inwards > 0 ? inwards : 0;
    if (r.way[i % 16] > found * static_cast<float>(s_.way)) set(m.quiet, i, true);
  }
  /// Forgets how far the place of cell `i` has given way: it has shown life.
  static SKINCTL_INLINE void forgive(Memory& m, std::size_t i) noexcept { m.row[i / 16].way[i % 16] = 0; }
  /// Share of the push of a cell without life that counts, by how far its place has given way, 0 to 1.
  [[nodiscard]] float share(const Memory& m, std::size_t i) const noexcept {
    const float left = 1 - m.row[i / 16].way[i % 16] / static_cast<float>(s_.way);
    return left > 0 ? left : 0;
  }
  /// Share of the push of a cell without life that damping leaves, 0 to 1, for such pushes of `force` [N] in
  /// all.
  [[nodiscard]] float braked(const Memory& m, std::size_t i, float force) const noexcept {
    const float speed = m.row[i / 16].speed[i % 16];
    const float damping =
        2 * std::sqrt(static_cast<float>(s_.mass / s_.way) / (force > 1e-3f ? force : 1e-3f));
    const float left = 1 - damping * (speed > 0 ? speed : 0);
    return left > 0 ? left : 0;
  }

 private:
  static constexpr float found = 0.9f;                       ///< share of `way` from which on a cell is quiet
  static constexpr std::array<int, 4> windows{1, 3, 6, 12};  ///< spans of a movement [ticks]
  static constexpr int half = 6;                      ///< span of a first difference of a tremor [ticks]
  static constexpr float cap = 36, trembles = 6.25f;  ///< limits of squared second differences
  static constexpr float enough = 25, mean_of = 37;   ///< ticks of 0.2 s and of 0.3 s

  [[nodiscard]] static SKINCTL_INLINE bool alive(const Memory& m, std::size_t i) noexcept {
    return m.row[i / 16].alive[i % 16] > 0;
  }
  [[nodiscard]] static SKINCTL_INLINE float past(const Memory& m, const LifeRow& r, std::size_t k,
                                                 int ticks) noexcept {
    const std::size_t slot = (m.slot + LifeRow::slots - static_cast<std::size_t>(ticks)) % LifeRow::slots;
    return r.past[slot][k];
  }
  /// Takes a second difference into a mean; whether it shows a tremor.
  /// @param count  number of second differences since the windows began, this one included.
  [[nodiscard]] static bool tremble(float& mean, float difference, float per_sigma, float count) noexcept {
    const float in_sigma = difference * per_sigma, square = in_sigma * in_sigma / 6;
    mean += ((square < cap ? square : cap) - mean) / (count < mean_of ? count : mean_of);
    return count >= enough && mean > trembles;
  }
  /// Looks for life in the cell of lane `k`, which was pressed in the last tick and this one, or begins or
  /// ends.
  void judge(const Memory& m, LifeRow& r, std::size_t k, bool goes_on, const HealthLimitsRow& limits,
             float dt) const noexcept {
    if (!goes_on) {
      r.age[k] = r.tremor[k] = r.rim_tremor[k] = r.alive[k] = r.rim_alive[k] = r.speed[k] = r.calm[k] = 0;
      return;
    }
    r.calm[k] = 0;
    r.age[k] += 1;
    const float now = r.past[m.slot][k];
    bool life = false;
    for (const int w : windows)
      life = life || (r.age[k] > static_cast<float>(w) && std::abs(now - past(m, r, k, w)) > limits.moves[k]);
    if (const float count = r.age[k] - 2 * half; count >= 1)
      life = tremble(r.tremor[k], now - 2 * past(m, r, k, half) + past(m, r, k, 2 * half),
                     limits.per_sigma[k], count) ||
             life;
    r.alive[k] = life ? seconds<float>(s_.held) : r.alive[k] - dt;
  }
  /// Finds the life of the sum of a cell and its neighbours, as far as they have been pressed for as long.
  /// It moves by what a steady creep does not explain: cells that drift alike add up faster than their noise
  /// does.
  template <class Near>
  void look_around(Memory& m, std::size_t i, const HealthLimitsRow& limits, const Near& near,
                   float dt) const noexcept {
    LifeRow& r = m.row[i / 16];
    const std::size_t k = i % 16;
    const auto over = [&](int first, int second, float& number) {
      float sum = 0;
      number = 0;
      const auto add = [&](std::size_t j) {
        const LifeRow& of = m.row[j / 16];
        if (!in(m.pressed, j) || !(of.age[j % 16] > static_cast<float>(first + second))) return;
        const float a = past(m, of, j % 16, 0), b = past(m, of, j % 16, first);
        sum += second == 0 ? a - b : a - 2 * b + past(m, of, j % 16, first + second);
        number += 1;
      };
      add(i);
      for (const std::size_t n : near(i)) add(n);
      return sum;
    };
    bool life = false;
    float number = 0;
    for (const int w : windows) {
      if (w > half || !(r.age[k] > static_cast<float>(2 * w))) break;
      const float change = std::abs(over(w, w, number));
      life = life || change > limits.moves[k] * std::sqrt(3 * number);  // as rare by noise alone
    }
    if (const float count = r.age[k] - 2 * half; count >= 1) {
      const float change = over(half, half, number);
      life = tremble(r.rim_tremor[k], change, limits.per_sigma[k] / std::sqrt(number), count) || life;
    }
    r.rim_alive[k] = life ? seconds<float>(s_.held) : r.rim_alive[k] - dt;
  }
  /// Frees the quiet cells of a row that have not pushed for `calm`.
  void rest_row(Memory& m, std::size_t b, float dt) const noexcept {
    for (std::uint32_t rest = m.quiet[b] & ~std::uint32_t(m.pressed[b]); rest != 0; rest &= rest - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(rest));
      if ((m.row[b].calm[k] += dt) < seconds<float>(s_.calm)) continue;
      set(m.quiet, 16 * b + k, false), m.row[b].way[k] = 0;
    }
  }
  LifeSettings s_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
