// SPDX-License-Identifier: BSD-3-Clause
// A skin whose faulty cells do not move the robot.
#pragma once

#include <algorithm>

#include "skinctl/tactile/detail/trust_core.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A skin `S` behind rest levels (`RestLevel`), fault rules (`CellHealth`) and masks; the skin of any `Cycle`
/// in place of `S`.
///
/// - **Reading.** What counts of a cell is its reading above its rest level, times 1 minus its mask.
/// - **One cell alone.** A cell that no witness is touched with counts up to its `lone_force`: found or not,
///   one faulty cell does not move an arm whose dry friction holds that force. Witnesses are its own
///   proximity, if it has come up without a jump, and a neighbour that is not masked and feels a
///   `witness_share` of its force, or sees something. A cell that has lost its witness fades to `lone_force`
///   within 0.1 s, unless it lives (`CellLife`): a finger that slides to a rim of the skin is the finger that
///   was witnessed.
/// - **Many at once.** All cells without a witness share one lone force: the sum of their pushes, each as a
///   share of its own F_1, is at most 1, so that however many there are give no joint more than one alone
///   may.
/// - **Without life.** Cells share bus, supply and plug: they fail together. So a witness is not enough: a
///   push that neither moves nor trembles (`CellLife`) counts less with the way that its place gives to it,
///   and nothing after `LifeSettings::way`, whether it is witnessed or not. What does not count of it shares
///   the lone force; the cell is masked as quiet until it has pushed nothing for `LifeSettings::calm`. A bag
///   that lies on the arm is quiet, too. A scene says how its places move (`follow_robot`); where nobody
///   does, such pushes count up to `LifeSettings::force`.
/// - **Filling in.** A cell that is masked, or silent, counts as `FillIn` makes it from the cells around it.
///
/// Everything is a function of the samples and the intervals: a recording is replayed bit for bit. Per call,
/// time is bounded: a scan of all cells every `period` of the samples, and a constant for each sample, each
/// cell that pushes and each faulty one.
template <class S>
class TrustedSkin : public detail::TrustCore<S> {
  using Core = detail::TrustCore<S>;
  using Core::cell_;
  using typename Core::Health, typename Core::Kind, typename Core::Table;

 public:
  using scalar = typename S::scalar;
  using T = scalar;
  using Wrenches = typename S::Wrenches;
  using Touch = typename S::Touch;
  using Pressed = typename S::Pressed;
  using Memory = typename Core::Memory;
  static constexpr LinkMask links = Wrenches::links;
  static constexpr std::size_t patches = Core::patches, cells = Core::cells;

  /// Wraps a `Skin`, a `SkinOf`, or a skin that wraps one.
  /// @param fill  from `FillIn(graph, places)`; its graph says which cells are neighbours.
  /// Throws `ConfigurationError` for settings out of their range, and a graph of another number of cells.
  SKINCTL_COLD TrustedSkin(const S& skin, const TrustSettings& settings, const FillIn& fill)
      : Core(skin, settings, fill) {}
  /// Neighbours are cells within 1.3 pitches; a masked cell is filled in from them and their neighbours.
  SKINCTL_COLD TrustedSkin(const S& skin, const TrustSettings& settings)
      : Core(skin, settings, FillIn(CellGraph(skin.places()), skin.places())) {}

  /// Number of cells.
  using Core::size;
  [[nodiscard]] const S& skin() const noexcept { return this->wrapped(); }
  [[nodiscard]] const TrustSettings& trust() const noexcept { return this->s_; }
  [[nodiscard]] const FillIn& fill() const noexcept { return this->fill_; }

  /// The memory of a skin that starts to receive at `now`: nothing is masked, rest levels are those of
  /// `noise`.
  [[nodiscard]] Memory start(Nanoseconds now) const noexcept {
    Memory m = Core::start(now);
    m.health.time = now;
    for (std::size_t p = 0; p < Core::pressures; ++p) {
      for (std::size_t i = 0; i < size(); ++i)
        m.rest[p][i / 16].whole[i % 16] = static_cast<float>(this->sensors_of(p)) * cell_[i].rest;
      m.median[p].fill(std::numeric_limits<float>::quiet_NaN());
    }
    return m;
  }

  /// See `Skin::receive`.
  template <class Given, class Means>
  Status take(Memory& m, const Given& in, Means* means) const noexcept {
    const Touch before = m.filled;
    typename Core::Front front{*this, m, in.to};
    const Status status = this->take_on(m, in, means, front);
    for (std::size_t j = 0; j < in.parts; ++j) {
      // Linear over the interval.
      const T after =
          in.from < in.to ? T((T(static_cast<int>(j)) + T(0.5)) / T(static_cast<int>(in.parts))) : T(0);
      add_between(means[j], before, m.filled, after);
    }
    return status;
  }

  /// Counts how far pressed places give way; called by a scene. Joints that have moved by less than 0.2 mrad
  /// (0.2 mm), an encoder's noise, wait for the next call.
  template <class M, class State>
  void follow_robot(Memory& m, const M& model, const State& state) const noexcept {
    this->give_way(m, model, state);
  }

