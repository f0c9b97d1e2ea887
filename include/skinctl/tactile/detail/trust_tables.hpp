// SPDX-License-Identifier: BSD-3-Clause
// The constants of a trusted skin: its cells, their rules and levels.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/tactile/detail/trust_cells.hpp"
#include "skinctl/tactile/detail/trust_memory.hpp"
#include "skinctl/tactile/fill_in.hpp"
#include "skinctl/tactile/skin_settings.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE
template <class S>
class TrustedSkin;
namespace detail {

/// The cells of a `TrustedSkin`, and what their readings mean.
template <class S>
class TrustTables : public WrappedTouch<TrustedSkin<S>, S> {
 public:
  using T = typename S::scalar;
  using Touch = typename S::Touch;
  using Kind = typename S::kind;
  using Table = KindTable<Kind>;
  using S::patches, S::cells;
  using Memory = TrustMemory<S>;
  using Health = typename Memory::Health;
  using Cross = typename Memory::Cross;
  using Life = typename Memory::Life;
  using Row = typename Memory::Row;
  static constexpr std::size_t rows = Memory::rows, pressures = Memory::pressures, cones = Memory::cones;
  static_assert(Table::pushing <= pressures + cones + 1,
                "cells of a trusted skin see in one channel at most");

  SKINCTL_COLD TrustTables(const S& skin, const TrustSettings& settings, const FillIn& fill)
      : WrappedTouch<TrustedSkin<S>, S>(skin),
        s_(settings),
        cell_(trust_cells(settings, this->tables_)),
        fill_(fill),
        health_(settings.health, settings.noise.size() == 1 ? settings.noise : with_room(settings.noise)),
        life_(settings.life),
        rest_(settings.rest),
        masked_(rows),
        lone_(rows),
        talk_unit_(std::min(1.0f, static_cast<float>(Cross::most * settings.health.step / sensors))) {
    std::size_t pressure = 0, cone = 0;
    for (std::size_t c = 0; c < Table::pushing; ++c) {
      if (Table::is_seen(c)) seen_ = c;
      if (Table::has_cone(c)) cone_[cone++] = c;
      if (!Table::is_pressure(c)) continue;
      pressure_[pressure] = c;
      steps_per_[pressure] = static_cast<float>(1 / (settings.health.step * Table::full(c)));
      per_step_[pressure++] = static_cast<float>(settings.health.step * Table::full(c) / Table::step(c));
    }
    for (auto& levels : levels_) levels.resize(rows);
    for (auto& levels : pressed_from_) levels.resize(rows);
    if (!Table::sees) s_.proximity = false;
    require(fill.graph().size() == size(), "TrustedSkin: cells of the graph", double(fill.graph().size()),
            "those of the skin");
    for (std::size_t i = 0; i < size(); ++i) {
      opens_at_.push_back(std::numeric_limits<double>::infinity());
      for (std::size_t p = 0; p < pressures; ++p) {
        const auto& gate = cell_[i].gate[pressure_[p]];
        const double sigma = double(health_.sigma(i)) * std::sqrt(double(sensors_of(p)) / sensors);
        levels_[p][i / 16].freeze[i % 16] = static_cast<float>(rest_.freeze_level(sigma, settings.period));
        opens_at_[i] = std::min(opens_at_[i], gate.opens_at() * Table::step(pressure_[p]));
        levels_[p][i / 16].touch[i % 16] = static_cast<float>(gate.opens_at()) / per_step_[p];
        pressed_from_[p][i / 16][i % 16] = static_cast<float>(gate.closes_below()) / per_step_[p];
        low_force_[p] = std::min(low_force_[p], static_cast<float>(gate.closes_below()) / per_step_[p] - 1);
      }
      if constexpr (Table::sees)
        low_proximity_ = std::min(
            low_proximity_, static_cast<float>(cell_[i].gate[seen_].closes_below() - 1) / counts_seen());
      if (cell_[i].patch >= first_.size()) first_.push_back(i);
      if (cell_[i].masked) masked_[i / 16] = true;
      const bool lone = cell_[i].lone < std::numeric_limits<double>::infinity();
      lone_[i / 16] = static_cast<std::uint16_t>(lone_[i / 16] | (lone ? 1u << (i % 16) : 0u));
      if (i % 16 == 0) row_patch_.push_back(cell_[i].patch);
      if (cell_[i].patch != row_patch_.back()) row_patch_.back() = patches;
    }
    first_.push_back(size());
  }

