// What a trusted skin does with its cells: frames of rest levels and health, witnesses, what a reading is worth.
#pragma once

#include <algorithm>
#include <bit>

#include "skinctl/sensing/detail/cross_talk.hpp"
#include "skinctl/sensing/evidence.hpp"
#include "skinctl/tactile/detail/room.hpp"
#include "skinctl/tactile/detail/trust_cells.hpp"
#include "skinctl/tactile/fill_in.hpp"
#include "skinctl/tactile/skin_settings.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// See `TrustedSkin`.
template <class S>
class TrustCore {
 public:
  using T = typename S::scalar;
  using Touch = typename S::Touch;
  /// Room for so many, if their number is known at run time only.
  static constexpr std::size_t patches = most_patches_of<S>, cells = most_cells_of<S>;
  using Health = CellHealth<cells>;
  using Cross = CrossTalk<cells>;
  static constexpr std::size_t rows = Health::rows;

  /// Trivially copyable; only the skin reads and writes its members.
  struct Memory {
    typename S::Memory skin;
    typename Health::Memory health;
    std::array<RestRow, rows> rest{};
    typename Cross::Memory cross;
    std::array<std::uint16_t, rows> pushing{};  ///< cells that count for something
    std::array<float, patches>
        median{};  ///< of what the cells of a patch read above their rest levels [steps]
    Nanoseconds median_at = Nanoseconds::min();
    Nanoseconds newest = Nanoseconds::min();  ///< stamp of a sample
    float lone_share = 1;                     ///< of its lone force that each cell without witness has
    Touch filled{};                           ///< wrenches of the cells that are filled in
    friend bool operator==(const Memory& a, const Memory& b) noexcept {
      const auto bits = [](const auto& x) {
        return std::bit_cast<std::array<std::uint32_t, sizeof(x) / 4>>(x);
      };
      return a.skin == b.skin && a.health == b.health && bits(a.rest) == bits(b.rest) && a.cross == b.cross &&
             a.pushing == b.pushing && bits(a.median) == bits(b.median) && a.median_at == b.median_at &&
             a.newest == b.newest && a.lone_share == b.lone_share && a.filled == b.filled;
    }
  };

