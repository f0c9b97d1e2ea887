// Reception: takes the samples of one interval, the usual ones by a short path.
#pragma once

#include <span>

#include "skinctl/tactile/detail/cell_changes.hpp"
#include "skinctl/tactile/detail/link_rows.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The front end of a skin that trusts its cells: the readings are those of the samples.
struct AsSent {
  SKINCTL_INLINE CellCounts reading(std::size_t, const CellSample& sample) const noexcept {
    return counts(sample);
  }
};

/// One reception. `means` starts with the wrenches of the previous sums; every change of a cell's push is
/// added when it occurs. `Means` is a `LinkWrenches`, or a `TouchWrenches` for forces and proximities apart.
///
/// The usual sample is taken on a path of its own: of a cell that is heard and not fading, not ahead of the
/// interval's end, with a ramp that began within the time for which missing impulse is added. The mean over an interval of one part is then
/// `jump (2 (to - t) + min(gap, ramp)) / 2h`, without a division, and `jump (...)` add up for each link until
/// all samples have been taken. What is not usual is taken out of line, by the same rules one by one.
template <Real T, class Tables, class Memory, class Means>
class Reception : public CellChanges<T, Tables, Memory, Means> {
  using Changes = CellChanges<T, Tables, Memory, Means>;
  using Changes::apart, Changes::tables_, Changes::memory_, Changes::cells_, Changes::parts_, Changes::means_;
  using Changes::max_age_, Changes::hold_, Changes::ramp_, Changes::change_to;
  /// Of forces and proximities; all in the first, unless they are apart.
  using Pushes = LinkRows<typename decltype(Memory::owed)::Wrenches>;

 public:
  SKINCTL_INLINE Reception(const Tables& tables, Memory& memory, std::size_t cells, const Parts<T>& parts,
                           Means* means) noexcept
      : Changes(tables, memory, cells, parts, means),
        max_ahead_(static_cast<std::uint64_t>(tables.settings.max_ahead.count())) {}

  /// Takes the samples.
  template <class Front>
  SKINCTL_INLINE Status take(std::span<const CellSample> samples, Front& front) const noexcept {
    Status status;
    if (samples.empty()) return status;
    if (!takes_usual()) {
      for (const CellSample& sample : samples) status |= take_any(sample, front);
      return status;
    }
    Pushes pushes[apart ? 2 : 1];
    const Usual usual(*this);
    for (std::size_t first = 0; first < samples.size(); first += Crossed::most) {
      const std::size_t rest = samples.size() - first;
      Crossed crossed;
      for (const CellSample& sample : samples.subspan(first, rest < Crossed::most ? rest : Crossed::most)) {
        if (!take_usual(usual, sample, front, pushes, crossed)) [[unlikely]]
          status |= take_any(sample, front);
      }
      for (std::size_t k = 0; k < crossed.count; ++k) memory_.follow(crossed.cell[k]);
    }
    const T share = T(0.5e-9) * parts_.per_whole;
    if constexpr (apart) {
      pushes[0].add_to(means_->force, share);
      pushes[1].add_to(means_->proximity, share);
    } else {
      pushes[0].add_to(*means_, share);
    }
    return status;
  }

 private:
  /// Whether there is a usual sample: the interval has a length, and no time is so far from 0
  /// that a difference of two overflows.
  [[nodiscard]] SKINCTL_INLINE bool takes_usual() const noexcept {
    constexpr std::uint64_t far = std::uint64_t(1) << 61;
    const auto to = static_cast<std::uint64_t>(parts_.to.count());
    return parts_.from != parts_.to && to + far < 2 * far && parts_.reach < far && parts_.reach >= ramp_ &&
           max_age_ < far;
  }