 protected:
  [[nodiscard]] std::size_t size() const noexcept { return cell_.size(); }
  [[nodiscard]] auto near(std::size_t i) const noexcept { return fill_.graph().neighbours(i); }
  [[nodiscard]] bool counts(const Memory& m, std::size_t i) const noexcept {
    return m.hears(i) && Health::mask(m.health, i) < 0.5f && !cell_[i].masked;
  }
  /// The noise of the cells, with an entry for each cell that there is room for.
  [[nodiscard]] static std::vector<SensorNoise> with_room(std::vector<SensorNoise> noise) {
    noise.resize(cells);
    return noise;
  }
  /// A mask or trust in whole steps of 1/256, so that readings stay whole.
  static SKINCTL_INLINE float quantised(float share) noexcept {
    return static_cast<float>(static_cast<std::int32_t>(share * 256.0f + 0.5f)) * (1.0f / 256);
  }
  /// Number of force sensors of all pressures, and of the `p`-th.
  static constexpr double sensors = std::popcount(Table::pressed_readings);
  [[nodiscard]] int sensors_of(std::size_t p) const noexcept {
    return std::popcount(Kind::channels[pressure_[p]].readings);
  }
  /// Counts of what is seen at its greatest amount.
  [[nodiscard]] float counts_seen() const noexcept {
    return static_cast<float>(Kind::channels[seen_].greatest / Table::step(seen_));
  }
  /// Reading of cell `i` above its rest level [steps], of its `p`-th pressure; without `p` the sum of all.
  [[nodiscard]] static SKINCTL_INLINE float above(const Memory& m, std::size_t p, std::size_t i) noexcept {
    const float x = m.now[p][i / 16][i % 16] - m.rest[p][i / 16].whole[i % 16];
    return x > 0 ? x : 0;
  }
  [[nodiscard]] static SKINCTL_INLINE float above(const Memory& m, std::size_t i) noexcept {
    float sum = above(m, 0, i);
    for (std::size_t p = 1; p < pressures; ++p) sum += above(m, p, i);
    return sum;
  }
  [[nodiscard]] SKINCTL_INLINE bool has_lone(std::size_t i) const noexcept {
    return ((lone_[i / 16] >> (i % 16)) & 1u) != 0;
  }
  TrustSettings s_;
  std::vector<TrustCell<Kind>> cell_;
  FillIn fill_;
  Health health_;
  Life life_;
  RestLevel rest_;
  std::array<std::vector<RestLevelsRow>, pressures> levels_;
  std::vector<double> opens_at_;  ///< least reading above its rest level with which a cell counts
  std::array<std::vector<Row>, pressures>
      pressed_from_;                               ///< reading above rest from which a cell pushes [steps]
  std::vector<std::size_t> row_patch_;             ///< the patch of all cells of a row; `patches`: of several
  std::vector<bool> masked_;                       ///< whether a cell of the row is masked for good
  std::vector<std::uint16_t> lone_;                ///< cells with a lone force that is a limit
  std::vector<std::size_t> first_;                 ///< first cell of each patch
  std::array<std::size_t, pressures> pressure_{};  ///< channel of each pressure
  std::array<std::size_t, cones> cone_{};          ///< channel of each cone
  std::size_t seen_ = 0;                           ///< the channel that sees
  std::array<float, pressures> per_step_{},
      steps_per_{};  ///< counts in a step, steps in a unit of the pressure
  float talk_unit_;  ///< units of cross-talk's products in a step: readings are below its `most`
  std::array<float, pressures> low_force_ = [] {
    std::array<float, pressures> all{};
    all.fill(1e9f);
    return all;
  }();  ///< readings below which no cell counts [steps]
  float low_proximity_ = 1e9f;  ///< proximity below which no cell counts, 0 to 1
};

}  // namespace detail
SKINCTL_END_NAMESPACE
