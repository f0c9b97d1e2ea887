// SPDX-License-Identifier: BSD-3-Clause
// Changes of the force of single cells within an interval, and their shares of the mean wrenches.
#pragma once

#include "skinctl/tactile/detail/held_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Adds the changes of single cells to sums and mean wrenches, by any rule and in any interval. `Means` is a
/// `LinkWrenches`, or a `TouchWrenches` that separates contacts from what is only seen.
template <class Kind, Real T, class Memory, class Means>
class CellChanges {
 public:
  using Counts = PerChannel<Kind, std::uint16_t>;
  using Weighed = PerChannel<Kind, std::int32_t>;
  static constexpr bool apart = is_apart<Means>;

  SKINCTL_INLINE CellChanges(const SkinTables<Kind, T>& tables, Memory& memory, const Parts<T>& parts,
                             Means* means) noexcept
      : tables_(tables),
        memory_(memory),
        parts_(parts),
        means_(means),
        max_age_(static_cast<std::uint64_t>(tables.times.max_age.count())),
        hold_(static_cast<std::uint64_t>((tables.times.max_age - tables.times.fade).count())),
        ramp_(static_cast<std::uint64_t>(tables.times.ramp.count())) {}

  /// Gives a cell that is heard the reading `raw` from the end of the interval on, by a change within the
  /// last `ramp` of it. Nothing before the interval is revised, and the cell goes on ageing. A cell that is
  /// silent or fades stays as it is.
  SKINCTL_NOINLINE void revise(std::size_t i, const Counts& raw) const noexcept {
    CellRecord<Kind>& cell = memory_.records[i];
    if (!memory_.hears(i) || (cell.stamp < parts_.to && span(cell.stamp, parts_.to) > hold_)) return;
    const CellRow<Kind>& row = tables_.cells[i];
    const Counts old = cell.held, passed = tables_.patch_of(i).pass(row, raw, old);
    if (passed == old) return;
    cell.held = passed;
    memory_.follow(i);
    const Weighed was = row.weigh(old), is = row.weigh(passed);
    memory_.sums[row.patch].add(row, less(is, was));
    if (parts_.from != parts_.to) spread(row, less(is, was), parts_.from, parts_.to);
  }

  /// Fades the forces of cells that have fallen silent; reports whether any cell is silent.
  SKINCTL_INLINE Status age() const noexcept {
    const std::size_t blocks = (tables_.cells.size() + 63) / 64;
    // No time is further back than the earliest one.
    const Nanoseconds limit = elapsed(Nanoseconds::min(), parts_.to) > nanoseconds_of(hold_)
                                  ? parts_.to - nanoseconds_of(hold_)
                                  : Nanoseconds::min();
    for (std::size_t b = 0; b < blocks; ++b)
      if (memory_.oldest[b] < limit) age_block(b, limit);
    return memory_.heard == tables_.cells.size() ? Status{} : Status{Reason::sample_stale};
  }

 protected:
  /// Lets cell `i`, which holds its reading of time `last`, hold the counts `passed` from `time` on.
  void change_to(std::size_t i, const Counts& passed, Nanoseconds last, Nanoseconds time) const noexcept {
    CellRecord<Kind>& cell = memory_.records[i];
    const bool was_heard = memory_.hears(i);
    const bool lapsed = span(last, parts_.to) > hold_;
    const Counts old = was_heard || lapsed ? cell.held : Counts{};
    cell.held = passed;
    memory_.enter(i, true);
    const bool fading = lapsed && old != Counts{};
    if (passed == old && !fading) return;
    const CellRow<Kind>& row = tables_.cells[i];
    const Weighed was = row.weigh(old), is = row.weigh(passed);
    memory_.sums[row.patch].add(row, less(is, was_heard ? was : Weighed{}));
    if (fading) {
      change_of_fading(row, was, is, last, time, was_heard);
    } else {
      spread(row, less(is, was), last, time);
    }
  }

  /// Adds a change of a cell by a ramp from `last` to `time`, and the impulse that is missing before the
  /// interval.
  SKINCTL_NOINLINE void spread(const CellRow<Kind>& cell, const Weighed& change, Nanoseconds last,
                               Nanoseconds time) const noexcept {
    const Ramp<T> ramp = ramp_between(last, time);
    add_means(cell, change, ramp.integral(T(0)) - ramp.integral(parts_.back),
              [&ramp](const T& t) SKINCTL_INLINE_LAMBDA { return ramp.integral(t); });
  }

  /// Adds `share` times the wrenches of a cell by weighed counts, to a `Means` or to what is owed.
  template <class W>
  static SKINCTL_INLINE void add_wrenches(const CellRow<Kind>& cell, const PatchRow<Kind, T>& patch,
                                          const Weighed& counts, const T& share, W& to) noexcept {
    add_use<false>(cell, patch, counts, share, use_of<false>(to).data[cell.slot]);
    if constexpr (apart) add_use<true>(cell, patch, counts, share, use_of<true>(to).data[cell.slot]);
  }
  [[nodiscard]] static SKINCTL_INLINE Weighed less(Weighed a, const Weighed& b) noexcept {
    for (std::size_t c = 0; c < a.size(); ++c) a[c] -= b[c];
    return a;
  }

  const SkinTables<Kind, T>& tables_;
  Memory& memory_;
  const Parts<T>& parts_;
  Means* means_;
  std::uint64_t max_age_, hold_, ramp_;

