// SPDX-License-Identifier: BSD-3-Clause
// Slip, felt as shear beside normal force, and the normal force that holds.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/triple.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Slip at one contact (a fingertip, a patch of a palm), from the sum of the forces on its cells: normal
/// force f_n, shear f_t. Coulomb: it sticks while `|f_t| <= mu f_n`, and slides with `|f_t| = mu_k f_n`, mu_k
/// < mu; it falls between the two within some 60 ms (LuGre: Canudas de Wit et al., IEEE TAC 40(3), 1995).
///
///     demand    d = |f_t| / f_n,  forces low-passed with `filter`
///     peak      P' = -(P - |f_t|) / fall,  P >= |f_t|;  D of d alike, and H within 300 s
///     noise     sigma: what the low-pass leaves of `noise`
///     unrest    u^2: mean square of P - |f_t|, which rises within 0.2 s and falls within 5 s
///     slip      P - |f_t| > max(5 sigma, drop P, 3 u),  D >= 0.85 H,  |f_t| >= max_drop P
///     friction  a slip: mu = min(mu, d), that of the slide; else mu' = probe mu, a tenth of it after a slip
///     hold      f_n = reserve |f_t| / mu,  at least `min_normal`
///
/// A contact slips from its highest demand. Shaking is unrest. While it slides, `hold` is `reserve` times the
/// present force: a grip that follows tightens until it sticks, and the shear is again what it was. If it is
/// not within 0.2 s, or less than `max_drop` is left, a load was taken off, and mu is as before. With `probe`
/// mu grows while it is tried, at `d >= 0.9 mu / reserve`: a grip that follows loosens until the contact
/// slides by some millimetres, and tells its friction; a pull just before that drops it. Each contact begins
/// anew.
///
/// Not found: a slide whose force does not fall (a fast pull; friction that rises with speed), or by less
/// than noise and unrest; a turn about the normal. `friction` is to be below that of all that is held.
template <Real T = double>
class Slip {
 public:
  struct Settings {
    T friction = T(0.25);     ///< mu of a new contact, > 0: moist plastic on silicone
    T max_friction = T(0.8);  ///< limit of the growth of mu: the cone of a kind (`with_normal`)
    T probe = T(0);           ///< growth of mu while nothing slips, 0: none [1/s]
    T reserve = T(1.4);       ///< ratio of the normal force to the smallest one that holds, > 1
    T noise = T(0.05);        ///< standard deviation of a sample's sum, each axis, > 0 [N]
    T drop = T(0.05);         ///< smallest drop as a share of the shear; mu_k is 5 to 30 % below mu
    T max_drop = T(0.5);      ///< smallest share of the shear that a slip leaves
    T filter = T(0.01);       ///< time constant of the forces, > 0 [s]
    T fall = T(0.1);          ///< time constant of the peak, > 0 [s]
    T min_normal = T(0.3);    ///< normal force of a contact, > 0; it ends below half of that [N]
  };
  /// Trivially copyable; `Memory{}` has no contact.
  struct Memory {
    Xyz<T> force = {T(0), T(0), T(0)};                  ///< low-passed force [N]
    T normal = T(0), shear = T(0);                      ///< normal and tangential part of `force` [N]
    T unrest = T(0);                                    ///< u^2, mean square of `peak` less `shear` [N^2]
    T peak = T(0), peak_demand = T(0), highest = T(0);  ///< peaks of shear [N], demand; highest demand
    T friction = T(0);                                  ///< learnt mu; 0: that of the settings
    T shear_before = T(0), normal_before = T(0);        ///< shear and normal force before a slip [N]
    T friction_before = T(0);                           ///< mu before a slip
    T slide = T(0);                                     ///< shear at `normal_before` while it slid [N]
    T since = T(1e9);                                   ///< time since the last drop [s]
    bool touches = false, slipped = false;              ///< a contact is there; its friction was found
  };
  /// Slip of a contact; without one zeros and a margin of 1.
  struct Result {
    bool slipping = false;
    T demand = T(0);  ///< demand of friction, |f_t| / f_n
    T margin = T(1);  ///< 1 - demand / mu: 1 unloaded, 0 at what friction holds, negative beyond
    T hold = T(0);    ///< normal force that holds, with its reserve [N]
  };