  SKINCTL_COLD TrustCore(const S& skin, const TrustSettings& settings, const FillIn& fill,
                         std::vector<TrustCell> cell)
      : skin_(skin),
        s_(settings),
        fill_(fill),
        health_(settings.health, settings.noise.size() == 1 ? settings.noise : with_room(settings.noise)),
        rest_(settings.rest),
        cell_(std::move(cell)),
        levels_(rows),
        masked_(rows),
        per_step_(static_cast<float>(settings.health.step / CellCounts::force_unit)),
        talk_unit_(std::min(1.0f, static_cast<float>(Cross::most * settings.health.step / 3))) {
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
    }
    first_.push_back(size());
  }

 protected:
  /// The front end of one call.
  struct Front {
    const TrustCore& t;
    Memory& m;
    Nanoseconds to;

    SKINCTL_INLINE CellCounts reading(std::size_t i, const CellSample& s) const noexcept {
      if (Health::spoke(m.health, i) && t.is_due(m, m.newest)) t.frame(m, m.newest);
      t.health_.take(m.health, i, s);
      const Nanoseconds time = s.time < to ? s.time : to;
      m.newest = time > m.newest ? time : m.newest;
      return t.is_trusted(m, i) ? t.worth(m, i) : t.as_held(m, i);
    }
    template <class Revise>
    SKINCTL_INLINE void settle(const Revise& revise) const noexcept {
      if (t.is_due(m, to)) t.frame(m, to);
      t.settle(m, revise);
    }
  };

  [[nodiscard]] std::size_t size() const noexcept { return cell_.size(); }
  [[nodiscard]] auto near(std::size_t i) const noexcept { return fill_.graph().neighbours(i); }
  [[nodiscard]] bool counts(const Memory& m, std::size_t i) const noexcept {
    return m.skin.hears(i) && Health::mask(m.health, i) < 0.5f && !cell_[i].masked;
  }
  /// What cell `i` would read after the gates, from its neighbours, in counts. What they count without a witness is
  /// not passed on: it would be more than their lone force.
  template <bool Force>
  [[nodiscard]] double filled(const Memory& m, std::size_t i) const noexcept {
    return fill_.filled(
        i,
        [&](std::size_t n) {
          const CellCounts c = skin_.held(m.skin, n);
          return (has_lone(n) ? double(quantised(m.health.row[n / 16].trust[n % 16])) : 1.0) *
                 static_cast<double>(Force ? c.force : c.proximity);
        },
        [&](std::size_t n) { return counts(m, n); });
  }
  /// How much of cell `i` is filled in, 0 to 1.
  [[nodiscard]] double share_filled(const Memory& m, std::size_t i) const noexcept {
    const bool heard = m.skin.hears(i) && !cell_[i].masked;
    return heard ? double(quantised(Health::mask(m.health, i))) : 1.0;
  }
  /// Calls `f(i, share)` for the cells that are filled in, wholly or in part: masked or silent ones.
  template <class F>
  void each_filled(const Memory& m, const F& f) const noexcept {
    for (std::size_t b = 0; 16 * b < size(); ++b) {
      bool whole = m.skin.hears_all_from(16 * b, 16 * b + 16 < size() ? 16 : size() - 16 * b);
      for (const float x : m.health.row[b].mask) whole = whole && !(x > 0);
      whole = whole && !masked_[b];
      if (whole) continue;
      for (std::size_t k = 0; k < 16 && 16 * b + k < size(); ++k) {
        const double share = share_filled(m, 16 * b + k);
        if (share > 0) f(16 * b + k, share);
      }
    }
  }

  S skin_;
  TrustSettings s_;
  FillIn fill_;
  Health health_;
  RestLevel rest_;
  std::vector<TrustCell> cell_;

 private:
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
    health_.scan(m.health, now, [&](std::size_t i) { return witness(m, i); }, s_.find_faults);
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
    if (m.median_at == Nanoseconds::min() || now >= m.median_at) {
      m.median_at = now + 100ms;
      for (std::size_t k = 0; k + 1 < first_.size(); ++k)
        m.median[k] = patch_median(m.rest.data(), first_[k], first_[k + 1] - first_[k]);
    }
    for (std::size_t b = 0; b < rows; ++b) {
      const HealthRow& row = m.health.row[b];
      HealthRow::Row evidence{};
      for (std::size_t k = 0; k < 16; ++k) {
        const std::size_t i = 16 * b + k;
        const float r = m.rest[b].above[k];
        if (s_.proximity) evidence[k] = proximity_evidence(row.proximity[k]);
        if (i < size()) evidence[k] += median_evidence(r, m.median[cell_[i].patch]);
      }
      RestLevel::scan(m.rest[b], row.last.data(), row.force.data(), evidence.data(), levels_[b], step);
    }
  }

  /// Whether a cell's force has stepped, with nothing seen before: nobody's witness, and in need of one itself.
  [[nodiscard]] SKINCTL_INLINE bool in_doubt(const HealthRow& row, std::size_t k) const noexcept {
    return row.doubt[k] > 0 &&
           !(s_.proximity && row.seen[k] >= seconds<float>(s_.seen_for) && row.proximity[k] > 0.1f);
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
      w.touched = w.touched || (other > 6 * health_.sigma(n) &&
                                other >= static_cast<float>(s_.answer) * force && !in_doubt(row, l));
      w.seen = w.seen || (s_.proximity && row.seen[l] >= seen &&
                          row.proximity[l] > static_cast<float>(s_.other_proximity));
    }
    w.touched = w.touched || w.seen;
    return w;
  }

  [[nodiscard]] SKINCTL_INLINE bool has_lone(std::size_t i) const noexcept {
    return cell_[i].lone < std::numeric_limits<double>::infinity();
  }
  /// What the newest sample of cell `i` counts: above its rest level, less its mask, and at most its part of the lone
  /// force as far as it is not witnessed.
  [[nodiscard]] CellCounts worth(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& row = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const float left = cell_[i].masked ? 0 : 1 - quantised(row.mask[k]);
    const float f = above(m, i) * per_step_ + 0.5f, p = row.proximity[k] * 65536.0f + 0.5f;
    std::int32_t force = static_cast<std::int32_t>(f < 65535.0f ? f : 65535.0f);
    std::int32_t proximity = static_cast<std::int32_t>(p < 65535.0f ? p : 65535.0f);
    if (left < 1) {
      force = static_cast<std::int32_t>(left * static_cast<float>(force));
      proximity = static_cast<std::int32_t>(left * static_cast<float>(proximity));
    }
    const float trust = quantised(row.trust[k]);
    if (trust < 1) {
      const TrustCell& c = cell_[i];
      const std::int32_t df = c.force_gate.pass(force, true), dp = c.proximity_gate.pass(proximity, true);
      const double push = push_of(c, df, dp);
      if (const double most = std::min(push, c.lone) * double(m.lone_share); push > most) {
        const double share = double(trust) + (1 - double(trust)) * most / push;
        force = static_cast<std::int32_t>(share * df) + (df > 0 ? c.force_gate.subtract() : 0);
        proximity = static_cast<std::int32_t>(share * dp) + (dp > 0 ? c.proximity_gate.subtract() : 0);
      }
    }
    return {static_cast<std::uint16_t>(force), static_cast<std::uint16_t>(proximity)};
  }

  [[nodiscard]] bool is_trusted(const Memory& m, std::size_t i) const noexcept {
    return m.health.row[i / 16].trust[i % 16] > 0.5f ||
           !(cell_[i].lone < std::numeric_limits<double>::infinity());
  }
  /// The reading that leaves what is held as it is. A cell that is not trusted changes within the interval, by
  /// `settle`: the impulse of a sample that came late would be more than its lone force.
  [[nodiscard]] CellCounts as_held(const Memory& m, std::size_t i) const noexcept {
    const CellCounts c = skin_.held(m.skin, i);
    const auto raw = [](std::int32_t held, const EventGate<std::int32_t>& gate) {
      return static_cast<std::uint16_t>(held > 0 ? held + gate.subtract() : 0);
    };
    return {raw(c.force, cell_[i].force_gate), raw(c.proximity, cell_[i].proximity_gate)};
  }

  [[nodiscard]] static SKINCTL_INLINE double push_of(const TrustCell& c, std::int32_t force,
                                                     std::int32_t proximity) noexcept {
    return CellCounts::force_unit * c.force_gain * force +
           CellCounts::proximity_unit * c.proximity_gain * proximity;
  }
  /// The push of cell `i` as far as nobody witnesses it, as a share of its lone force, up to 1.
  [[nodiscard]] double alone(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& row = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const TrustCell& c = cell_[i];
    if (!has_lone(i) || !(row.trust[k] < 1) || !(c.lone > 0) || c.masked) return 0;
    const auto left = double(1 - quantised(row.mask[k]));
    const auto raw = [&](float x) {
      return static_cast<std::int32_t>(left * std::min(double(x) + 0.5, 65535.0));
    };
    const double push = push_of(c, c.force_gate.pass(raw(above(m, i) * per_step_), true),
                                c.proximity_gate.pass(raw(row.proximity[k] * 65536.0f), true));
    return (1 - double(quantised(row.trust[k]))) * std::min(push / c.lone, 1.0);
  }
  /// Says which cells are trusted, and shares one lone force between those that are not: as many as there are give a
  /// joint no more than one alone may.
  void trust(Memory& m) const noexcept {
    double all = 0;
    for (std::size_t b = 0; b < rows; ++b) {
      HealthRow& row = m.health.row[b];
      std::uint32_t active = m.pushing[b];
      for (std::size_t k = 0; k < 16; ++k)
        active |= row.force[k] - m.rest[b].whole[k] > low_force_ || row.proximity[k] > low_proximity_
                      ? 1u << k
                      : 0u;
      m.pushing[b] = static_cast<std::uint16_t>(active);
      for (std::uint32_t rest = active; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t i = 16 * b + k;
        if (i >= size()) break;
        const typename Health::Witness w = witness(m, i);
        if (w.seen || (w.touched && !in_doubt(row, k))) {
          row.trust[k] = 1;
        } else if (in_doubt(row, k)) {
          row.trust[k] = 0;
        }
        all += alone(m, i);
      }
    }
    m.lone_share = all > 1 ? static_cast<float>((1 - 1e-6) / all) : 1.0f;
  }

  template <class Revise>
  void settle(Memory& m, const Revise& revise) const noexcept {
    trust(m);
    for (std::size_t b = 0; b < rows; ++b) {
      const HealthRow& row = m.health.row[b];
      for (std::uint32_t rest = m.pushing[b]; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t i = 16 * b + k;
        if (i >= size()) break;
        const CellCounts c = worth(m, i);
        revise(i, c);
        const auto bit = static_cast<std::uint16_t>(1u << k);
        m.pushing[b] =
            static_cast<std::uint16_t>(c == CellCounts{} ? m.pushing[b] & ~bit : m.pushing[b] | bit);
        if (row.still[k] < 0.02f) Cross::follow(m.cross, i, talk_unit_ * above(m, i));
      }
    }
    m.filled = {};
    each_filled(m, [&](std::size_t i, double share) {
      const TrustCell& c = cell_[i];
      const double force = share * c.force_gain * CellCounts::force_unit * filled<true>(m, i);
      const double proximity = share * c.proximity_gain * CellCounts::proximity_unit * filled<false>(m, i);
      const std::size_t slot = Touch::Wrenches::slot(c.link);
      T *f = m.filled.force.data[slot], *p = m.filled.proximity.data[slot];
      for (std::size_t r = 0; r < 6; ++r)
        f[r] = f[r] + T(force) * T(c.unit[r]), p[r] = p[r] + T(proximity) * T(c.unit[r]);
    });
  }

  std::vector<RestLevelsRow> levels_;
  std::vector<bool> masked_;        ///< a cell of a row is, for good
  std::vector<std::size_t> first_;  ///< cell of each patch
  float per_step_;                  ///< counts in a step
  float talk_unit_;  ///< units of cross-talk's products in a step: readings are below its `most`
  float low_force_ = 1e9f, low_proximity_ = 1e9f;  ///< below these no cell counts [steps], of 0 to 1
};

}  // namespace detail
SKINCTL_END_NAMESPACE
