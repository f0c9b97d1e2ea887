// What a trusted skin knows of its cells: frames of rest levels and faults, and witnesses.
#pragma once

#include <algorithm>
#include <bit>

#include "skinctl/sensing/detail/cross_talk.hpp"
#include "skinctl/sensing/evidence.hpp"
#include "skinctl/tactile/detail/trust_cells.hpp"
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
  /// Room for so many, if their number is known at run time only.
  static constexpr std::size_t patches = most_patches_of<S>, cells = most_cells_of<S>;
  using Health = CellHealth<cells>;
  using Cross = CrossTalk<cells>;
  static constexpr std::size_t rows = Health::rows;

  /// Trivially copyable; only the skin reads and writes its members.
  struct Memory : S::Memory {
    typename Health::Memory health;
    std::array<RestRow, rows> rest{};
    typename Cross::Memory cross;
    std::array<std::uint16_t, rows> pushing{};  ///< cells that count for something
    std::array<float, patches>
        median{};  ///< of what the cells of a patch read above their rest levels [steps]
    Nanoseconds median_at = Nanoseconds::min();
    std::uint32_t median_of = 0;              ///< the patch whose turn it is
    Nanoseconds newest = Nanoseconds::min();  ///< stamp of a sample
    float lone_share = 1;                     ///< of its lone force that each cell without witness has
    Touch filled{};                           ///< wrenches of the cells that are filled in
    friend bool operator==(const Memory& a, const Memory& b) noexcept {
      const auto bits = [](const auto& x) {
        return std::bit_cast<std::array<std::uint32_t, sizeof(x) / 4>>(x);
      };
      return static_cast<const typename S::Memory&>(a) == static_cast<const typename S::Memory&>(b) &&
             a.health == b.health && bits(a.rest) == bits(b.rest) && a.cross == b.cross &&
             a.pushing == b.pushing && bits(a.median) == bits(b.median) && a.median_at == b.median_at &&
             a.median_of == b.median_of && a.newest == b.newest && a.lone_share == b.lone_share &&
             a.filled == b.filled;
    }
  };

  SKINCTL_COLD TrustFrames(const S& skin, const TrustSettings& settings, const FillIn& fill,
                           std::vector<TrustCell> cell)
      : WrappedTouch<TrustedSkin<S>, S>(skin),
        s_(settings),
        fill_(fill),
        health_(settings.health, settings.noise.size() == 1 ? settings.noise : with_room(settings.noise)),
        rest_(settings.rest),
        cell_(std::move(cell)),
        levels_(rows),
        masked_(rows),
        lone_(rows),
        per_step_(static_cast<float>(settings.health.step / CellCounts::force_unit)),
        talk_unit_(std::min(1.0f, static_cast<float>(Cross::most * settings.health.step / 3))) {
    if (s_.reach < std::numeric_limits<double>::infinity()) within_ = cells_within(skin.places(), s_.reach);
    require(fill.graph().size() == size(), "TrustedSkin: cells of the graph", double(fill.graph().size()),
            "those of the skin");
    for (std::size_t i = 0; i < size(); ++i) {
      const double freeze = rest_.freeze_level(double(health_.sigma(i)), settings.period);
      levels_[i / 16].freeze[i % 16] = static_cast<float>(freeze);
      levels_[i / 16].touch[i % 16] = static_cast<float>(cell_[i].force_gate.opens_at()) / per_step_;
      low_force_ =
          std::min(low_force_, static_cast<float>(cell_[i].force_gate.closes_below()) / per_step_ - 1);
      low_proximity_ =
          std::min(low_proximity_, static_cast<float>(cell_[i].proximity_gate.closes_below() - 1) / 65536.0f);
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
  /// What cell `i` reads above its rest level [steps].
  [[nodiscard]] static SKINCTL_INLINE float above(const Memory& m, std::size_t i) noexcept {
    const float x = m.health.row[i / 16].force[i % 16] - m.rest[i / 16].whole[i % 16];
    return x > 0 ? x : 0;
  }
  [[nodiscard]] bool is_due(const Memory& m, Nanoseconds now) const noexcept {
    return now < m.health.time || now - m.health.time >= s_.period / 2;
  }

  /// Ends a frame: rest levels, statistics, faults.
  SKINCTL_NOINLINE void frame(Memory& m, Nanoseconds now) const noexcept {
    follow(m, now);
    health_.scan(m.health, now, [&](std::size_t i) { return witness(m, i); }, s_.find_faults, size());
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
      m.median[k] = patch_median(m.rest.data(), first_[k], first_[k + 1] - first_[k]);
      if (++m.median_of + 1u >= first_.size()) m.median_of = 0, m.median_at = now + 100ms;
    }
    using L = Lane<float>;
    for (std::size_t b = 0; 16 * b < size(); ++b) {
      const HealthRow& row = m.health.row[b];
      HealthRow::Row median, evidence;
      if (row_patch_[b] < patches) {
        median.fill(m.median[row_patch_[b]]);
      } else {
        for (std::size_t k = 0; k < 16; ++k)
          median[k] = 16 * b + k < size() ? m.median[cell_[16 * b + k].patch] : 0.0f;
      }
      for (std::size_t k = 0; k < 16; k += L::lanes) {
        L sum = median_evidence(L::load(m.rest[b].above + k), L::load(median.data() + k));
        if (s_.proximity) sum += proximity_evidence(L::load(row.proximity.data() + k));
        sum.store(evidence.data() + k);
      }
      RestLevel::scan(m.rest[b], row.last.data(), row.force.data(), evidence.data(), levels_[b], step);
    }
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
  FillIn fill_;
  CellGraph within_;  ///< cells within reach of each other; of no cell: holes are not looked for
  Health health_;
  RestLevel rest_;
  std::vector<TrustCell> cell_;
  std::vector<RestLevelsRow> levels_;
  std::vector<std::size_t> row_patch_;  ///< the patch of all cells of a row; `patches`: of several
  std::vector<bool> masked_;            ///< a cell of a row is, for good
  std::vector<std::uint16_t> lone_;     ///< cells with a lone force that is a limit
  std::vector<std::size_t> first_;      ///< cell of each patch
  float per_step_;                      ///< counts in a step
  float talk_unit_;  ///< units of cross-talk's products in a step: readings are below its `most`
  float low_force_ = 1e9f, low_proximity_ = 1e9f;  ///< below these no cell counts [steps], of 0 to 1
};

}  // namespace detail
SKINCTL_END_NAMESPACE
