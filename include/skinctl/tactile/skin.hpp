// Skin: all patches of a robot, and how their samples become wrenches on links.
#pragma once

#include <span>

#include "skinctl/tactile/detail/reception.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Patches of cells on a robot of topology `M`. Immutable; what changes is a `Memory` of 12 bytes a cell.
///
/// **What is computed.** Each cell's force [N] is piecewise linear in time through its stamped samples. A
/// cell that sends only what has changed was silent because nothing did: its force stays as it was and
/// changes within the last `ramp` before the new sample. After the last sample it is held; once the cell has
/// been silent for `max_age - fade` it goes to zero within `fade` and stays there. There is no baseline
/// that follows the readings. `receive` gives the mean wrench on every link for each part of an interval;
/// what a sample tells about the time before the interval (it was held, and has changed since) is added as
/// impulse, up to `catch_up` back. So the impulse on the robot is the integral of that force, whatever the
/// rate of the cycle.
///
/// **How.** The sums of the held readings times their unit wrenches are kept up to date event by event, in
/// whole steps (unit wrenches to 2^-24, readings to 2^-14 and 2^-16): they are exact in any order, forever.
template <Topology M, Real T, class... Patches>
class Skin {
 public:
  static_assert(sizeof...(Patches) > 0, "a skin has at least one patch");
  static_assert(((Patches::link < M::joints) && ...), "a patch sits on a link that the model does not have");
  using scalar = T;
  using Wrenches = LinkWrenches<M, (link_bit<Patches::link> | ...), T>;
  static constexpr LinkMask links = Wrenches::links;
  static constexpr std::size_t patches = sizeof...(Patches);
  static constexpr std::size_t cells = (Patches::cells + ...);

  /// What changes from cycle to cycle. `Memory{}` has heard of no cell. Trivially copyable; its members are
  /// the skin's business.
  using Memory = detail::SkinMemory<cells, patches, Wrenches>;

  /// Throws `ConfigurationError` for an id that occurs twice or is 2^20 or more, and what
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

  /// The memory of a skin that starts to listen at `now`: no cell has been heard, nothing is owed, and no
  /// sample makes up for anything before `now`.
  [[nodiscard]] Memory start(Nanoseconds now) const noexcept {
    Memory memory;
    memory.begin = now;
    return memory;
  }

  /// Takes the samples that arrived and gives the mean wrenches over each of `substeps` >= 1 equal parts of
  /// the interval `(from, to]`.
  ///
  /// A sample never pushes, and is reported, if it is not finite, out of range, of an unknown cell, not later
  /// than the cell's last one (`time_backwards`), stamped more than `max_ahead` after `to`
  /// (`sample_out_of_range`), or older than `max_age` (`sample_stale`). `sample_stale` also says that at
  /// least one cell is silent. Samples of one cell must be in the order of their stamps; those of different
  /// cells may come in any order. An interval without length (`interval_empty`) takes the samples, gives the
  /// wrenches that are held, and owes their impulse to the next interval. Time is bounded: per sample and per
  /// cell a constant times `substeps`.
  Status receive(Memory& memory, std::span<const CellSample> samples, Nanoseconds from, Nanoseconds to,
                 std::size_t substeps, Wrenches* means) const noexcept {
    SKINCTL_EXPECTS(substeps > 0 && means != nullptr, "at least one part of the interval");
    const Nanoseconds known = detail::elapsed(memory.begin, from), back = settings().catch_up;
    const auto parts = detail::Parts<T>::of(from, to, substeps, known < back ? known : back);
    Wrenches before = wrenches(memory);
    if (parts.from != parts.to) {
      before += parts.per_whole * memory.owed;
      memory.owed = {};
    }
    for (std::size_t j = 0; j < substeps; ++j) means[j] = before;
    const detail::Reception<T, detail::SkinTables<T, patches>, Memory, Wrenches> reception(tables_, memory,
                                                                                           parts, means);
    Status status;
    for (const CellSample& sample : samples) status |= reception.take(sample);
    status |= reception.age();
    return parts.from == parts.to ? status | Reason::interval_empty : status;
  }

  /// The wrenches of the readings that are held, as after the last `receive`; cells that fade count fully
  /// until they are silent.
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
  /// The same from scratch, cell after cell: bit for bit what the events left.
  [[nodiscard]] Wrenches recomputed(Memory memory) const noexcept {
    memory.sums = {};
    for (std::size_t i = 0; i < cells; ++i) {
      const detail::CellEntry& cell = tables_.cells[i];
      if (memory.hears(i)) memory.sums[cell.patch].add(cell, memory.held[i].force, memory.held[i].proximity);
    }
    return wrenches(memory);
  }

  /// How many cells are silent: never heard of, or not for `max_age`.
  [[nodiscard]] std::size_t silent(const Memory& memory) const noexcept {
    std::size_t n = cells;
    for (const std::uint64_t block : memory.heard) n -= static_cast<std::size_t>(std::popcount(block));
    return n;
  }
  /// The strongest proximity reading in [0, 1] that a cell on link `I` may have: at least what the gate
  /// opens at, because less does not pass; 1 if one of them is silent, because then nobody knows. A link
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
  /// What of the last sample of the `i`-th cell (in the order of the patches) passed the gates; 0 if silent.
  [[nodiscard]] CellCounts held(const Memory& memory, std::size_t i) const noexcept {
    SKINCTL_EXPECTS(i < cells, "a cell of this skin");
    return memory.hears(i) ? memory.held[i] : CellCounts{};
  }
  /// Where the cell `id` stands in the order of the patches; `cells` if no patch holds it.
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
  detail::SkinTables<T, patches> tables_;
};

SKINCTL_END_NAMESPACE
