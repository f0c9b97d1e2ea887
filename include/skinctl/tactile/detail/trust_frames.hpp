// What a trusted skin knows of its cells: frames of rest levels and faults, and witnesses.
#pragma once

#include <algorithm>
#include <bit>

#include "skinctl/sensing/evidence.hpp"
#include "skinctl/tactile/detail/trust_cells.hpp"
#include "skinctl/tactile/detail/trust_memory.hpp"
#include "skinctl/tactile/fill_in.hpp"
#include "skinctl/tactile/skin_settings.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE
template <class S>
class TrustedSkin;
namespace detail {

/// The cells of a `TrustedSkin`, frame by frame: rest levels, faults, and what they say of each other.
template <class S>
class TrustFrames : public WrappedTouch<TrustedSkin<S>, S> {
 public:
  using T = typename S::scalar;
  using Touch = typename S::Touch;
  using Kind = typename S::kind;
  using Table = KindTable<Kind>;
  using S::patches, S::cells;
  using Memory = TrustMemory<S>;
  using Health = typename Memory::Health;
  using Cross = typename Memory::Cross;
  using Row = typename Memory::Row;
  static constexpr std::size_t rows = Memory::rows, pressures = Memory::pressures, cones = Memory::cones;
  static_assert(Table::pushing <= pressures + cones + 1,
                "cells of a trusted skin see in one channel at most");

