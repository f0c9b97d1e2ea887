// SPDX-License-Identifier: BSD-3-Clause
// SkinCore: what skins share, however many cells they have and wherever these are kept.
#pragma once

#include <span>
#include <tuple>

#include "skinctl/tactile/cell_place.hpp"
#include "skinctl/tactile/coverage.hpp"
#include "skinctl/tactile/detail/held_wrenches.hpp"
#include "skinctl/tactile/detail/reception.hpp"
#include "skinctl/tactile/kind_input.hpp"
#include "skinctl/tactile/pressed_area.hpp"
#include "skinctl/tactile/skin_settings.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The base of `Skin`, whose rules these are, and `SkinOf`: room for `Cells` cells of a kind in `Patches`
/// patches.
template <Topology M, Real T, LinkMask Links, std::size_t Cells, std::size_t Patches, SensorKind Kind>
class SkinCore : public sensor_sums::Summand, public SensesKind<Kind> {
  using Table = KindTable<Kind>;

 public:
  using scalar = T;
  using kind = Kind;
  using Sample = SampleOf<Kind>;
  using Counts = CountsOf<Kind>;
  using Settings = SettingsOf<Kind>;
  using Wrenches = LinkWrenches<M, Links, T>;
  using Touch = TouchWrenches<Wrenches>;
  using Pressed = PressedAreas<M, Links, T>;
  static constexpr LinkMask links = Links;
  static constexpr std::size_t cells = Cells, patches = Patches;  ///< room for so many; a `Skin` has as many

  /// The data that change from cycle to cycle. `Memory{}` has received no cell. Only the skin reads and
  /// writes its members.
  using Memory = SkinMemory<Kind, Cells, Patches, Wrenches>;

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
  /// @param means  `Wrenches`, or `Touch` for separate forces and proximities. A memory stays with one of
  ///               them.
  /// @param front  at most one: a front end that judges the cells, for example one that masks faulty ones.
  ///   `front.reading(i, sample) -> Counts` is called for each sample that is not ignored, in place of
  ///   `counts(sample)`; `i` is the cell's index. Then, once after all samples and before cells age,
  ///   `front.settle(revise)`: `revise(i, counts)` gives the cell another reading before the gates, reached
  ///   at `to` by a change within the last `ramp` of this interval. The cell goes on ageing; one that is
  ///   silent or already fades stays as it is. Revise a cell once at most.
  template <class Means, class... Front>
  Status receive(Memory& memory, std::span<const Sample> samples, Nanoseconds from, Nanoseconds to,
                 std::size_t substeps, Means* means, Front&&... front) const noexcept {
    static_assert(std::is_same_v<Means, Wrenches> || std::is_same_v<Means, Touch>,
                  "a skin receives its own Wrenches, or its Touch");
    static_assert(sizeof...(Front) <= 1, "a skin has one front end");
    SKINCTL_EXPECTS(substeps > 0 && means != nullptr, "at least one part of the interval");
    const Nanoseconds known = elapsed(memory.begin, from), back = tables_.times.catch_up;
    const auto parts = Parts<T>::of(from, to, substeps, known < back ? known : back);
    write_held(tables_, memory, means, substeps);
    if (memory.owes && parts.from != parts.to) [[unlikely]]
      pay(memory, parts.per_whole, means, substeps);
    const Reception<Kind, T, Memory, Means> reception(tables_, memory, parts, means);
    const AsSent<Kind, T> as_sent{tables_};
    Status status = reception.take(samples, std::get<0>(std::tie(front..., as_sent)));
    (front.settle([&](std::size_t i, const Counts& raw)
                      SKINCTL_INLINE_LAMBDA { reception.revise(i, raw_of<Kind>(raw)); }),
     ...);
    status |= reception.age();
    return parts.from == parts.to ? status | Reason::interval_empty : status;
  }

  /// `receive` as the touch of a scene, for a kind whose samples are in `sensed`.
  template <class Hexagons, class State, class Means, class... Front>
    requires(!std::is_same_v<Kind, Hexagon>)
  Status receive(Memory& memory, const Hexagons&, const KindInput<Kind>& sensed, const State&,
                 Nanoseconds from, Nanoseconds to, std::size_t substeps, Means* means,
                 Front&&... front) const noexcept {
    return receive(memory, std::span<const Sample>(sensed.taxels), from, to, substeps, means,
                   std::forward<Front>(front)...);
  }

