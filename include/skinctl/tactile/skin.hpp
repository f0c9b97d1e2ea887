// Skin: all patches of a robot, and the conversion of their samples to wrenches on links.
#pragma once

#include <span>

#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/coverage.hpp"
#include "skinctl/tactile/detail/reception.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/tactile/patch.hpp"
#include "skinctl/tactile/pressed_area.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Patches of cells on a robot of topology `M`. Immutable; the changing data are a `Memory` of 12 bytes a
/// cell.
///
/// **Result.** Each cell's force [N] is piecewise linear in time through its stamped samples. A cell that
/// sends only changes is silent while its reading is constant: its force is held, and changes only within the
/// last `ramp` before the new sample. After the last sample it is held; once the cell has been silent for
/// `max_age - fade` it goes to zero within `fade` and stays there. There is no baseline that follows the
/// readings. `receive` gives the mean wrench on every link for each part of an interval. A sample may show
/// that the force has changed before the interval began, when it was assumed constant; the missing impulse is
/// then added, up to `catch_up` back. So the impulse on the robot is the integral of the force, whatever the
/// rate of the cycle.
///
/// **Method.** The sums of the held readings times their unit wrenches are updated event by event, in integer
/// steps (unit wrenches to 2^-24, readings to 2^-14 and 2^-16), so they stay exact in any order.
template <Topology M, Real T, class... Patches>
class Skin {
 public:
  static_assert(sizeof...(Patches) > 0, "a skin has at least one patch");
  static_assert(((Patches::link < M::joints) && ...), "a patch sits on a link that the model does not have");
  using scalar = T;
  using Wrenches = LinkWrenches<M, (link_bit<Patches::link> | ...), T>;
  using Touch = TouchWrenches<Wrenches>;
  using Pressed = PressedAreas<M, Wrenches::links, T>;
  static constexpr LinkMask links = Wrenches::links;
  static constexpr std::size_t patches = sizeof...(Patches);
  static constexpr std::size_t cells = (Patches::cells + ...);

  /// The data that change from cycle to cycle. `Memory{}` has received no cell. Trivially copyable; only the
  /// skin reads and writes its members.
  using Memory = detail::SkinMemory<cells, patches, Wrenches>;

  /// Throws `ConfigurationError` for an id that occurs twice or is 2^20 or more, and for settings that
  /// `SkinSettings::check` refuses.
  SKINCTL_COLD explicit Skin(const Patches&... patch, const SkinSettings& settings = {})
      : tables_(settings, cells) {
    settings.check();
    std::size_t k = 0;
    const auto add = [&]<class P>(const P& p) {
      tables_.force_gain[k] = T(p.gains().force * CellCounts::force_unit);
      tables_.proximity_gain[k] = T(p.gains().proximity * CellCounts::proximity_unit);
      static_assert(P::cells <= detail::ExactSums::most_cells,
                    "a patch has at most 8192 cells: sums stay exact");
      tables_.cells.add(p.any(), k++, Wrenches::slot(P::link));
    };
    (add(patch), ...);
  }

  /// The memory of a skin that starts to receive at `now`: no cell has been received, no impulse is missing,
  /// and samples add no impulse for times before `now`.
  [[nodiscard]] Memory start(Nanoseconds now) const noexcept {
    Memory memory;
    memory.begin = now;
    return memory;
  }

  /// Takes the samples that arrived and gives the mean wrenches over each of `substeps` >= 1 equal parts of
  /// the interval `(from, to]`.
  ///
  /// A sample is ignored and reported if it is
  /// - not finite (`sample_not_finite`), out of range (`sample_out_of_range`), of an unknown cell
  ///   (`sample_unknown`),
  /// - not later than the cell's last one (`time_backwards`),
  /// - stamped more than `max_ahead` after `to` (`sample_out_of_range`),
  /// - older than `max_age` (`sample_stale`, which is also reported while at least one cell is silent).
  ///
  /// Samples of one cell must be in the order of their stamps; those of different cells may come in any
  /// order. An interval without length (`interval_empty`) takes the samples, gives the held wrenches, and
  /// adds their impulse to the next interval. Time is bounded: per sample and per cell a constant times
  /// `substeps`.
  ///
  /// @param means  `Wrenches`, or `Touch` for forces and proximities apart. A memory stays with one of them.
  /// @param front  at most one: a front end that judges the cells, for example one that masks faulty ones.
  ///   `front.reading(i, sample) -> CellCounts` is called for each sample that is not ignored, in place of
  ///   `counts(sample)`; `i` is the cell's index. Then, once after all samples and before cells age,
  ///   `front.settle(revise)`: `revise(i, counts)` gives the cell another reading before the gates, reached at `to` by
  ///   a change within the last `ramp` of this interval. The cell goes on ageing; one that is silent or already fades
  ///   stays as it is. Revise a cell once at most.
  template <class Means, class... Front>
  Status receive(Memory& memory, std::span<const CellSample> samples, Nanoseconds from, Nanoseconds to,
                 std::size_t substeps, Means* means, Front&&... front) const noexcept {
    static_assert(std::is_same_v<Means, Wrenches> || std::is_same_v<Means, Touch>,
                  "a skin receives its own Wrenches, or its Touch");
    static_assert(sizeof...(Front) <= 1, "a skin has one front end");
    SKINCTL_EXPECTS(substeps > 0 && means != nullptr, "at least one part of the interval");
    const Nanoseconds known = detail::elapsed(memory.begin, from), back = settings().catch_up;
    const auto parts = detail::Parts<T>::of(from, to, substeps, known < back ? known : back);
    Means before = held_as<Means>(memory);
    if (parts.from != parts.to) {
      if constexpr (std::is_same_v<Means, Touch>) {
        before.force += parts.per_whole * memory.owed.force;
        before.proximity += parts.per_whole * memory.owed.proximity;
        memory.owed.proximity = {};
      } else {
        before += parts.per_whole * memory.owed.force;
      }
      memory.owed.force = {};
    }
    for (std::size_t j = 0; j < substeps; ++j) means[j] = before;
    const detail::Reception<T, detail::SkinTables<T, patches>, Memory, Means> reception(tables_, memory,
                                                                                        parts, means);
    Status status;
    for (const CellSample& sample : samples) status |= reception.take(sample, front...);
    (front.settle([&](std::size_t i, CellCounts raw) SKINCTL_INLINE_LAMBDA { reception.revise(i, raw); }),
     ...);
    status |= reception.age();
    return parts.from == parts.to ? status | Reason::interval_empty : status;
  }