  /// Throws `ConfigurationError` for a setting out of its range.
  SKINCTL_COLD explicit Slip(const Settings& s = {}) : s_(s) {
    const auto in = [](const T& x, double low, double high, const char* what, const char* range) {
      const auto number = static_cast<double>(x);
      require(number >= low && number <= high, what, number, range);
    };
    in(s.friction, 0.01, 10, "Slip: friction", "0.01 to 10");
    in(s.max_friction, static_cast<double>(s.friction), 10, "Slip: max_friction", "friction to 10");
    in(s.probe, 0, 10, "Slip: probe", "0 to 10 1/s");
    in(s.reserve, 1.01, 10, "Slip: reserve", "1.01 to 10");
    in(s.noise, 1e-6, 1e3, "Slip: noise", "1e-6 to 1e3 N");
    in(s.drop, 1e-3, 0.9, "Slip: drop", "0.001 to 0.9");
    in(s.max_drop, 0.01, 0.99, "Slip: max_drop", "0.01 to 0.99");
    in(s.filter, 1e-5, 1, "Slip: filter", "1e-5 to 1 s");
    in(s.fall, 1e-5, 1, "Slip: fall", "1e-5 to 1 s");
    in(s.min_normal, 1e-3, 1e3, "Slip: min_normal", "1e-3 to 1e3 N");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes one sample, `dt` [s] after the last one.
  /// @param force   sum of the forces on the contact's cells [N], as a skin's link wrench has it.
  /// @param inward  inward normal, along which pressure acts, of unit length, along the same axes: minus the
  ///                cells' z.
  /// A sample with a number that is not finite, a force above 1e6 N, or `dt <= 0` is ignored. After a gap of
  /// more than 50 ms nothing is compared with the forces before.
  Result take(Memory& m, const T& dt, const Xyz<T>& force, const Xyz<T>& inward) const noexcept {
    using std::sqrt;
    const T unit = dot(inward, inward);
    if (!(dot(force, force) <= T(1e12)) || !(unit > T(0.9) && unit < T(1.1)) || !(dt > T(0) && dt < T(1e6)))
      return result(m);
    const auto part = [&dt](const T& time) { return T(dt / (time + dt)); };
    const bool gap = dt > T(longest_gap) || !m.touches;
    m.force = gap ? force : Xyz<T>(m.force + part(s_.filter) * (force - m.force));
    m.normal = dot(m.force, inward);
    const Xyz<T> across = m.force - m.normal * inward;
    m.shear = sqrt(dot(across, across));
    if (!(m.normal >= (m.touches ? T(0.5) * s_.min_normal : s_.min_normal))) return m = {}, Result{};
    const T demand = m.shear / m.normal;
    if (gap) m.peak = m.shear, m.peak_demand = demand;
    m.touches = true;
    const auto top = [&](T y, T x, T time) { return x > y ? x : T(y - part(time) * (y - x)); };
    m.peak = top(m.peak, m.shear, s_.fall), m.peak_demand = top(m.peak_demand, demand, s_.fall);
    m.highest = top(m.highest, demand, T(remembers));
    const T drop = m.peak - m.shear, square = drop * drop;
    const T sigma = dt / (T(2) * s_.filter + dt) * s_.noise * s_.noise;  // squared
    const bool slipping = m.since <= T(slide_time),
               arrested = !slipping && m.since <= T(judged);  // comes to rest
    const bool drops = !arrested && square > T(surely * surely) * sigma && drop > s_.drop * m.peak &&
                       square > T(calmly * calmly) * m.unrest &&
                       m.peak_demand >= T(near_highest) * m.highest && m.shear >= s_.max_drop * m.peak;
    m.unrest = m.unrest + part(square > m.unrest ? T(unrest_rises) : T(unrest_falls)) * (square - m.unrest);
    const T mu = friction(m), full = m.slide * m.normal / (m.normal_before > T(0) ? m.normal_before : T(1));
    if (drops && !slipping) m.shear_before = m.peak, m.normal_before = m.normal, m.friction_before = mu;
    m.since = drops ? T(0) : m.since < T(1e8) ? T(m.since + dt) : m.since;
    if (drops || slipping) {
      const bool released = m.shear < s_.max_drop * m.shear_before;
      const bool slides =
          m.normal <= T(tightens) * m.normal_before && demand < mu;  // a tightened grip sticks
      m.friction = released ? m.friction_before : slides ? demand : mu;
      m.slipped = m.slipped || !released;
      m.slide = m.friction * m.normal_before;
      if (released) m.since = T(1e9);
    } else if (m.since <= T(judged) && m.since + dt > T(judged) &&
               m.normal > T(has_tightened) * m.normal_before &&
               T(2) * (m.shear - m.slide) < (m.shear_before < full ? m.shear_before : full) - m.slide) {
      m.friction = m.friction_before;
    } else if (s_.reserve * demand >= T(tried) * mu) {
      const T grown = mu + (m.slipped ? T(after_slip) : T(1)) * s_.probe * dt * mu;
      m.friction = grown < s_.max_friction ? grown : s_.max_friction;
    }
    return result(m);
  }
  [[nodiscard]] Result result(const Memory& m) const noexcept {
    if (!m.touches) return {};
    const T mu = friction(m), demand = m.shear / m.normal, hold = s_.reserve * m.shear / mu;
    return {m.since <= T(slide_time), demand, T(1) - demand / mu,
            hold > s_.min_normal ? hold : s_.min_normal};
  }
  /// The friction coefficient in use: the learnt one, else that of the settings.
  [[nodiscard]] T friction(const Memory& m) const noexcept {
    return m.friction > T(0) ? m.friction : s_.friction;
  }

 private:
  static constexpr double longest_gap = 0.05;   ///< longest gap between samples that are compared [s]
  static constexpr double slide_time = 0.05;    ///< duration of a drop [s]: friction falls within some 60 ms
  static constexpr double judged = 0.2;         ///< time in which a tightened grip tells slip from load [s]
  static constexpr double remembers = 300;      ///< time constant of the highest demand: a carry [s]
  static constexpr double surely = 5;           ///< threshold in deviations of the noise: one of 3e6 samples
  static constexpr double calmly = 3;           ///< threshold in times u: shaking by up to 3 m/s^2 is no slip
  static constexpr double near_highest = 0.85;  ///< share of the highest demand: a contact slips at its mu
  static constexpr double unrest_rises = 0.2, unrest_falls = 5;  ///< time constants of the unrest [s]
  /// Growth of the normal force up to which a grip has not tightened, and above which it has.
  static constexpr double tightens = 1.05, has_tightened = 1.04;
  static constexpr double tried = 0.9;       ///< share of mu / reserve from which on mu is tried
  static constexpr double after_slip = 0.1;  ///< share of `probe` once the friction has been told
  Settings s_;
};

SKINCTL_END_NAMESPACE