 private:
  /// Whether channel `c` acts along line `line` and belongs to what is `seen`, or to contacts; to both where
  /// the two are not separate.
  static constexpr bool belongs(std::size_t c, bool seen, std::size_t line) noexcept {
    return KindTable<Kind>::line[c] == line && (!apart || KindTable<Kind>::is_seen(c) == seen);
  }
  template <bool Seen>
  static SKINCTL_INLINE void add_use(const CellRow<Kind>& cell, const PatchRow<Kind, T>& patch,
                                     const Weighed& counts, const T& share, T* wrench) noexcept {
    const auto along = [&]<std::size_t Line>() SKINCTL_INLINE_LAMBDA {
      constexpr auto mine = [](std::size_t c) { return belongs(c, Seen, Line); };
      if constexpr (KindTable<Kind>::count(mine, KindTable<Kind>::pushing) > 0) {
        T push(0);
        each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
          if constexpr (mine(c)) push = push + patch.gain[c] * real_of<T>(counts[c]);
        });
        patch.add_unit(cell.unit[Line], T(share * push), wrench);
      }
    };
    [&]<std::size_t... L>(std::index_sequence<L...>) SKINCTL_INLINE_LAMBDA {
      (along.template operator()<L>(), ...);
    }(std::make_index_sequence<KindTable<Kind>::lines>{});
  }
  /// Adds pushes by `counts` times a share that changes in time, as its mean over each part of the interval.
  ///
  /// @param missing   integral of the share before the interval [s]: spread evenly over the whole interval;
  ///                  without a length it goes to the next one.
  /// @param integral  integral of the share up to a time [s].
  template <class Integral>
  SKINCTL_INLINE void add_means(const CellRow<Kind>& cell, const Weighed& counts, const T& missing,
                                const Integral& integral) const noexcept {
    const PatchRow<Kind, T>& patch = tables_.patches[cell.patch];
    if (parts_.from == parts_.to) [[unlikely]] {
      if constexpr (apart) {
        add_wrenches(cell, patch, counts, missing, memory_.owed);
      } else {
        add_wrenches(cell, patch, counts, missing, memory_.owed.force);
      }
      memory_.owes = true;
      return;
    }
    const T evenly = missing * parts_.per_whole;
    T before = integral(T(0));
    for (std::size_t j = 0; j < parts_.count; ++j) {
      const T after = integral(parts_.length * static_cast<T>(j + 1));
      add_wrenches(cell, patch, counts, T(evenly + (after - before) * parts_.per_length), means_[j]);
      before = after;
    }
  }
  /// Adds the change of a cell that was fading or silent: a ramp from the force that remained, at whose start
  /// the fading ends.
  void change_of_fading(const CellRow<Kind>& cell, const Weighed& was, const Weighed& is, Nanoseconds last,
                        Nanoseconds time, bool was_heard) const noexcept {
    const Ramp<T> ramp = ramp_between(last, time), loss = loss_since(last);
    const T stop = ramp.start(), left = T(1) - loss.value(stop);
    const auto revised = [&](const T& t) {
      return loss.integral(t) - loss.integral_until(stop, t) - left * ramp.integral(t);
    };
    add_means(cell, was, revised(T(0)) - revised(parts_.back), [&](const T& t) {
      return (was_heard ? T(-loss.integral_until(stop, t)) : T(left * t)) - left * ramp.integral(t);
    });
    spread(cell, is, last, time);
  }

  /// The ramp of a cell's force from its reading at `last` to the later one at `time`.
  SKINCTL_INLINE Ramp<T> ramp_between(Nanoseconds last, Nanoseconds time) const noexcept {
    const std::uint64_t gap = span(last, time), length = gap < ramp_ ? gap : ramp_;
    return {seconds_after<T>(parts_.from, gap < ramp_ ? last : time - nanoseconds_of(ramp_)),
            seconds<T>(nanoseconds_of(length))};
  }
  /// The share of a reading that has faded because of the cell's silence since `stamp`.
  SKINCTL_INLINE Ramp<T> loss_since(Nanoseconds stamp) const noexcept {
    return {seconds_after<T>(parts_.from, stamp) + seconds<T>(nanoseconds_of(hold_)),
            seconds<T>(tables_.times.fade)};
  }

  /// Ages the cells of a block in which a stamp may lie before `limit`.
  SKINCTL_NOINLINE void age_block(std::size_t b, Nanoseconds limit) const noexcept {
    Nanoseconds oldest = Nanoseconds::max();
    for (std::uint64_t rest = memory_.states[b].heard; rest != 0; rest &= rest - 1) {
      const std::size_t i = 64 * b + static_cast<std::size_t>(std::countr_zero(rest));
      const Nanoseconds stamp = memory_.records[i].stamp;
      if (stamp < limit) age_cell(i);
      if (memory_.hears(i) && stamp < oldest) oldest = stamp;
    }
    memory_.oldest[b] = oldest;
  }
  /// Fades a cell that has been silent for longer than its reading is held.
  void age_cell(std::size_t i) const noexcept {
    const CellRecord<Kind>& cell = memory_.records[i];
    const CellRow<Kind>& row = tables_.cells[i];
    const Weighed held = row.weigh(cell.held);
    const bool ends = span(cell.stamp, parts_.to) >= max_age_;
    if (held != Weighed{}) {
      const Ramp<T> loss = loss_since(cell.stamp);
      add_means(row, held, T(0), [&](const T& t) { return -loss.integral(t); });
      if (ends) memory_.sums[row.patch].add(row, less({}, held));
    }
    if (ends) memory_.enter(i, false);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
