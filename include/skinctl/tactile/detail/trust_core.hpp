// SPDX-License-Identifier: BSD-3-Clause
// What a reading of a trusted skin is worth.
#pragma once

#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/tactile/detail/held_wrenches.hpp"
#include "skinctl/tactile/detail/trust_frames.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The base of `TrustedSkin`: what the readings of its cells count.
template <class S>
class TrustCore : public TrustFrames<S> {
  using Frames = TrustFrames<S>;

 public:
  using Frames::cells, Frames::pressures, Frames::cones, Frames::size;
  using Frames::TrustFrames;
  using typename Frames::Cross, typename Frames::Health, typename Frames::Kind, typename Frames::Life,
      typename Frames::Memory, typename Frames::T, typename Frames::Table, typename Frames::Touch;
  using Counts = typename S::Counts;
  using Raw = PerChannel<Kind, std::uint16_t>;

 protected:
  using Frames::above, Frames::cell_, Frames::cone_, Frames::counts, Frames::counts_seen, Frames::fill_,
      Frames::has_lone, Frames::pressure_, Frames::quantised, Frames::s_, Frames::seen_;

  /// The front end of one call.
  struct Front {
    const TrustCore& t;
    Memory& m;
    Nanoseconds to;

    SKINCTL_INLINE Counts reading(std::size_t i, const SampleOf<Kind>& s) const noexcept {
      if (Health::spoke(m.health, i) && t.is_due(m, m.newest)) t.frame(m, m.newest);
      t.note(m, i, s);
      const Nanoseconds time = s.time < to ? s.time : to;
      m.newest = time > m.newest ? time : m.newest;
      return counts_of<Kind>(t.is_trusted(m, i) ? t.worth(m, i) : t.as_held(m, i));
    }
    template <class Revise>
    SKINCTL_INLINE void settle(const Revise& revise) const noexcept {
      if (t.is_due(m, to)) t.frame(m, to);
      t.settle(m, revise);
    }
  };

  /// The readings after the gates that fill in cells, from the cells around them, in counts of each channel.
  /// Counts that these have without a witness are not passed on: they would be more than their lone force.
  /// Results for a cell are kept for the others that have it around them.
  class Filled {
   public:
    using Values = PerChannel<Kind, float>;
    SKINCTL_INLINE Filled(const TrustCore& t, const Memory& m) noexcept : t_(t), m_(m) {}
    [[nodiscard]] Values operator()(std::size_t i) noexcept {
      const auto counts = [this](std::size_t n) { return (state(n) & counted) != 0; };
      const auto readings = [this](std::size_t n) {
        const Raw held = raw_of<Kind>(t_.wrapped().held(m_, n));
        const float trust = t_.has_lone(n) ? t_.quantised(m_.health.row[n / 16].trust[n % 16]) : 1.0f;
        Values out;
        for (std::size_t c = 0; c < out.size(); ++c)
          out[c] = trust * static_cast<float>(number_of<Kind>(c, held[c]));
        return out;
      };
      return t_.fill_.filled_with(i, counts, [&](std::size_t n) {
        if ((state(n) & read) == 0) value_.data[n] = t_.fill_.read_as(n, readings, counts), state_[n] |= read;
        return value_.data[n];
      });
    }

