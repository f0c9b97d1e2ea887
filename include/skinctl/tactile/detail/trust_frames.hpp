// SPDX-License-Identifier: BSD-3-Clause
// What a trusted skin knows of its cells: frames of rest levels, faults and life, and witnesses.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "skinctl/sensing/evidence.hpp"
#include "skinctl/tactile/detail/inward_way.hpp"
#include "skinctl/tactile/detail/trust_tables.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The cells of a `TrustedSkin`, frame by frame: rest levels, faults, life, and what they say of each other.
template <class S>
class TrustFrames : public TrustTables<S> {
  using Tables = TrustTables<S>;

 public:
  using Tables::patches, Tables::cells, Tables::rows, Tables::pressures, Tables::cones;
  using Tables::TrustTables;
  using typename Tables::T, typename Tables::Touch, typename Tables::Kind, typename Tables::Table,
      typename Tables::Memory, typename Tables::Health, typename Tables::Cross, typename Tables::Life,
      typename Tables::Row;

 protected:
  using Tables::above, Tables::counts, Tables::has_lone, Tables::near, Tables::size;
  using Tables::cell_, Tables::cone_, Tables::fill_, Tables::first_, Tables::health_, Tables::levels_,
      Tables::life_, Tables::opens_at_, Tables::pressed_from_, Tables::pressure_, Tables::rest_,
      Tables::row_patch_, Tables::s_, Tables::seen_, Tables::steps_per_, Tables::talk_unit_;