  /// The wrenches of the held readings, as after the last `receive`; fading cells count fully until they are
  /// silent.
  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    Wrenches out;
    write_held(tables_, memory, &out, 1);
    return out;
  }
  /// The wrenches of the held readings, contacts separate from what is only seen.
  [[nodiscard]] Touch touch(const Memory& memory) const noexcept {
    Touch out;
    write_held(tables_, memory, &out, 1);
    return out;
  }
  /// The memory with its sums computed anew, cell by cell: bit for bit those of the events.
  [[nodiscard]] Memory recomputed(const Memory& given) const noexcept {
    Memory memory = given;
    memory.sums = {};
    for (std::size_t i = 0; i < size(); ++i)
      if (memory.hears(i))
        memory.sums[tables_.cells[i].patch].add(tables_.cells[i],
                                                tables_.cells[i].weigh(memory.records[i].held));
    return memory;
  }

  /// The areas where force readings are held: the contacts. Time is bounded: per pressed cell a constant. A
  /// second argument, the touch, is ignored.
  [[nodiscard]] Pressed pressed(const Memory& memory, const auto&...) const noexcept {
    Pressed areas;
    memory.each_cell(&BlockStates::pressed, 0, size(), [&](std::size_t i) {
      const auto held = tables_.cells[i].weigh(memory.records[i].held);
      PerChannel<Kind, T> push;
      for (std::size_t c = 0; c < push.size(); ++c)
        push[c] = tables_.patch_of(i).gain[c] * real_of<T>(held[c]);
      add_area(tables_, i, push, areas);
    });
    return areas;
  }
  /// Calls `f(i, pressure)` for each cell whose pressure is held, in the order of the patches, with its
  /// pressure > 0 [N].
  template <class F>
  SKINCTL_INLINE void each_pressed(const Memory& memory, F&& f) const noexcept {
    memory.each_cell(&BlockStates::pressed, 0, size(), [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const T push = tables_.patch_of(i).pressure(tables_.cells[i].weigh(memory.records[i].held));
      if (push > T(0)) f(i, push);
    });
  }
  /// The places of all cells, in the order of the patches.
  [[nodiscard]] SKINCTL_COLD std::vector<CellPlace> places() const {
    std::vector<CellPlace> all;
    for (std::size_t i = 0; i < size(); ++i) {
      const auto& X_LC = tables_.given[i].placed.X_LC;
      all.push_back({tables_.patch_of(i).link, tables_.cells[i].patch, X_LC.origin(), X_LC.axis_z()});
    }
    return all;
  }

  /// Calls `f(link, force, moment, gain)` for the contacts of up to `most` cells of each patch, evenly over
  /// its list: the unit wrench of a channel about the link's origin, and its gain [N per unit of its
  /// readings].
  template <class F>
  void each_cell(F&& f, std::size_t most = ~std::size_t(0)) const {
    for (const PatchRow<Kind, T>& patch : tables_.patches) {
      const std::size_t taken = patch.count < most ? patch.count : most;
      for (std::size_t n = 0; n < taken; ++n) {
        const std::size_t i = patch.first + n * patch.count / taken;
        each_channel<Kind>([&](auto c) {
          if constexpr (!Table::is_seen(c)) {
            T u[6] = {};
            patch.add_unit(tables_.cells[i].unit[Table::line[c]], T(1), u);
            const double share = double(tables_.cells[i].tuning[c].share) / ChannelTuning::whole;
            f(patch.link, Xyz<T>{u[0], u[1], u[2]}, Xyz<T>{u[3], u[4], u[5]},
              share * static_cast<double>(patch.gain[c]) / Table::step(c));
          }
        });
      }
    }
  }

  /// Number of silent cells: never received, or not within `max_age`.
  [[nodiscard]] std::size_t silent(const Memory& memory) const noexcept { return size() - memory.heard; }
  /// The least reading of a push on the middle of cell `i` that somebody notices, 0 <= i < size(): that opens
  /// the gate of its pressure; infinite for a cell that is silent or has no gain, of whose neighbours a plain
  /// skin knows nothing.
  [[nodiscard]] double noticed(const Memory& memory, std::size_t i) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    if (!memory.hears(i) || numb(memory, i, 1) > 0) return least;
    for (std::size_t c = 0; c < Table::pushing; ++c) {
      const double opens = (tables_.cells[i].tuning[c].opens + 1) * Table::step(c);
      if (Table::is_pressure(c) && opens < least) least = opens;
    }
    return least;
  }
  /// How much of the skin feels: cells that were received within `max_age`, and have a gain.
  [[nodiscard]] Coverage coverage(const Memory& memory) const noexcept {
    Coverage out;
    for (const PatchRow<Kind, T>& patch : tables_.patches)
      out.add(memory.heard_from(patch.first, patch.count) - numb(memory, patch.first, patch.count),
              patch.count);
    return out;
  }
  /// Upper bound of the proximity readings on link `Ix`, as shares of their greatest amount in [0, 1]: at
  /// least the gate's opening threshold, below which nothing passes; 1 if one of the cells is silent and its
  /// reading unknown, if there is none, or if this kind of cell sees nothing. A link that cannot have a cell
  /// does not compile.
  template <std::size_t Ix>
  [[nodiscard]] T max_proximity(const Memory& memory) const noexcept {
    static_assert((Links >> Ix) & 1u, "no skin on this link: it sees nothing");
    bool known = false;
    PerChannel<Kind, std::int32_t> most{};
    for (const PatchRow<Kind, T>& patch : tables_.patches) {
      if (patch.link != Ix) continue;
      memory.each_cell(&BlockStates::seeing, patch.first, patch.count, [&](std::size_t i) {
        for (std::size_t c = 0; c < most.size(); ++c) {
          const std::int32_t seen = memory.records[i].held[c] + tables_.cells[i].tuning[c].subtract;
          most[c] = seen > most[c] ? seen : most[c];
        }
      });
      for (std::size_t c = 0; c < most.size(); ++c)
        most[c] = patch.hidden[c] > most[c] ? patch.hidden[c] : most[c];
      if (memory.heard_from(patch.first, patch.count) < patch.count) return T(1);
      known = true;
    }
    T bound(0);
    each_channel<Kind>([&](auto c) {
      if constexpr (Table::is_seen(c)) {
        const T reading = T(most[c]) * T(Table::step(c) / Kind::channels[c].greatest);
        bound = reading > bound ? reading : bound;
      }
    });
    return known && Table::sees && bound < T(1) ? bound : T(1);
  }
  /// The counts of the `i`-th cell's last sample (in the order of the patches) after the gates; 0 if silent.
  [[nodiscard]] Counts held(const Memory& memory, std::size_t i) const noexcept {
    SKINCTL_EXPECTS(i < size(), "a cell of this skin");
    return memory.hears(i) ? counts_of<Kind>(memory.records[i].held) : Counts{};
  }
  /// The amounts of cell `i`'s channels that push, of a sample that passed `check`: by its calibration if it
  /// has one.
  [[nodiscard]] auto amounts(std::size_t i, const Sample& sample) const noexcept {
    return tables_.amounts(i, sample);
  }
  /// See `calibrated`.
  SKINCTL_COLD void calibrate(std::vector<ChannelCalibration<Kind>> calibration) {
    require(calibration.size() == 1 || calibration.size() == size(), "calibrated: calibrations of a skin",
            double(calibration.size()), "one for all cells, or one a cell");
    for (const auto& one : calibration) one.check();
    tables_.calibration = std::move(calibration);
  }
  /// Index of the cell `id` in the order of the patches; `size()` if no patch has it.
  [[nodiscard]] std::size_t index(std::uint32_t id) const noexcept {
    const std::size_t i = tables_.index(id);
    return i < size() ? i : size();
  }
  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
  /// Whether another skin has the same cells at the same places: it then understands this one's memory,
  /// whatever its gains and gates.
  [[nodiscard]] bool understands(const SkinCore& other) const noexcept {
    return tables_.same_cells(other.tables_);
  }

 protected:
  SKINCTL_COLD explicit SkinCore(const Settings& settings) : settings_(settings) {
    settings.check();
    tables_.times = {settings.max_age, settings.fade, settings.ramp, settings.catch_up, settings.max_ahead};
  }

  Settings settings_;
  SkinTables<Kind, T> tables_;

 private:
  /// Number of the `count` cells from `first` on that are heard and have no gain.
  [[nodiscard]] std::size_t numb(const Memory& memory, std::size_t first, std::size_t count) const noexcept {
    std::size_t n = 0;
    for (const std::uint32_t i : tables_.numb)
      n += i >= first && i - first < count && memory.hears(i) ? 1u : 0u;
    return n;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