  [[nodiscard]] Wrenches wrenches(const Memory& m) const noexcept {
    return this->wrapped().wrenches(m) + m.filled.total();
  }
  [[nodiscard]] Touch touch(const Memory& m) const noexcept {
    Touch out = this->wrapped().touch(m);
    add(out, m.filled.force, m.filled.proximity);
    return out;
  }
  [[nodiscard]] Pressed pressed(const Memory& m, const auto&...) const noexcept {
    Pressed areas = this->wrapped().pressed(m);
    typename Core::Filled filled(*this, m);
    this->each_filled(m, [&](std::size_t i, double share) {
      detail::add_area(this->tables_, i, this->pushes_filled(i, share, filled(i)), areas);
    });
    return areas;
  }
  /// Calls `f(i, push)` for each cell that is pressed or filled in, with its push > 0 [N].
  template <class F>
  void each_pressed(const Memory& m, F&& f) const noexcept {
    typename Core::Filled filled(*this, m);
    const auto filled_in = [&](std::size_t i, double share) {
      return this->pressure_of(this->pushes_filled(i, share, filled(i)));
    };
    this->wrapped().each_pressed(m, [&](std::size_t i, const T& push) {
      const double share = this->share_filled(m, i);
      f(i, share > 0 ? T(push + filled_in(i, share)) : push);
    });
    this->each_filled(m, [&](std::size_t i, double share) {
      if (m.presses(i) && !cell_[i].masked) return;  // above
      if (const T push = filled_in(i, share); push > T(0)) f(i, push);
    });
  }
  /// See `Skin::max_proximity`. What a masked cell sees is left to its neighbours, if one of them is heard
  /// and not masked.
  template <std::size_t Ix>
  [[nodiscard]] T max_proximity(const Memory& m) const noexcept {
    if constexpr (!Table::sees) return T(1);
    float most = static_cast<float>(this->wrapped().settings().gates()[this->seen_].opens_at() /
                                    Kind::channels[this->seen_].greatest);
    for (std::size_t i = 0; i < size(); ++i) {
      if (cell_[i].link != Ix) continue;
      if (!m.hears(i)) return T(1);
      if (this->counts(m, i)) {
        most = std::max(most, m.health.row[i / 16].proximity[i % 16]);
      } else if (std::none_of(this->near(i).begin(), this->near(i).end(),
                              [&](std::size_t n) { return this->counts(m, n); })) {
        return T(1);
      }
    }
    return T(most < 1 ? most : 1.0f);
  }
  /// The coverage of the skin: cells that are heard and not masked, of all.
  [[nodiscard]] Coverage coverage(const Memory& m) const noexcept {
    Coverage out;
    for (std::size_t k = 0; k + 1 < this->first_.size(); ++k) {
      std::size_t count = 0;
      for (std::size_t i = this->first_[k]; i < this->first_[k + 1]; ++i)
        count += this->counts(m, i) ? 1u : 0u;
      out.add(count, this->first_[k + 1] - this->first_[k]);
    }
    return out;
  }
  /// See `Skin::noticed`: by cell `i`, or by a neighbour, which feels `TrustSettings::spread` of the push.
  /// One that needs a witness notices what its witness notices, too.
  [[nodiscard]] double noticed(const Memory& m, std::size_t i) const noexcept {
    double least = this->noticed_by(m, i, i);
    for (const std::size_t j : this->near(i)) least = std::min(least, this->noticed_by(m, j, i));
    return least;
  }

  /// The mask of cell `i`: 0: it counts; 1: it does not.
  [[nodiscard]] float mask(const Memory& m, std::size_t i) const noexcept {
    return cell_[i].masked ? 1.0f : Health::mask(m.health, i);
  }
  /// The faults found of cell `i`, silence included; empty: healthy.
  [[nodiscard]] CellFaults faults(const Memory& m, std::size_t i) const noexcept {
    CellFaults f = Health::faults(m.health, i);
    if (!m.hears(i)) f |= CellFault::unheard;
    for (const auto& rest : m.rest)
      if (RestLevel::cell(rest[i / 16], i % 16).below < 0) f |= CellFault::discharge;
    return f;
  }
  /// Rest level of the `p`-th pressure of cell `i` of the skin: its reading while untouched, in the reading's
  /// unit. Of a hexagon (p = 0) it is the sum of three forces.
  [[nodiscard]] double rest(const Memory& m, std::size_t i, std::size_t p = 0) const noexcept {
    return this->s_.health.step * Table::full(this->pressure_[p]) *
           static_cast<double>(m.rest[p][i / 16].whole[i % 16]);
  }
  /// Whether cell `i` has read something for a minute that nobody can tell from a contact: see the
  /// function of that name in `sensing/rest_level.hpp`.
  [[nodiscard]] bool is_unexplained(const Memory& m, std::size_t i) const noexcept {
    return std::any_of(m.rest.begin(), m.rest.end(), [&](const auto& rest) {
      return skinctl::is_unexplained(RestLevel::cell(rest[i / 16], i % 16));
    });
  }
  /// The id, link and place of each cell, for reports.
  [[nodiscard]] std::span<const detail::TrustCell<Kind>> table() const noexcept { return cell_; }

 private:
  /// Adds the wrenches at the fraction `after`, 0 to 1, between `before` and `now`. A function of its own,
  /// since a cycle begins with cold code: inlined it is 1.3 KB longer and no faster.
  template <class To>
  static SKINCTL_NOINLINE void add_between(To& to, const Touch& before, const Touch& now,
                                           const T& after) noexcept {
    add(to, (T(1) - after) * before.force + after * now.force,
        (T(1) - after) * before.proximity + after * now.proximity);
  }
  static SKINCTL_INLINE void add(Wrenches& to, const Wrenches& force, const Wrenches& proximity) noexcept {
    to += force + proximity;
  }
  static SKINCTL_INLINE void add(Touch& to, const Wrenches& force, const Wrenches& proximity) noexcept {
    to.force += force, to.proximity += proximity;
  }
};

SKINCTL_END_NAMESPACE
