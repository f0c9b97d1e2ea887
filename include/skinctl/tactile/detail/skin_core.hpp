// SkinCore: what skins share, however many cells they have and wherever these are kept.
#pragma once

#include <span>

#include "skinctl/tactile/cell_place.hpp"
#include "skinctl/tactile/coverage.hpp"
#include "skinctl/tactile/detail/link_rows.hpp"
#include "skinctl/tactile/detail/reception.hpp"
#include "skinctl/tactile/detail/summand.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/tactile/pressed_area.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// See `Skin`, whose rules these are. It has room for `Cells` and their `Sums`; `Tuned` skins have gains and
/// thresholds for each cell.
template <Topology M, Real T, LinkMask Links, std::size_t Cells, std::size_t Sums, bool Tuned>
class SkinCore : public sensor_sums::Summand {
 public:
  using scalar = T;
  using Wrenches = LinkWrenches<M, Links, T>;
  using Touch = TouchWrenches<Wrenches>;
  using Pressed = PressedAreas<M, Links, T>;
  static constexpr LinkMask links = Links;

  /// The data that change from cycle to cycle. `Memory{}` has received no cell. Only the skin reads and writes
  /// its members.
  using Memory = SkinMemory<Cells, Sums, Wrenches>;

  /// Number of cells.
  [[nodiscard]] std::size_t size() const noexcept { return tables_.cells.size(); }

  /// The memory of a skin that starts to receive at `now`: no cell has been received, no impulse is missing,
  /// and samples add no impulse for times before `now`.
  [[nodiscard]] Memory start(Nanoseconds now) const noexcept {
    Memory memory{};
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
    const Nanoseconds known = elapsed(memory.begin, from), back = settings().catch_up;
    const auto parts = Parts<T>::of(from, to, substeps, known < back ? known : back);
    write_held(memory, means, substeps);
    if (memory.owes && parts.from != parts.to) [[unlikely]]
      pay(memory, parts.per_whole, means, substeps);
    const Reception<T, SkinTables<T, Tuned>, Memory, Means> reception(tables_, memory, size(), parts, means);
    const AsSent as_sent;
    auto& judge = either(front..., as_sent);
    Status status = reception.take(samples, judge);
    (front.settle([&](std::size_t i, CellCounts raw) SKINCTL_INLINE_LAMBDA { reception.revise(i, raw); }),
     ...);
    status |= reception.age();
    return parts.from == parts.to ? status | Reason::interval_empty : status;
  }