  /// Takes the readings of a sample of cell `i`.
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
    if (Life::is_due(m.life, now)) live(m, now);
    m.last = m.now;
    if (!s_.find_faults) return;
    const auto force = [&](std::size_t i) { return talk_unit_ * above(m, i); };
    const auto sigma = [&](std::size_t i) { return talk_unit_ * health_.sigma(i); };
    Cross::note(m.cross, now, force, sigma);
    const std::size_t found = Cross::look(
        m.cross, sigma,
        [&](std::size_t i) {
          return static_cast<float>(s_.proximity && m.health.row[i / 16].proximity[i % 16] < 0.05f
                                        ? s_.max_unexplained_far
                                        : s_.max_unexplained);
        },
        [&](std::size_t i, std::size_t j) {
          return Health::mask(m.health, j) < 0.5f && apart(cell_[i], cell_[j]);
        });
    if (found < cells) health_.hold(m.health, found, CellFault::cross_talk);
  }
  /// Looks for life in what is pressed, and masks what has been found to be quiet.
  void live(Memory& m, Nanoseconds now) const noexcept {
    using L = Lane<float>;
    typename Life::Bits pressed{};
    for (std::size_t b = 0; 16 * b < size(); ++b)
      for (std::size_t k = 0; k < 16; k += L::lanes) {
        const auto over = [&](std::size_t p) {
          return L::load(m.now[p][b].data() + k) - L::load(m.rest[p][b].whole + k) >=
                 L::load(pressed_from_[p][b].data() + k);
        };
        auto on = over(0);
        for (std::size_t p = 1; p < pressures; ++p) on = on | over(p);
        if (!any(on)) continue;
        for (std::size_t lane = 0; lane < L::lanes; ++lane)
          if (const std::size_t i = 16 * b + k + lane; on[lane] && i < size() && m.hears(i))
            Life::set(pressed, i, true);
      }
    life_.tick(
        m.life, now, m.health, [&](std::size_t b) -> const HealthLimitsRow& { return health_.limits(b); },
        pressed, [&](std::size_t i) { return near(i); });
    if (s_.find_faults)
      Life::each(m.life.quiet, [&](std::size_t i) {
        if (has_lone(i)) health_.hold(m.health, i, CellFault::quiet);
      });
  }
  /// Moves the rest levels to `now`.
  void follow(Memory& m, Nanoseconds now) const noexcept {
    if (!s_.follow_rest || !(now > m.health.time)) return;
    const auto step = rest_.template step<float>(now - m.health.time);
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

  /// Whether other sensors tell that something moves at cell `i`, or touches it.
  [[nodiscard]] typename Health::Witness witness(const Memory& m, std::size_t i) const noexcept {
    const HealthRow& own = m.health.row[i / 16];
    const std::size_t k = i % 16;
    const float within = seconds<float>(2 * s_.health.witnessed_within + s_.period);
    const float seen = seconds<float>(s_.seen_for), force = above(m, i);
    typename Health::Witness w;
    if (s_.proximity) {
      w.moved = own.still_proximity[k] < within;
      w.touched = own.seen[k] >= seen && own.proximity[k] > 0.1f;
    }
    for (const std::size_t n : near(i)) {
      if (!counts(m, n)) continue;
      const HealthRow& row = m.health.row[n / 16];
      const std::size_t l = n % 16;
      const float other = above(m, n);
      w.moved = w.moved || row.still[l] < within || (s_.proximity && row.still_proximity[l] < within);
      w.touched =
          w.touched ||
          (other > 6 * health_.sigma(n) && other >= static_cast<float>(s_.witness_share) * force) ||
          (s_.proximity && row.seen[l] >= seen && row.proximity[l] > static_cast<float>(s_.other_proximity));
    }
    return w;
  }

  /// See `TrustedSkin::follow_robot`.
  template <class M, class State>
  void give_way(Memory& m, const M& model, const State& state) const noexcept {
    constexpr double least = 2e-4;
    constexpr Nanoseconds stale = 50ms;  // a place that has not moved for so long rests
    double most = 0;
    for (std::size_t j = 0; j < M::joints; ++j)
      most = std::max(most, std::abs(static_cast<double>(state.q[j] - m.counted_q[j])));
    const Nanoseconds since = state.time - std::max(m.counted_at, state.time - stale);
    const bool first = m.counted_at == Nanoseconds::min();
    if (!first && !(most > least)) {
      if (since >= stale) Life::each(m.life.pressed, [&](std::size_t i) { life_.give(m.life, i, 0, 0); });
      return;
    }
    JointPosition<M::joints, T> before, now;
    for (std::size_t j = 0; j < M::joints; ++j) {
      before[j] = m.counted_q[j], now[j] = state.q[j];
      m.counted_q[j] = now[j];
    }
    m.counted_at = state.time;
    if (first || !(since > 0ns)) return;
    typename Life::Bits giving = m.life.pressed;
    for (std::size_t b = 0; b < rows; ++b)
      giving[b] = static_cast<std::uint16_t>(giving[b] & ~m.life.lives[b]);
    if (giving == typename Life::Bits{}) return;
    const InwardWay<M, S::Wrenches::links, T> way(model, before, now);
    Life::each(giving, [&](std::size_t i) {
      const float inwards = way(S::Wrenches::slot(cell_[i].link), cell_[i].place, cell_[i].normal);
      life_.give(m.life, i, own_share(m, i) * inwards, inwards / seconds<float>(since));
    });
  }
  /// The share of its place's displacement that counts for pushed cell `i`: its force over the sum with that
  /// of neighbours that live. At the rim of a touch a place gives way to the touch, not to what its own cell
  /// feels of it.
  [[nodiscard]] float own_share(const Memory& m, std::size_t i) const noexcept {
    const float own = above(m, i);
    float all = own;
    for (const std::size_t n : near(i))
      if (Life::in(m.life.lives, n) && counts(m, n)) all += above(m, n);
    return own > 0 ? own / all : 1.0f;
  }

  /// The least push on the middle of cell `i` that cell `j` notices, as a reading of `i`; infinite: none.
  [[nodiscard]] double noticed_by(const Memory& m, std::size_t j, std::size_t i) const noexcept {
    constexpr double never = std::numeric_limits<double>::infinity();
    const auto felt_by = [&](std::size_t n) {
      return n == i ? 1.0 : (fill_.graph().joined(n, i) ? s_.spread : 0.0);
    };
    if (!counts(m, j)) return never;
    const double share = felt_by(j), push = opens_at_[j] / share;
    if (!has_lone(j) || cell_[j].lone > 0) return push;
    double witnessed = never;
    for (const std::size_t n : near(j)) {
      const double of_witness = felt_by(n);
      if (!(of_witness > 0) || of_witness < s_.witness_share * share || !counts(m, n)) continue;
      witnessed = std::min(witnessed, 6 * double(health_.sigma(n)) * s_.health.step / of_witness);
    }
    return std::max(push, witnessed);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