  /// The wrenches of the held readings, as after the last `receive`; fading cells count fully until they are
  /// silent.
  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    Wrenches total;
    std::size_t k = 0;
    const auto add = [&](std::size_t slot) SKINCTL_INLINE_LAMBDA {
      const detail::ExactSums& sums = memory.sums[k];
      for (std::size_t r = 0; r < 6; ++r)
        total.data[slot][r] = total.data[slot][r] + tables_.force_gain[k] * static_cast<T>(sums.force[r]) +
                              tables_.proximity_gain[k] * static_cast<T>(sums.proximity[r]);
      ++k;
    };
    (add(Wrenches::slot(Patches::link)), ...);
    return total;
  }
  /// The same, forces and proximities apart.
  [[nodiscard]] Touch touch(const Memory& memory) const noexcept {
    Touch out;
    std::size_t k = 0;
    const auto add = [&](std::size_t slot) SKINCTL_INLINE_LAMBDA {
      const detail::ExactSums& sums = memory.sums[k];
      T *force = out.force.data[slot], *proximity = out.proximity.data[slot];
      for (std::size_t r = 0; r < 6; ++r) {
        force[r] = force[r] + tables_.force_gain[k] * static_cast<T>(sums.force[r]);
        proximity[r] = proximity[r] + tables_.proximity_gain[k] * static_cast<T>(sums.proximity[r]);
      }
      ++k;
    };
    (add(Wrenches::slot(Patches::link)), ...);
    return out;
  }
  /// The memory with its sums computed anew, cell by cell: bit for bit those of the events.
  [[nodiscard]] Memory recomputed(Memory memory) const noexcept {
    memory.sums = {};
    for (std::size_t i = 0; i < cells; ++i) {
      const detail::CellEntry& cell = tables_.cells[i];
      if (memory.hears(i)) memory.sums[cell.patch].add(cell, memory.held[i].force, memory.held[i].proximity);
    }
    return memory;
  }

  /// The areas where force readings are held: the contacts. Time is bounded: per pressed cell a constant.
  /// What else is touched (the second argument) is nothing to a skin.
  [[nodiscard]] Pressed pressed(const Memory& memory, const auto&) const noexcept { return pressed(memory); }
  [[nodiscard]] Pressed pressed(const Memory& memory) const noexcept {
    static constexpr std::array<std::size_t, patches> link{Patches::link...};
    Pressed areas;
    each_pressed(memory, [&](std::size_t i, const T& push) SKINCTL_INLINE_LAMBDA {
      const detail::CellEntry& cell = tables_.cells[i];
      const auto& p = tables_.cells.place(i);
      areas.add(link[cell.patch], {T(p[0]), T(p[1]), T(p[2])}, cell.unit, push);
    });
    return areas;
  }
  /// Calls `f(i, push)` for each cell whose force reading is held, in the order of the patches, with its push
  /// > 0 [N].
  template <class F>
  SKINCTL_INLINE void each_pressed(const Memory& memory, F&& f) const noexcept {
    for (std::size_t b = 0; b < Memory::blocks; ++b) {
      if (!memory.may_press(b)) continue;
      for (std::uint64_t rest = memory.heard[b]; rest != 0; rest &= rest - 1) {
        const std::size_t i = 64 * b + static_cast<std::size_t>(std::countr_zero(rest));
        if (memory.held[i].force == 0) continue;
        const T push = tables_.template push_on<detail::Reading::force>(tables_.cells[i], memory.held[i]);
        if (push > T(0)) f(i, push);
      }
    }
  }
  /// The places of all cells, in the order of the patches.
  [[nodiscard]] SKINCTL_COLD std::vector<CellPlace> places() const {
    static constexpr std::array<std::size_t, patches> link{Patches::link...};
    std::vector<CellPlace> all;
    for (std::size_t i = 0; i < cells; ++i) {
      const detail::CellEntry& cell = tables_.cells[i];
      const auto& p = tables_.cells.place(i);
      const float* u = cell.unit;
      all.push_back({link[cell.patch],
                     cell.patch,
                     {double(p[0]), double(p[1]), double(p[2])},
                     {-double(u[0]), -double(u[1]), -double(u[2])}});
    }
    return all;
  }

  /// Calls `f(link, force, moment, gain)` for up to `most` cells of each patch, evenly over its list: the
  /// cell's unit wrench about the link's origin, and w_f [N per unit of its force readings].
  template <class F>
  void each_cell(F&& f, std::size_t most = cells) const {
    std::size_t first = 0, k = 0;
    const auto look = [&](std::size_t link, std::size_t count) {
      const std::size_t taken = count < most ? count : most;
      for (std::size_t n = 0; n < taken; ++n) {
        const float* u = tables_.cells[first + n * count / taken].unit;
        f(link, Xyz<T>{T(u[0]), T(u[1]), T(u[2])}, Xyz<T>{T(u[3]), T(u[4]), T(u[5])},
          static_cast<double>(tables_.force_gain[k]) / CellCounts::force_unit);
      }
      first += count;
      ++k;
    };
    (look(Patches::link, Patches::cells), ...);
  }

  /// Number of silent cells: never received, or not within `max_age`.
  [[nodiscard]] std::size_t silent(const Memory& memory) const noexcept {
    std::size_t n = cells;
    for (const std::uint64_t block : memory.heard) n -= static_cast<std::size_t>(std::popcount(block));
    return n;
  }
  /// Number of cells whose readings count: received within `max_age`.
  [[nodiscard]] std::size_t usable(const Memory& memory) const noexcept { return cells - silent(memory); }
  /// How much of the skin feels, also of its worst patch.
  [[nodiscard]] Coverage coverage(const Memory& memory) const noexcept {
    Coverage out;
    std::size_t first = 0;
    const auto look = [&](std::size_t count) SKINCTL_INLINE_LAMBDA {
      out.add(memory.heard_from(first, count), count);
      first += count;
    };
    (look(Patches::cells), ...);
    return out;
  }
  /// Upper bound of the proximity readings in [0, 1] of the cells on link `I`: at least the gate's opening
  /// threshold, below which nothing passes; 1 if one of the cells is silent and its reading unknown. A link
  /// without skin does not compile.
  template <std::size_t I>
  [[nodiscard]] T nearest(const Memory& memory) const noexcept {
    static_assert(((Patches::link == I) || ...), "no skin on this link: it sees nothing");
    std::uint16_t most = 0;
    bool all = true;
    std::size_t first = 0;
    const auto look = [&]<class P>(std::type_identity<P>) {
      if constexpr (P::link == I) {
        for (std::size_t i = first; i < first + P::cells; ++i) {
          const std::uint16_t p = memory.held[i].proximity;
          most = p > most ? p : most;
        }
        all = all && memory.hears_all_from(first, P::cells);
      }
      first += P::cells;
    };
    (look(std::type_identity<Patches>{}), ...);
    const auto& gate = tables_.proximity_gate;
    const std::int32_t seen = most + gate.subtract(), hidden = gate.opens_at();
    const T reading = T(most != 0 && seen > hidden ? seen : hidden) * T(CellCounts::proximity_unit);
    return all && reading < T(1) ? reading : T(1);
  }
  /// The counts of the `i`-th cell's last sample (in the order of the patches) after the gates; 0 if silent.
  [[nodiscard]] CellCounts held(const Memory& memory, std::size_t i) const noexcept {
    SKINCTL_EXPECTS(i < cells, "a cell of this skin");
    return memory.hears(i) ? memory.held[i] : CellCounts{};
  }
  /// Index of the cell `id` in the order of the patches; `cells` if no patch has it.
  [[nodiscard]] std::size_t index(std::uint32_t id) const noexcept {
    const std::size_t i = tables_.cells.index(id);
    return i < cells ? i : cells;
  }
  [[nodiscard]] const SkinSettings& settings() const noexcept { return tables_.settings; }
  /// Whether another skin has the same cells at the same places: it then understands this one's memory,
  /// whatever its gains and gates.
  [[nodiscard]] bool same_cells(const Skin& other) const noexcept {
    return tables_.cells == other.tables_.cells;
  }

 private:
  template <class Means>
  [[nodiscard]] SKINCTL_INLINE Means held_as(const Memory& memory) const noexcept {
    if constexpr (std::is_same_v<Means, Touch>) {
      return touch(memory);
    } else {
      return wrenches(memory);
    }
  }

  detail::SkinTables<T, patches> tables_;
};

SKINCTL_END_NAMESPACE
