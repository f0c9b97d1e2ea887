// What a reading of a trusted skin is worth.
#pragma once

#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/tactile/detail/trust_frames.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// See `TrustedSkin`.
template <class S>
class TrustCore : public TrustFrames<S> {
  using Frames = TrustFrames<S>;

 public:
  using Frames::cells, Frames::patches, Frames::rows;
  using typename Frames::Cross, typename Frames::Health, typename Frames::Memory, typename Frames::T,
      typename Frames::Touch;
  using TrustFrames<S>::TrustFrames;
  using Frames::size;

 protected:
  using Frames::above, Frames::cell_, Frames::counts, Frames::fill_, Frames::has_lone, Frames::health_,
      Frames::low_force_, Frames::low_proximity_, Frames::masked_, Frames::near, Frames::per_step_,
      Frames::quantised, Frames::s_, Frames::talk_unit_, Frames::witness;

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

  /// What cells would read after the gates, from those around them, in counts: force and proximity. What these count
  /// without a witness is not passed on: it would be more than their lone force. What is found of a cell is kept for the
  /// others that it is around of.
  class Filled {
   public:
    using Values = std::array<float, 2>;
    SKINCTL_INLINE Filled(const TrustCore& t, const Memory& m) noexcept : t_(t), m_(m) {}
    [[nodiscard]] Values operator()(std::size_t i) noexcept {
      const auto counts = [this](std::size_t n) { return (state(n) & counted) != 0; };
      const auto readings = [this](std::size_t n) {
        const CellCounts c = t_.wrapped().held(m_, n);
        const float trust = t_.has_lone(n) ? t_.quantised(m_.health.row[n / 16].trust[n % 16]) : 1.0f;
        return Values{trust * static_cast<float>(c.force), trust * static_cast<float>(c.proximity)};
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
      bool whole = m.hears_all_from(16 * b, 16 * b + 16 < size() ? 16 : size() - 16 * b);
      using L = Lane<float>;
      for (std::size_t k = 0; k < 16; k += L::lanes)
        whole = whole && !any(L::load(m.health.row[b].mask.data() + k) > L(0.0f));
      whole = whole && !masked_[b];
      if (whole) continue;
      for (std::size_t k = 0; k < 16 && 16 * b + k < size(); ++k) {
        const double share = share_filled(m, 16 * b + k);
        if (share > 0) f(16 * b + k, share);
      }
    }
  }

 private:
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

  [[nodiscard]] SKINCTL_INLINE bool is_trusted(const Memory& m, std::size_t i) const noexcept {
    return m.health.row[i / 16].trust[i % 16] > 0.5f || !has_lone(i);
  }
  /// The reading that leaves what is held as it is. A cell that is not trusted changes within the interval, by
  /// `settle`: the impulse of a sample that came late would be more than its lone force.
  [[nodiscard]] CellCounts as_held(const Memory& m, std::size_t i) const noexcept {
    const CellCounts c = this->wrapped().held(m, i);
    if (c == CellCounts{}) return c;
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
    for (std::size_t b = 0; 16 * b < size(); ++b) {
      HealthRow& row = m.health.row[b];
      std::uint32_t active = m.pushing[b];
      using L = Lane<float>;
      for (std::size_t k = 0; k < 16; k += L::lanes) {
        const auto on = (L::load(row.force.data() + k) - L::load(m.rest[b].whole + k) > L(low_force_)) |
                        (L::load(row.proximity.data() + k) > L(low_proximity_));
        if (!any(on)) continue;
        for (std::size_t lane = 0; lane < L::lanes; ++lane) active |= on[lane] ? 1u << (k + lane) : 0u;
      }
      m.pushing[b] = static_cast<std::uint16_t>(active);
      for (std::uint32_t rest = active; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t i = 16 * b + k;
        if (i >= size()) break;
        if (Health::in_doubt(m.health, i)) {
          row.trust[k] = 0;
          if (s_.find_faults && has_lone(i) && Health::stands(m.health, i))
            health_.hold(m.health, i, CellFault::stuck);
        } else if (witness(m, i).touched) {
          row.trust[k] = 1;
        }
        all += alone(m, i);
      }
    }
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
        const CellCounts c = worth(m, i);
        revise(i, c);
        const auto bit = static_cast<std::uint16_t>(1u << k);
        m.pushing[b] =
            static_cast<std::uint16_t>(c == CellCounts{} ? m.pushing[b] & ~bit : m.pushing[b] | bit);
        if (row.still[k] < 0.02f) Cross::follow(m.cross, i, talk_unit_ * above(m, i));
      }
    }
    m.filled = {};
    Filled filled(*this, m);
    each_filled(m, [&](std::size_t i, double share) {
      const TrustCell& c = cell_[i];
      const typename Filled::Values both = filled(i);
      const double force = share * c.force_gain * CellCounts::force_unit * double(both[0]);
      const double proximity = share * c.proximity_gain * CellCounts::proximity_unit * double(both[1]);
      const std::size_t slot = Touch::Wrenches::slot(c.link);
      T *f = m.filled.force.data[slot], *p = m.filled.proximity.data[slot];
      for (std::size_t r = 0; r < 6; ++r)
        f[r] = f[r] + T(force) * T(c.unit[r]), p[r] = p[r] + T(proximity) * T(c.unit[r]);
    });
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