   private:
    static constexpr std::uint8_t judged = 1, counted = 2, read = 4;
    [[nodiscard]] SKINCTL_INLINE std::uint8_t state(std::size_t n) noexcept {
      if (state_[n] == 0) state_[n] = static_cast<std::uint8_t>(judged | (t_.counts(m_, n) ? counted : 0));
      return state_[n];
    }
    const TrustCore& t_;
    const Memory& m_;
    std::array<std::uint8_t, cells> state_{};
    Unwritten<Values, cells> value_;
  };
  /// How much of cell `i` is filled in, 0 to 1.
  [[nodiscard]] double share_filled(const Memory& m, std::size_t i) const noexcept {
    const bool heard = m.hears(i) && !cell_[i].masked;
    return heard ? double(quantised(Health::mask(m.health, i))) : 1.0;
  }
  /// Calls `f(i, share)` for the cells that are filled in, wholly or in part: masked or silent ones.
  template <class F>
  void each_filled(const Memory& m, const F& f) const noexcept {
    for (std::size_t b = 0; 16 * b < size(); ++b) {
      const std::size_t in_row = size() - 16 * b < 16 ? size() - 16 * b : 16;
      bool whole = m.heard_from(16 * b, in_row) == in_row;
      using L = Lane<float>;
      for (std::size_t k = 0; k < 16; k += L::lanes)
        whole = whole && !any(L::load(m.health.row[b].mask.data() + k) > L(0.0f));
      whole = whole && !this->masked_[b];
      if (whole) continue;
      for (std::size_t k = 0; k < in_row; ++k) {
        const double share = share_filled(m, 16 * b + k);
        if (share > 0) f(16 * b + k, share);
      }
    }
  }

  /// The pushes of cell `i` as far as it is filled in, one a channel [N]: shear within the cone of its
  /// pressure.
  [[nodiscard]] PerChannel<Kind, T> pushes_filled(std::size_t i, double share,
                                                  const PerChannel<Kind, float>& filled) const noexcept {
    PerChannel<Kind, double> push;
    double pressure = 0, square = 0;
    for (std::size_t c = 0; c < push.size(); ++c) {
      push[c] = share * cell_[i].gain[c] * Table::step(c) * double(filled[c]);
      const double per_friction = Table::has_cone(c) ? 1 / Kind::channels[c].cone.friction : 0;
      pressure += Table::is_pressure(c) ? push[c] : 0;
      square += (per_friction * push[c]) * (per_friction * push[c]);
    }
    const double within = square > pressure * pressure ? pressure / std::sqrt(square) : 1;
    PerChannel<Kind, T> out;
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = T(Table::has_cone(c) ? within * push[c] : push[c]);
    return out;
  }
  [[nodiscard]] static T pressure_of(const PerChannel<Kind, T>& push) noexcept {
    T sum(0);
    for (std::size_t c = 0; c < push.size(); ++c)
      if (Table::is_pressure(c)) sum = sum + push[c];
    return sum;
  }

 private:
  static constexpr float witnessed_before = 0.5f;  ///< trust of a cell that lost its witness 50 ms ago
  /// The counts of the newest sample of cell `i` that count: above its rest level, less its mask, and at most
  /// its share of the lone force as far as it is not witnessed.
  [[nodiscard]] Raw worth(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& row = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const float left = cell_[i].masked ? 0 : 1 - quantised(row.mask[k]);
    PerChannel<Kind, std::int32_t> n{};
    const auto cut = [](float x) { return static_cast<std::int32_t>(x < 65535.0f ? x : 65535.0f); };
    for (std::size_t p = 0; p < pressures; ++p)
      n[pressure_[p]] = cut(above(m, p, i) * this->per_step_[p] + 0.5f);
    if constexpr (Table::sees)
      n[seen_] = cut(row.proximity[k] > 0 ? row.proximity[k] * counts_seen() + 0.5f : 0.5f);
    for (std::size_t s = 0; s < cones; ++s) {
      const float x = m.shear[s][i / 16][k] - m.shear_rest[s][i / 16][k];
      n[cone_[s]] = static_cast<std::int32_t>(x > 32767.0f ? 32767.0f : x > -32767.0f ? x : -32767.0f);
    }
    if (left < 1)
      for (std::int32_t& x : n) x = static_cast<std::int32_t>(left * static_cast<float>(x));
    const float trust = quantised(row.trust[k]);
    if (trust < 1) {
      const TrustCell<Kind>& c = cell_[i];
      const PerChannel<Kind, std::int32_t> passed = passed_of(c, n);
      const double push = push_of(c, passed);
      if (const double most = std::min(push, c.lone) * double(m.lone_share); push > most) {
        const double share = double(trust) + (1 - double(trust)) * most / push;
        for (std::size_t a = 0; a < n.size(); ++a)
          n[a] = Table::has_cone(a) ? static_cast<std::int32_t>(share * n[a])
                                    : static_cast<std::int32_t>(share * passed[a]) +
                                          (passed[a] > 0 ? c.gate[a].subtract() : 0);
      }
    }
    Raw out;
    for (std::size_t a = 0; a < n.size(); ++a) out[a] = static_cast<std::uint16_t>(n[a]);
    return out;
  }
  /// The counts that pass gates that are open, of channels without a cone; 0 for the others.
  [[nodiscard]] static PerChannel<Kind, std::int32_t> passed_of(
      const TrustCell<Kind>& c, const PerChannel<Kind, std::int32_t>& n) noexcept {
    PerChannel<Kind, std::int32_t> out{};
    for (std::size_t a = 0; a < n.size(); ++a) out[a] = Table::has_cone(a) ? 0 : c.gate[a].pass(n[a], true);
    return out;
  }

