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
/// `jump (2 (to - t) + min(gap, ramp)) / 2h`, without a division, and the pushes add up for each link until
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

  /// Takes the samples. `Ahead` > 0: what a sample touches is fetched so many samples before.
  template <std::size_t Ahead, class Front>
  SKINCTL_INLINE Status take(std::span<const CellSample> samples, Front& front) const noexcept {
    Status status;
    if (samples.empty()) return status;
    if (!takes_usual()) {
      for (const CellSample& sample : samples) status |= take_any(sample, front);
      return status;
    }
    Pushes pushes[apart ? 2 : 1];
    const Usual usual(*this);
    const auto keys = tables_.cells.keys();
    for (const CellSample& sample : samples) {
      if constexpr (Ahead > 0)
        fetch<Ahead>(keys, samples, static_cast<std::size_t>(&sample - samples.data()));
      if (!take_usual(usual, keys, sample, front, pushes)) [[unlikely]]
        status |= take_any(sample, front);
    }
    if constexpr (apart) {
      pushes[0].add_to(means_->force);
      pushes[1].add_to(means_->proximity);
    } else {
      pushes[0].add_to(*means_);
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

  /// What the usual path compares with, [ns].
  struct Usual {
    std::uint64_t to, latest, hold, ramp;
    T share;
    SKINCTL_INLINE explicit Usual(const Reception& r) noexcept
        : to(static_cast<std::uint64_t>(r.parts_.to.count())),
          latest(r.parts_.reach - r.ramp_),
          hold(r.hold_),
          ramp(r.ramp_),
          share(T(0.5e-9) * r.parts_.per_whole) {}
  };
  template <class Front>
  [[nodiscard]] SKINCTL_INLINE bool take_usual(const Usual& at, const CellTable::Keys& keys,
                                               const CellSample& sample, Front& front,
                                               Pushes* pushes) const noexcept {
    const CellKey key = keys.of(sample.cell);
    const std::size_t i = key.index();
    if (i >= cells_ || !believable(sample)) [[unlikely]]
      return false;
    CellRecord& cell = memory_.records[i];
    // Neither ahead nor so late that its ramp began too early; after the last one, which is neither fading nor
    // of a later time.
    const std::uint64_t late = at.to - static_cast<std::uint64_t>(sample.time.count());
    const std::uint64_t silence = at.to - static_cast<std::uint64_t>(cell.stamp.count());
    if (late > at.latest || silence <= late || silence > at.hold || cell.state < CellRecord::heard)
        [[unlikely]]
      return false;
    const Nanoseconds last = cell.stamp;
    cell.stamp = sample.time;
    const CountPair old(cell.held), now = tables_.pass(i, reading(i, sample, front), old);
    const CellCounts passed = now.counts_of();
    if (std::bit_cast<std::uint32_t>(passed) == std::bit_cast<std::uint32_t>(cell.held)) return true;
    cell.held = passed;
    const std::uint32_t state = CellRecord::state_of(now);
    if (state != cell.state) [[unlikely]]
      memory_.enter(i, state);
    const CountPair change = tables_.weigh(i, now) - tables_.weigh(i, old);
    const float* const row = tables_.cells[i].row;
    const WideUnit<std::conditional_t<ExactSums::in_steps, T, double>> unit(row);
    if constexpr (ExactSums::in_steps) {
      memory_.sums[key.sums()].add(tables_.cells[i], change.force(), change.proximity());
    } else {
      memory_.sums[key.sums()].add(unit, change.template as<0, double>(), change.template as<1, double>());
    }
    const PatchRow<T>& patch = tables_.patches[key.sums()];
    if (parts_.count != 1) [[unlikely]] {
      this->spread(i, change, last, sample.time);
      return true;
    }
    const std::uint64_t turn = late + at.ramp, begun = turn < silence ? turn : silence;  // before the end
    const T share = static_cast<T>(static_cast<std::int64_t>(late + begun)) * at.share;
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
      add(WideUnit<T>(row));
    }
    return true;
  }
  template <class Front>
  static SKINCTL_INLINE CountPair reading(std::size_t i, const CellSample& sample, Front& front) noexcept {
    if constexpr (std::is_same_v<std::remove_cv_t<Front>, AsSent>) {
      return static_cast<void>(i), CountPair(sample);
    } else {
      return CountPair(front.reading(i, sample));
    }
  }
  /// The key of a sample to come, and the record and unit wrench of a nearer one.
  template <std::size_t Ahead>
  SKINCTL_INLINE void fetch(const CellTable::Keys& keys, std::span<const CellSample> samples,
                            std::size_t k) const noexcept {
    if (k + 2 * Ahead < samples.size()) __builtin_prefetch(&keys.of(samples[k + 2 * Ahead].cell));
    if (k + Ahead >= samples.size()) return;
    const std::size_t i = keys.of(samples[k + Ahead].cell).index();
    if (i >= cells_) return;
    __builtin_prefetch(&memory_.records[i], 1);
    __builtin_prefetch(&tables_.cells[i]);
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