  /// What the usual path reads, as values of its own: nothing that it writes can change them, so they stay in registers.
  struct Usual {
    CellTable::Keys keys;
    std::size_t cells;
    const CellUnit* units;
    const PatchRow<T>* patches;
    CellRecord* records;
    ExactSums* sums;
    GatePair gates;
    std::uint64_t to, latest, longest, ramp;  ///< [ns]
    bool whole;                               ///< the interval is one part
    SKINCTL_INLINE explicit Usual(const Reception& r) noexcept
        : keys(r.tables_.cells.keys()),
          cells(r.cells_),
          units(&r.tables_.cells[0]),
          patches(r.tables_.patches.data()),
          records(r.memory_.records.data()),
          sums(r.memory_.sums.data()),
          gates(r.tables_.gates),
          to(static_cast<std::uint64_t>(r.parts_.to.count())),
          latest(r.parts_.reach - r.ramp_ < r.hold_ / 2 ? r.parts_.reach - r.ramp_ : r.hold_ / 2),
          longest(r.hold_ - latest),
          ramp(r.ramp_),
          whole(r.parts_.count == 1) {}
  };
  /// Cells that began or ceased to be pressed or to see, whose states are brought up to date after some samples: noted
  /// without a branch, which would come as the readings like.
  struct Crossed {
    static constexpr std::size_t most = 64;
    std::uint32_t cell[most];
    std::size_t count = 0;
    SKINCTL_INLINE void note(std::size_t i, bool crosses) noexcept {
      cell[count] = static_cast<std::uint32_t>(i);
      count += crosses ? 1u : 0u;
    }
  };
  template <class Front>
  [[nodiscard]] SKINCTL_INLINE bool take_usual(const Usual& at, const CellSample& sample, Front& front,
                                               Pushes* pushes, Crossed& crossed) const noexcept {
    if (sample.cell >= at.keys.last) [[unlikely]]
      return false;
    const CellKey& key = at.keys.first[sample.cell];
    const std::size_t i = key.index();
    if (i >= at.cells || !believable(sample)) [[unlikely]]
      return false;
    CellRecord& cell = at.records[i];
    // Neither ahead nor so late that its ramp began too early; after the last one, which was not fading by the end
    // however late this one is, and is not of a later time.
    const auto time = static_cast<std::uint64_t>(sample.time.count());
    const std::uint64_t late = at.to - time, gap = time - static_cast<std::uint64_t>(cell.stamp.count());
    if (late > at.latest) [[unlikely]]
      return false;
    if (gap - 1 >= at.longest) [[unlikely]]
      return false;
    if (cell.state < CellRecord::heard) [[unlikely]]
      return false;
    cell.stamp = sample.time;
    const CountPair old(cell.held), now = pass(at, i, reading(i, sample, front), old);
    const CellCounts passed = now.counts_of();
    if (std::bit_cast<std::uint32_t>(passed) == std::bit_cast<std::uint32_t>(cell.held)) return true;
    cell.held = passed;
    crossed.note(i, !now.open_as(old));
    const WideCounts change = tables_.weigh(i, now) - tables_.weigh(i, old);
    const CellUnit& cell_unit = at.units[i];
    const WideUnit<std::conditional_t<ExactSums::in_steps, T, double>> unit(cell_unit.row);
    if constexpr (ExactSums::in_steps) {
      at.sums[key.sums()].add(cell_unit, change.force(), change.proximity());
    } else {
      at.sums[key.sums()].add(unit, change.template as<0, double>(), change.template as<1, double>());
    }
    if (!at.whole) [[unlikely]] {
      this->spread(i, change, Nanoseconds(sample.time.count() - static_cast<std::int64_t>(gap)), sample.time);
      return true;
    }
    const PatchRow<T>& patch = at.patches[key.sums()];
    const T share = static_cast<T>(static_cast<std::int64_t>(2 * late + (gap < at.ramp ? gap : at.ramp)));
    const T force = patch.force_gain * change.template as<0, T>();
    const T proximity = patch.proximity_gain * change.template as<1, T>();
    const std::size_t slot = key.slot();
    const auto add = [&](const auto& wide) SKINCTL_INLINE_LAMBDA {
      if constexpr (apart) {
        wide.add_to(pushes[0].row[slot], share * force);
        wide.add_to(pushes[1].row[slot], share * proximity);
      } else {
        wide.add_to(pushes[0].row[slot], share * (force + proximity));
      }
    };
    if constexpr (std::is_same_v<T, double> || ExactSums::in_steps) {
      add(unit);
    } else {
      add(WideUnit<T>(cell_unit.row));
    }
    return true;
  }
  SKINCTL_INLINE CountPair pass(const Usual& at, std::size_t i, CountPair raw, CountPair old) const noexcept {
    if constexpr (Tables::tuned) {
      return static_cast<void>(at), tables_.pass(i, raw, old);
    } else {
      return static_cast<void>(i), at.gates.pass(raw, old);
    }
  }
  template <class Front>
  static SKINCTL_INLINE CountPair reading(std::size_t i, const CellSample& sample, Front& front) noexcept {
    if constexpr (std::is_same_v<std::remove_cv_t<Front>, AsSent>) {
      return static_cast<void>(i), CountPair(sample);
    } else {
      return CountPair(front.reading(i, sample));
    }
  }

  /// Any sample, any interval.
  template <class Front>
  SKINCTL_NOINLINE Status take_any(const CellSample& sample, Front& front) const noexcept {
    if (const Status bad = check(sample); bad.any()) return bad;
    const CellKey key = tables_.cells.key(sample.cell);
    const std::size_t i = key.index();
    if (i >= cells_) return Reason::sample_unknown;
    CellRecord& cell = memory_.records[i];
    const bool ahead = cell.stamp > parts_.to;  // the clock was set back since
    Nanoseconds last = ahead ? Nanoseconds::min() : cell.stamp;
    const Nanoseconds time = sample.time < parts_.to ? sample.time : parts_.to;
    if (sample.time <= last || time <= last) return Reason::time_backwards;
    if (sample.time > parts_.to && span(parts_.to, sample.time) > max_ahead_)
      return Reason::sample_out_of_range;
    if (span(time, parts_.to) >= max_age_) return Reason::sample_stale;
    if (ahead) last = time - nanoseconds_of(ramp_);

    const CellCounts open = memory_.hears(i) ? cell.held : CellCounts{};
    Nanoseconds& oldest = memory_.oldest[i / 64];
    if (time < oldest) oldest = time;
    cell.stamp = time;
    change_to(i, tables_.pass(i, front.reading(i, sample), open), last, time);
    return {};
  }

  std::uint64_t max_ahead_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
