// SPDX-License-Identifier: BSD-3-Clause
// Reception: takes the samples of one interval, the usual ones by a short path.
#pragma once

#include <span>

#include "skinctl/tactile/detail/cell_changes.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The front end of a skin that trusts its cells: the readings are those of the samples.
template <class Kind, Real T>
struct AsSent {
  const SkinTables<Kind, T>& tables;
  [[nodiscard]] SKINCTL_INLINE CountsOf<Kind> reading(std::size_t i,
                                                      const SampleOf<Kind>& sample) const noexcept {
    return counts_of<Kind>(tables.counts(i, sample));
  }
};

/// Takes the samples of one interval. `means` starts with the wrenches of the previous sums; every change of
/// a cell's push is added when it occurs.
///
/// The usual sample is taken on a path of its own: of a cell that is heard and not fading, not ahead of the
/// interval's end, with a ramp that began within the time for which missing impulse is added. The mean over
/// an interval of length h in one part is then `jump (2 (to - t) + min(gap, ramp)) / 2h`, for a sample at t
/// that follows the last one after `gap`, without a division, and `jump (...)` add up for each link until all
/// samples have been taken. What is not usual is taken by the rules one by one.
template <class Kind, Real T, class Memory, class Means>
class Reception : public CellChanges<Kind, T, Memory, Means> {
  using Changes = CellChanges<Kind, T, Memory, Means>;
  using Changes::max_age_, Changes::hold_, Changes::ramp_;
  using Changes::tables_, Changes::memory_, Changes::parts_, Changes::means_;
  using typename Changes::Counts, typename Changes::Weighed;
  using Sample = SampleOf<Kind>;

 public:
  SKINCTL_INLINE Reception(const SkinTables<Kind, T>& tables, Memory& memory, const Parts<T>& parts,
                           Means* means) noexcept
      : Changes(tables, memory, parts, means),
        by_id_(tables.by_id.data()),
        rows_(tables.cells.data()),
        patches_(tables.patches.data()),
        last_id_(tables.by_id.size() - 1),
        cells_(tables.cells.size()),
        to_(static_cast<std::uint64_t>(parts.to.count())),
        latest_(parts.reach - ramp_ < hold_ / 2 ? parts.reach - ramp_ : hold_ / 2),
        longest_(hold_ - latest_) {}

  /// Takes the samples.
  template <class Front>
  SKINCTL_INLINE Status take(std::span<const Sample> samples, Front& front) const noexcept {
    Status status;
    if (samples.empty()) return status;
    Means pushes{};  // [N ns], twice
    const bool usual = has_usual();
    for (const Sample& sample : samples)
      if (!usual || !take_usual(sample, front, pushes)) status |= take_any(sample, front);
    const T share = T(0.5e-9) * parts_.per_whole;
    if constexpr (Changes::apart) {
      means_->force += share * pushes.force;
      means_->proximity += share * pushes.proximity;
    } else {
      *means_ += share * pushes;
    }
    return status;
  }

 private:
  /// Whether samples of this interval can be usual: the interval has a length, and no time is so far from 0
  /// that a difference of two overflows.
  [[nodiscard]] SKINCTL_INLINE bool has_usual() const noexcept {
    constexpr std::uint64_t far = std::uint64_t(1) << 61;
    const auto to = static_cast<std::uint64_t>(parts_.to.count());
    return parts_.from != parts_.to && to + far < 2 * far && parts_.reach < far && parts_.reach >= ramp_ &&
           max_age_ < far;
  }

  template <class Front>
  [[nodiscard]] SKINCTL_INLINE bool take_usual(const Sample& sample, Front& front,
                                               Means& pushes) const noexcept {
    const std::size_t i = by_id_[sample.cell < last_id_ ? sample.cell : last_id_];
    if (i >= cells_ || !believable(sample)) [[unlikely]]
      return false;
    CellRecord<Kind>& cell = memory_.records[i];
    // Neither ahead nor so late that its ramp began too early; after the last one, which was not fading by
    // the end however late this one is, and is not of a later time.
    const auto time = static_cast<std::uint64_t>(sample.time.count());
    const std::uint64_t late = to_ - time;
    const std::uint64_t gap = time - static_cast<std::uint64_t>(cell.stamp.count());
    if (late > latest_ || gap - 1 >= longest_ || !memory_.hears(i)) [[unlikely]]
      return false;
    cell.stamp = sample.time;
    const CellRow<Kind>& row = rows_[i];
    const PatchRow<Kind, T>& patch = patches_[row.patch];
    const Counts old = cell.held, now = patch.pass(row, raw_of<Kind>(front.reading(i, sample)), old);
    if (now == old) return true;
    cell.held = now;
    memory_.follow(i);
    const Weighed change = Changes::less(row.weigh(now), row.weigh(old));
    memory_.sums[row.patch].add(row, change);
    if (parts_.count != 1) {
      this->spread(row, change, Nanoseconds(sample.time.count() - static_cast<std::int64_t>(gap)),
                   sample.time);
      return true;
    }
    const T share = static_cast<T>(static_cast<std::int64_t>(2 * late + (gap < ramp_ ? gap : ramp_)));
    Changes::add_wrenches(row, patch, change, share, pushes);
    return true;
  }

  /// Takes any sample, in any interval.
  template <class Front>
  SKINCTL_NOINLINE Status take_any(const Sample& sample, Front& front) const noexcept {
    if (const Status bad = check(sample); bad.any()) return bad;
    const std::size_t i = tables_.index(sample.cell);
    if (i >= tables_.cells.size()) return Reason::sample_unknown;
    CellRecord<Kind>& cell = memory_.records[i];
    const bool ahead = cell.stamp > parts_.to;  // the clock was set back since
    Nanoseconds last = ahead ? Nanoseconds::min() : cell.stamp;
    const Nanoseconds time = sample.time < parts_.to ? sample.time : parts_.to;
    if (sample.time <= last || time <= last) return Reason::time_backwards;
    if (sample.time > parts_.to &&
        span(parts_.to, sample.time) > static_cast<std::uint64_t>(tables_.times.max_ahead.count()))
      return Reason::sample_out_of_range;
    if (span(time, parts_.to) >= max_age_) return Reason::sample_stale;
    if (ahead) last = time - nanoseconds_of(ramp_);

    const Counts open = memory_.hears(i) ? cell.held : Counts{};
    Nanoseconds& oldest = memory_.oldest[i / 64];
    if (time < oldest) oldest = time;
    cell.stamp = time;
    const Counts raw = raw_of<Kind>(front.reading(i, sample));
    this->change_to(i, tables_.patch_of(i).pass(tables_.cells[i], raw, open), last, time);
    return {};
  }

  // What the usual path reads, apart from all that it writes.
  const std::uint32_t* by_id_;
  const CellRow<Kind>* rows_;
  const PatchRow<Kind, T>* patches_;
  std::size_t last_id_, cells_;
  std::uint64_t to_;                ///< end of the interval [ns]
  std::uint64_t latest_, longest_;  ///< of a usual sample, bounds of age and gap to the last one [ns]
};

}  // namespace detail
SKINCTL_END_NAMESPACE