  SKINCTL_COLD TrustFrames(const S& skin, const TrustSettings& settings, const FillIn& fill)
      : WrappedTouch<TrustedSkin<S>, S>(skin),
        s_(settings),
        cell_(trust_cells(settings, this->tables_)),
        fill_(fill),
        health_(settings.health, settings.noise.size() == 1 ? settings.noise : with_room(settings.noise)),
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
    if (!Table::sees) s_.proximity = false;
    if (s_.reach < std::numeric_limits<double>::infinity()) within_ = cells_within(skin.places(), s_.reach);
    require(fill.graph().size() == size(), "TrustedSkin: cells of the graph", double(fill.graph().size()),
            "those of the skin");
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t p = 0; p < pressures; ++p) {
        const auto& gate = cell_[i].gate[pressure_[p]];
        const double sigma = double(health_.sigma(i)) * std::sqrt(double(sensors_of(p)) / sensors);
        levels_[p][i / 16].freeze[i % 16] = static_cast<float>(rest_.freeze_level(sigma, settings.period));
        levels_[p][i / 16].touch[i % 16] = static_cast<float>(gate.opens_at()) / per_step_[p];
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
  /// The noise of each cell that there is room for.
  [[nodiscard]] static std::vector<SensorNoise> with_room(std::vector<SensorNoise> noise) {
    noise.resize(cells);
    return noise;
  }
  /// Masks and trust go in steps of 1/256, so that readings stay whole.
  static SKINCTL_INLINE float quantised(float share) noexcept {
    return static_cast<float>(static_cast<std::int32_t>(share * 256.0f + 0.5f)) * (1.0f / 256);
  }
  /// Force sensors of all pressures, and of the `p`-th.
  static constexpr double sensors = std::popcount(Table::pressed_readings);
  [[nodiscard]] int sensors_of(std::size_t p) const noexcept {
    return std::popcount(Kind::channels[pressure_[p]].readings);
  }
  /// Counts of what is seen at its greatest amount.
  [[nodiscard]] float counts_seen() const noexcept {
    return static_cast<float>(Kind::channels[seen_].greatest / Table::step(seen_));
  }
  /// What cell `i` reads above its rest level [steps]: in its `p`-th pressure, in all.
  [[nodiscard]] static SKINCTL_INLINE float above(const Memory& m, std::size_t p, std::size_t i) noexcept {
    const float x = m.now[p][i / 16][i % 16] - m.rest[p][i / 16].whole[i % 16];
    return x > 0 ? x : 0;
  }
  [[nodiscard]] static SKINCTL_INLINE float above(const Memory& m, std::size_t i) noexcept {
    float sum = above(m, 0, i);
    for (std::size_t p = 1; p < pressures; ++p) sum += above(m, p, i);
    return sum;
  }
  /// Takes what a sample of cell `i` reads.
  SKINCTL_INLINE void note(Memory& m, std::size_t i, const SampleOf<Kind>& s) const noexcept {
    const PerChannel<Kind, float> amount = this->amounts(i, s);
    float force = 0, proximity = 0;
    for (std::size_t p = 0; p < pressures; ++p) {
      const float steps = amount[pressure_[p]] * steps_per_[p];
      force = p == 0 ? steps : force + steps;
      m.now[p][i / 16][i % 16] = steps;
    }
    if constexpr (Table::sees)
      proximity = amount[seen_] * static_cast<float>(1 / Kind::channels[seen_].greatest);
    // Of a cell that speaks for the first time, or again, nothing is known of what it read before.
    const bool anew = !m.health.record[i].known || m.health.row[i / 16].gap[i % 16] > 0.5f;
    for (std::size_t p = 0; anew && p < pressures; ++p) m.last[p][i / 16][i % 16] = m.now[p][i / 16][i % 16];
    for (std::size_t k = 0; k < cones; ++k)
      m.shear[k][i / 16][i % 16] = amount[cone_[k]] * static_cast<float>(1 / Table::step(cone_[k]));
    health_.take(m.health, i, s, force, proximity);
    if (anew && above(m, i) <= levels_[0][i / 16].freeze[i % 16])
      for (std::size_t k = 0; k < cones; ++k) m.shear_rest[k][i / 16][i % 16] = m.shear[k][i / 16][i % 16];
  }
  [[nodiscard]] bool is_due(const Memory& m, Nanoseconds now) const noexcept {
    return now < m.health.time || now - m.health.time >= s_.period / 2;
  }

  /// Ends a frame: rest levels, statistics, faults.
  SKINCTL_NOINLINE void frame(Memory& m, Nanoseconds now) const noexcept {
    follow(m, now);
    health_.scan(m.health, now, [&](std::size_t i) { return witness(m, i); }, s_.find_faults, size());
    m.last = m.now;
    if (!s_.find_faults) return;
    const auto force = [&](std::size_t i) { return talk_unit_ * above(m, i); };
    const auto sigma = [&](std::size_t i) { return talk_unit_ * health_.sigma(i); };
    Cross::note(m.cross, now, force, sigma);
    const std::size_t found = Cross::look(
        m.cross, sigma,
        [&](std::size_t i) {
          return static_cast<float>(s_.proximity && m.health.row[i / 16].proximity[i % 16] < 0.05f
                                        ? s_.explained_far
                                        : s_.explained);
        },
        [&](std::size_t i, std::size_t j) {
          return Health::mask(m.health, j) < 0.5f && apart(cell_[i], cell_[j]);
        });
    if (found < cells) health_.hold(m.health, found, CellFault::cross_talk);
  }
  /// Moves the rest levels to `now`.
  void follow(Memory& m, Nanoseconds now) const noexcept {
    if (!s_.follow_rest || !(now > m.health.time)) return;
    const auto step = rest_.step<float>(now - m.health.time);
    // A median takes its time: one patch a frame, each ten times a second.
    if (m.median_at == Nanoseconds::min() || now >= m.median_at) {
      const std::size_t k = m.median_of;
      for (std::size_t p = 0; p < pressures; ++p)
        m.median[p][k] = patch_median(m.rest[p].data(), first_[k], first_[k + 1] - first_[k]);
      if (++m.median_of + 1u >= first_.size()) m.median_of = 0, m.median_at = now + 100ms;
    }
    const float rested = static_cast<float>(-std::expm1(-seconds<double>(now - m.health.time) / 2));
    for (std::size_t b = 0; 16 * b < size(); ++b) {
      for (std::size_t p = 0; p < pressures; ++p) follow_row(m, p, b, step);
      // Shear has no rest level of its own while a pressure may hold it.
      for (std::size_t k = 0; k < cones; ++k)
        for (std::size_t i = 0; i < 16; ++i) {
          bool frozen = false;
          for (std::size_t p = 0; p < pressures; ++p) frozen = frozen || m.rest[p][b].frozen[i] != 0;
          if (!frozen) m.shear_rest[k][b][i] += rested * (m.shear[k][b][i] - m.shear_rest[k][b][i]);
        }
    }
  }
  void follow_row(Memory& m, std::size_t p, std::size_t b,
                  const RestLevel::Step<float>& step) const noexcept {
    using L = Lane<float>;
    const HealthRow& row = m.health.row[b];
    Row median, evidence;
    if (row_patch_[b] < patches) {
      median.fill(m.median[p][row_patch_[b]]);
    } else {
      for (std::size_t k = 0; k < 16; ++k)
        median[k] = 16 * b + k < size() ? m.median[p][cell_[16 * b + k].patch] : 0.0f;
    }
    for (std::size_t k = 0; k < 16; k += L::lanes) {
      L sum = median_evidence(L::load(m.rest[p][b].above + k), L::load(median.data() + k));
      if (s_.proximity) sum += proximity_evidence(L::load(row.proximity.data() + k));
      sum.store(evidence.data() + k);
    }
    RestLevel::scan(m.rest[p][b], m.last[p][b].data(), m.now[p][b].data(), evidence.data(), levels_[p][b],
                    step);
  }

  /// What others say of cell `i`.
  [[nodiscard]] typename Health::Witness witness(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& own = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const float within = seconds<float>(2 * s_.health.witnessed_within + s_.period);
    const float seen = seconds<float>(s_.seen_for), force = above(m, i);
    typename Health::Witness w;
    if (s_.proximity) {
      w.moved = own.still_proximity[k] < within;
      w.seen = own.seen[k] >= seen && own.proximity[k] > 0.1f;
    }
    for (const std::size_t n : near(i)) {
      if (!counts(m, n)) continue;
      const HealthRow& row = m.health.row[n / 16];
      const std::size_t l = n % 16;
      const float other = above(m, n);
      w.moved = w.moved || row.still[l] < within || (s_.proximity && row.still_proximity[l] < within);
      w.touched =
          w.touched || (other > 6 * health_.sigma(n) && other >= static_cast<float>(s_.answer) * force &&
                        !Health::in_doubt(m.health, n));
      w.seen = w.seen || (s_.proximity && row.seen[l] >= seen &&
                          row.proximity[l] > static_cast<float>(s_.other_proximity));
    }
    w.touched = w.touched || w.seen;
    return w;
  }

  /// Whether cell `i` is in a hole: see `Coverage`.
  [[nodiscard]] bool in_hole(const Memory& m, std::size_t i) const noexcept {
    return within_.size() > 0 && is_hole(within_, i, [&](std::size_t j) { return counts(m, j); });
  }
  [[nodiscard]] SKINCTL_INLINE bool has_lone(std::size_t i) const noexcept {
    return ((lone_[i / 16] >> (i % 16)) & 1u) != 0;
  }
  TrustSettings s_;
  std::vector<TrustCell<Kind>> cell_;
  FillIn fill_;
  CellGraph within_;  ///< cells within reach of each other; of no cell: holes are not looked for
  Health health_;
  RestLevel rest_;
  std::array<std::vector<RestLevelsRow>, pressures> levels_;
  std::vector<std::size_t> row_patch_;             ///< the patch of all cells of a row; `patches`: of several
  std::vector<bool> masked_;                       ///< a cell of a row is, for good
  std::vector<std::uint16_t> lone_;                ///< cells with a lone force that is a limit
  std::vector<std::size_t> first_;                 ///< cell of each patch
  std::array<std::size_t, pressures> pressure_{};  ///< channel of each pressure
  std::array<std::size_t, cones> cone_{};          ///< and of each cone
  std::size_t seen_ = 0;                           ///< the channel that sees
  std::array<float, pressures> per_step_{},
      steps_per_{};  ///< counts in a step, steps in a unit of the pressure
  float talk_unit_;  ///< units of cross-talk's products in a step: readings are below its `most`
  std::array<float, pressures> low_force_ = [] {
    std::array<float, pressures> all{};
    all.fill(1e9f);
    return all;
  }();  ///< below these no cell counts [steps]
  float low_proximity_ = 1e9f;  ///< proximity below which no cell counts, 0 to 1
};

}  // namespace detail
SKINCTL_END_NAMESPACE