  /// The wrenches of the held readings, as after the last `receive`; fading cells count fully until they are
  /// silent.
  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    Wrenches out;
    write_held(memory, &out, 1);
    return out;
  }
  /// The same, forces and proximities apart.
  [[nodiscard]] Touch touch(const Memory& memory) const noexcept {
    Touch out;
    write_held(memory, &out, 1);
    return out;
  }
  /// The memory with its sums computed anew, cell by cell: bit for bit those of the events.
  [[nodiscard]] Memory recomputed(const Memory& given) const noexcept {
    Memory memory = given;
    for (ExactSums& sums : memory.sums) sums = {};
    for (std::size_t i = 0; i < size(); ++i) {
      const CellCounts c = tables_.weigh(i, memory.records[i].held);
      if (memory.hears(i))
        memory.sums[tables_.cells.seat(i).sums].add(tables_.cells[i], c.force, c.proximity);
    }
    return memory;
  }

  /// The areas where force readings are held: the contacts. Time is bounded: per pressed cell a constant.
  /// What else is touched (the second argument) is nothing to a skin.
  [[nodiscard]] Pressed pressed(const Memory& memory, const auto&) const noexcept { return pressed(memory); }
  [[nodiscard]] Pressed pressed(const Memory& memory) const noexcept {
    Pressed areas;
    each_pressed(memory, [&](std::size_t i, const T& push) SKINCTL_INLINE_LAMBDA {
      const auto& p = tables_.cells.place(i);
      const float* u = tables_.cells[i].row;
      const float unit[6] = {u[0], u[1], u[2], u[3], u[4], u[5]};
      areas.add(tables_.patch_of(i).link, {T(p[0]), T(p[1]), T(p[2])}, unit, push);
    });
    return areas;
  }
  /// Calls `f(i, push)` for each cell whose force reading is held, in the order of the patches, with its push
  /// > 0 [N].
  template <class F>
  SKINCTL_INLINE void each_pressed(const Memory& memory, F&& f) const noexcept {
    memory.each_cell(&BlockStates::pressed, 0, size(), [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const T push = tables_.template push_on<Reading::force>(tables_.cells.seat(i),
                                                              tables_.weigh(i, memory.records[i].held));
      if (push > T(0)) f(i, push);
    });
  }
  /// The places of all cells, in the order of the patches.
  [[nodiscard]] SKINCTL_COLD std::vector<CellPlace> places() const {
    std::vector<CellPlace> all;
    for (std::size_t i = 0; i < size(); ++i) {
      const PatchRow<T>& patch = tables_.patch_of(i);
      const auto& p = tables_.cells.place(i);
      const float* u = tables_.cells[i].row;
      all.push_back({patch.link,
                     patch.number,
                     {double(p[0]), double(p[1]), double(p[2])},
                     {-double(u[0]), -double(u[1]), -double(u[2])}});
    }
    return all;
  }

  /// Calls `f(link, force, moment, gain)` for up to `most` cells of each patch, evenly over its list (of each
  /// 8192 cells of a larger one): the cell's unit wrench about the link's origin, and w_f [N per unit of its
  /// force readings].
  template <class F>
  void each_cell(F&& f, std::size_t most = ~std::size_t(0)) const {
    for (const PatchRow<T>& patch : tables_.patches) {
      const std::size_t taken = patch.count < most ? patch.count : most;
      for (std::size_t n = 0; n < taken; ++n) {
        const std::size_t i = patch.first + n * patch.count / taken;
        const float* u = tables_.cells[i].row;
        f(patch.link, Xyz<T>{T(u[0]), T(u[1]), T(u[2])}, Xyz<T>{T(u[3]), T(u[4]), T(u[5])},
          tables_.share(i) * static_cast<double>(patch.force_gain) / CellCounts::force_unit);
      }
    }
  }

  /// Number of silent cells: never received, or not within `max_age`.
  [[nodiscard]] std::size_t silent(const Memory& memory) const noexcept { return size() - memory.heard; }
  /// Number of cells that feel: received within `max_age`, and with a gain.
  [[nodiscard]] std::size_t usable(const Memory& memory) const noexcept {
    return memory.heard - numb(memory, 0, size());
  }
  /// How much of the skin feels, also of its worst patch (of 8192 cells of a larger one).
  [[nodiscard]] Coverage coverage(const Memory& memory) const noexcept {
    Coverage out;
    for (const PatchRow<T>& patch : tables_.patches)
      out.add(memory.heard_from(patch.first, patch.count) - numb(memory, patch.first, patch.count),
              patch.count);
    return out;
  }
  /// Upper bound of the proximity readings in [0, 1] of the cells on link `I`: at least the gate's opening
  /// threshold, below which nothing passes; 1 if one of the cells is silent and its reading unknown, or if
  /// there is none. A link that cannot have a cell does not compile.
  template <std::size_t I>
  [[nodiscard]] T nearest(const Memory& memory) const noexcept {
    static_assert((Links >> I) & 1u, "no skin on this link: it sees nothing");
    std::int32_t most = 0, hidden = 0;
    bool all = true, any = false;
    for (const PatchRow<T>& patch : tables_.patches) {
      if (patch.link != I) continue;
      memory.each_cell(&BlockStates::seeing, patch.first, patch.count, [&](std::size_t i) {
        const std::int32_t seen = memory.records[i].held.proximity + tables_.hidden_below(i);
        most = seen > most ? seen : most;
      });
      hidden = patch.hidden > hidden ? patch.hidden : hidden;
      all = all && memory.hears_all_from(patch.first, patch.count);
      any = true;
    }
    const T reading = T(most > hidden ? most : hidden) * T(CellCounts::proximity_unit);
    return any && all && reading < T(1) ? reading : T(1);
  }
  /// The counts of the `i`-th cell's last sample (in the order of the patches) after the gates; 0 if silent.
  [[nodiscard]] CellCounts held(const Memory& memory, std::size_t i) const noexcept {
    SKINCTL_EXPECTS(i < size(), "a cell of this skin");
    return memory.hears(i) ? memory.records[i].held : CellCounts{};
  }
  /// Index of the cell `id` in the order of the patches; `size()` if no patch has it.
  [[nodiscard]] std::size_t index(std::uint32_t id) const noexcept {
    const std::size_t i = tables_.cells.key(id).index();
    return i < size() ? i : size();
  }
  [[nodiscard]] const SkinSettings& settings() const noexcept { return tables_.settings; }
  /// Bytes of the tables, which do not change: beside those of a `Memory` [B].
  [[nodiscard]] std::size_t table_bytes() const noexcept { return tables_.bytes(); }
  /// Whether another skin has the same cells at the same places: it then understands this one's memory,
  /// whatever its gains and gates.
  [[nodiscard]] bool understands(const SkinCore& other) const noexcept {
    return tables_.cells == other.tables_.cells;
  }

 protected:
  SKINCTL_COLD SkinCore(const SkinSettings& settings, std::size_t cells) : tables_(settings, cells) {
    settings.check();
  }

  SkinTables<T, Tuned> tables_;

 private:
  /// Of `count` cells from `first` on those that are heard and have no gain.
  [[nodiscard]] std::size_t numb(const Memory& memory, std::size_t first, std::size_t count) const noexcept {
    std::size_t n = 0;
    for (const std::uint32_t i : tables_.numb)
      n += i >= first && i - first < count && memory.hears(i) ? 1u : 0u;
    return n;
  }
  /// The front end that was given, or the last argument.
  template <class Front, class... Rest>
  static SKINCTL_INLINE auto& either(Front& front, Rest&...) noexcept {
    return front;
  }
  /// The wrenches of the held readings to each of `count` parts.
  template <class Means>
  SKINCTL_INLINE void write_held(const Memory& memory, Means* means, std::size_t count) const noexcept {
    constexpr bool apart = std::is_same_v<Means, Touch>;
    LinkRows<Wrenches> force, proximity;
    const ExactSums* sums = memory.sums.data();
    for (const PatchRow<T>& patch : tables_.patches) {
      const CellUnit& any = tables_.cells[patch.first];
      force.add(patch.slot, patch.force_gain, sums->force, any);
      (apart ? proximity : force).add(patch.slot, patch.proximity_gain, sums->proximity, any);
      ++sums;
    }
    for (std::size_t j = 0; j < count; ++j) {
      if constexpr (apart) {
        force.write(means[j].force);
        proximity.write(means[j].proximity);
      } else {
        force.write(means[j]);
      }
    }
  }
  /// Adds the impulse that is owed to each of `count` parts of an interval.
  template <class Means>
  static SKINCTL_NOINLINE void pay(Memory& memory, const T& per_whole, Means* means,
                                   std::size_t count) noexcept {
    for (std::size_t j = 0; j < count; ++j) {
      if constexpr (std::is_same_v<Means, Touch>) {
        means[j].force += per_whole * memory.owed.force;
        means[j].proximity += per_whole * memory.owed.proximity;
      } else {
        means[j] += per_whole * memory.owed.force;
      }
    }
    memory.owed = {};
    memory.owes = false;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