  [[nodiscard]] SKINCTL_INLINE bool is_trusted(const Memory& m, std::size_t i) const noexcept {
    return !has_lone(i) || (m.health.row[i / 16].trust[i % 16] > 0.5f && Life::in(m.life.lives, i));
  }
  /// The reading that leaves what is held as it is. A cell that is not trusted changes within the interval,
  /// by `settle`: the impulse of a sample that came late would be more than its lone force.
  [[nodiscard]] Raw as_held(const Memory& m, std::size_t i) const noexcept {
    Raw raw = raw_of<Kind>(this->wrapped().held(m, i));
    for (std::size_t c = 0; c < raw.size(); ++c) {
      const std::int32_t held = number_of<Kind>(c, raw[c]), off = cell_[i].gate[c].subtract();
      raw[c] = static_cast<std::uint16_t>(held > 0 ? held + off : held < 0 ? held - off : 0);
    }
    return raw;
  }

  /// The push of the counts that passed [N], without shear, which comes with it.
  [[nodiscard]] static SKINCTL_INLINE double push_of(const TrustCell<Kind>& c,
                                                     const PerChannel<Kind, std::int32_t>& passed) noexcept {
    double sum = 0;
    for (std::size_t a = 0; a < passed.size(); ++a) sum += Table::step(a) * c.gain[a] * passed[a];
    return sum;
  }
  /// The push of cell `i` as far as nobody witnesses it, as a share of its lone force, up to 1.
  [[nodiscard]] double alone(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& row = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const TrustCell<Kind>& c = cell_[i];
    if (!has_lone(i) || !(row.trust[k] < 1) || !(c.lone > 0) || c.masked) return 0;
    return (1 - double(quantised(row.trust[k]))) * std::min(push(m, i) / c.lone, 1.0);
  }
  /// The push of cell `i`, less its mask, as if it were fully trusted [N].
  [[nodiscard]] double push(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& row = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const auto left = double(1 - quantised(row.mask[k]));
    const auto raw = [&](float x) {
      return static_cast<std::int32_t>(left * std::min(double(x) + 0.5, 65535.0));
    };
    PerChannel<Kind, std::int32_t> n{};
    for (std::size_t p = 0; p < pressures; ++p) n[pressure_[p]] = raw(above(m, p, i) * this->per_step_[p]);
    if constexpr (Table::sees) n[seen_] = raw(row.proximity[k] > 0 ? row.proximity[k] * counts_seen() : 0.0f);
    return push_of(cell_[i], passed_of(cell_[i], n));
  }
  /// Finds the cells that may push.
  void find_pushing(Memory& m) const noexcept {
    for (std::size_t b = 0; b < Frames::rows && 16 * b < size(); ++b) {
      const HealthRow& row = m.health.row[b];
      std::uint32_t active = m.pushing[b];
      using L = Lane<float>;
      for (std::size_t k = 0; k < 16; k += L::lanes) {
        auto on = L::load(row.proximity.data() + k) > L(this->low_proximity_);
        for (std::size_t p = 0; p < pressures; ++p)
          on = on |
               (L::load(m.now[p][b].data() + k) - L::load(m.rest[p][b].whole + k) > L(this->low_force_[p]));
        if (!any(on)) continue;
        for (std::size_t lane = 0; lane < L::lanes; ++lane) active |= on[lane] ? 1u << (k + lane) : 0u;
      }
      if (size() - 16 * b < 16) active &= (1u << (size() - 16 * b)) - 1;
      m.pushing[b] = static_cast<std::uint16_t>(active);
    }
  }
  /// Says how far cells are trusted, and shares one lone force among those that are not: as many as there are
  /// give a joint no more than one alone may. A cell that lives is still the body that was witnessed. A cell
  /// that is pressed and shows no life counts the less, the farther its place has given way; all these
  /// together at most `LifeSettings::force`, less their damping.
  void trust(Memory& m) const noexcept {
    find_pushing(m);
    typename Life::Bits lifeless{};
    double without_life = 0;
    Life::each(m.pushing, [&](std::size_t i) {
      float& trust = m.health.row[i / 16].trust[i % 16];
      const bool goes_on = trust > witnessed_before && Life::in(m.life.lives, i);
      if (!has_lone(i) || !(goes_on || this->witness(m, i).touched)) return;
      const bool lives = Life::in(m.life.lives, i) || !(above(m, i) > 0);
      const double push = lives ? 0 : this->push(m, i);
      const double rim = Life::in(m.life.rim_lives, i) ? s_.life.rim_force : 0;
      trust = lives || push <= rim ? 1.0f : this->life_.share(m.life, i);
      if (lives || push <= rim) return Life::forgive(m.life, i);
      Life::set(lifeless, i, true);
      without_life += double(trust) * push;
    });
    const double most = s_.life.force, counted = std::min(without_life, most);
    const auto limited = static_cast<float>(without_life > most ? most / without_life : 1.0);
    Life::each(lifeless, [&](std::size_t i) {
      float& trust = m.health.row[i / 16].trust[i % 16];
      trust *= limited * this->life_.braked(m.life, i, static_cast<float>(counted));
      if (!Life::in(m.life.rim_lives, i)) return;
      const auto rim = static_cast<float>(s_.life.rim_force / push(m, i));  // of a push beyond it: below 1
      trust = trust > rim ? trust : rim;
    });
    double all = 0;
    Life::each(m.pushing, [&](std::size_t i) { all += alone(m, i); });
    m.lone_share = all > 1 ? static_cast<float>((1 - 1e-6) / all) : 1.0f;
  }

  template <class Revise>
  void settle(Memory& m, const Revise& revise) const noexcept {
    trust(m);
    for (std::size_t b = 0; 16 * b < size(); ++b) {
      const HealthRow& row = m.health.row[b];
      for (std::uint32_t rest = m.pushing[b]; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t i = 16 * b + k;
        if (i >= size()) break;
        const Raw c = worth(m, i);
        revise(i, counts_of<Kind>(c));
        const auto bit = static_cast<std::uint16_t>(1u << k);
        m.pushing[b] = static_cast<std::uint16_t>(c == Raw{} ? m.pushing[b] & ~bit : m.pushing[b] | bit);
        if (row.still[k] < 0.02f) Cross::follow(m.cross, i, this->talk_unit_ * above(m, i));
      }
    }
    m.filled = {};
    Filled filled(*this, m);
    each_filled(m, [&](std::size_t i, double share) {
      add_pushes(this->tables_, i, pushes_filled(i, share, filled(i)), m.filled);
    });
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
