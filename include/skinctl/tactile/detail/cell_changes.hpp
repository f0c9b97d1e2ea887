// Changes of the force of single cells within an interval, and their shares of the mean wrenches.
#pragma once

#include "skinctl/tactile/detail/held_signal.hpp"
#include "skinctl/tactile/detail/skin_memory.hpp"
#include "skinctl/tactile/detail/skin_tables.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// An interval in equal parts; times within it are in seconds from its start.
template <Real T>
struct Parts {
  Nanoseconds from, to;
  std::size_t count;
  T length, per_length, per_whole;  ///< [s], [1/s]; 0 for an interval without length
  T back;                           ///< <= 0: start of the time for which missing impulse is added [s]
  std::uint64_t reach;              ///< from there to the end [ns]

  static Parts of(Nanoseconds from, Nanoseconds to, std::size_t count, Nanoseconds back) noexcept {
    const T whole = seconds<T>(elapsed(from, to));
    const T parts = static_cast<T>(count);
    if (!(whole > T(0))) return {from, from, count, T(0), T(0), T(0), -seconds<T>(back), 0};
    const std::uint64_t length = span(from, to), reach = length + span(0ns, back);
    return {from,
            to,
            count,
            whole / parts,
            parts / whole,
            T(1) / whole,
            -seconds<T>(back),
            reach < length ? ~std::uint64_t(0) : reach};
  }
};

/// What changes of single cells add to sums and means, by any rule and in any interval. `Means` is a
/// `LinkWrenches`, or a `TouchWrenches` for forces and proximities apart.
template <Real T, class Tables, class Memory, class Means>
class CellChanges {
 public:
  static constexpr bool apart = is_apart<Means>;

  SKINCTL_INLINE CellChanges(const Tables& tables, Memory& memory, std::size_t cells, const Parts<T>& parts,
                             Means* means) noexcept
      : tables_(tables),
        memory_(memory),
        cells_(cells),
        parts_(parts),
        means_(means),
        max_age_(static_cast<std::uint64_t>((tables.settings.max_age).count())),
        hold_(static_cast<std::uint64_t>((tables.settings.max_age - tables.settings.fade).count())),
        ramp_(static_cast<std::uint64_t>((tables.settings.ramp).count())),
        ramp_length_(seconds<T>(tables.settings.ramp)),
        ramp_slope_(T(1) / ramp_length_) {}

  /// Another reading for a cell that is heard: from `raw` at the end of the interval on, with a change within
  /// the last `ramp` of it. Nothing before the interval is revised, and the cell goes on ageing. One that is
  /// silent or fades stays as it is.
  SKINCTL_NOINLINE void revise(std::size_t i, CellCounts raw) const noexcept {
    CellRecord& cell = memory_.records[i];
    if (!memory_.hears(i) || (cell.stamp < parts_.to && span(cell.stamp, parts_.to) > hold_)) return;
    const CellCounts old = cell.held, passed = tables_.pass(i, raw, old);
    if (passed == old) return;
    cell.held = passed;
    if (const std::uint32_t state = CellRecord::state_of(passed); state != cell.state)
      memory_.enter(i, state);
    const CellSeat seat = tables_.cells.seat(i);
    const CellCounts was = tables_.weigh(i, old), is = tables_.weigh(i, passed);
    memory_.sums[seat.sums].add(tables_.cells[i], is.force - was.force, is.proximity - was.proximity);
    if (parts_.from == parts_.to) return;
    const Ramp<T> ramp = ramp_between(parts_.from, parts_.to);
    each_kind([&]<Reading R>() SKINCTL_INLINE_LAMBDA {
      const T jump = tables_.template push_on<R>(seat, is) - tables_.template push_on<R>(seat, was);
      add_means<R>(i, T(0), [&](const T& t) SKINCTL_INLINE_LAMBDA { return jump * ramp.integral(t); });
    });
  }

  /// Fades the forces of cells that have fallen silent; reports whether any cell is silent.
  SKINCTL_INLINE Status age() const noexcept {
    const std::size_t blocks = (cells_ + 63) / 64;
    // No time is further back than the earliest one.
    const Nanoseconds limit = elapsed(Nanoseconds::min(), parts_.to) > nanoseconds_of(hold_)
                                  ? parts_.to - nanoseconds_of(hold_)
                                  : Nanoseconds::min();
    std::int64_t due = 0;  // as wide as a stamp: several at once
    for (std::size_t b = 0; b < blocks; ++b)
      due |= static_cast<std::int64_t>(memory_.oldest[b].count() < limit.count());
    if (due != 0) [[unlikely]]
      age_blocks(limit);
    return memory_.heard == cells_ ? Status{} : Status{Reason::sample_stale};
  }

 protected:
  /// Cell `i`, whose reading of `last` is held, holds `passed` from `time` on.
  SKINCTL_INLINE void change_to(std::size_t i, CellCounts passed, Nanoseconds last,
                                Nanoseconds time) const noexcept {
    CellRecord& cell = memory_.records[i];
    const bool was_heard = memory_.hears(i);
    const bool lapsed = span(last, parts_.to) > hold_;
    const CellCounts old = was_heard || lapsed ? cell.held : CellCounts{};
    cell.held = passed;
    if (const std::uint32_t state = CellRecord::state_of(passed); state != cell.state)
      memory_.enter(i, state);
    const bool fading = lapsed && old != CellCounts{};
    if (passed == old && !fading) return;
    const CellSeat seat = tables_.cells.seat(i);
    const CellCounts was = tables_.weigh(i, old), is = tables_.weigh(i, passed);
    const CellCounts in_sums = was_heard ? was : CellCounts{};
    memory_.sums[seat.sums].add(tables_.cells[i], is.force - in_sums.force, is.proximity - in_sums.proximity);
    const Ramp<T> ramp = ramp_between(last, time);
    const auto revise = [&]<Reading R>() SKINCTL_INLINE_LAMBDA {
      const T from = tables_.template push_on<R>(seat, was), to = tables_.template push_on<R>(seat, is);
      if (!fading) [[likely]] {
        change<R>(i, ramp, to - from);
      } else {
        change_of_fading<R>(i, ramp, from, to, loss_since(last), was_heard);
      }
    };
    each_kind(revise);
  }

  /// The means of a change of cell `i` along a ramp from `last` to `time`, in an interval that has a length.
  SKINCTL_NOINLINE void spread(std::size_t i, WideCounts change_of_counts, Nanoseconds last,
                               Nanoseconds time) const noexcept {
    const CellSeat seat = tables_.cells.seat(i);
    const PatchRow<T>& patch = tables_.patches[seat.sums];
    const Ramp<T> ramp = ramp_between(last, time);
    const T force = patch.force_gain * static_cast<T>(change_of_counts.force());
    const T proximity = patch.proximity_gain * static_cast<T>(change_of_counts.proximity());
    const float* row = tables_.cells[i].row;
    const T unit[6] = {T(row[0]), T(row[1]), T(row[2]), T(row[3]), T(row[4]), T(row[5])};
    // Both readings share their ramp: its integrals are computed once.
    T before = ramp.integral(T(0));
    const T evenly = (before - ramp.integral(parts_.back)) * parts_.per_whole;
    for (std::size_t j = 0; j < parts_.count; ++j) {
      const T after = ramp.integral(parts_.length * static_cast<T>(j + 1));
      const T share = evenly + (after - before) * parts_.per_length;
      before = after;
      if constexpr (apart) {
        multiply_add<6>(means_[j].force.data[seat.slot], T(share * force), unit);
        multiply_add<6>(means_[j].proximity.data[seat.slot], T(share * proximity), unit);
      } else {
        multiply_add<6>(means_[j].data[seat.slot], T(share * (force + proximity)), unit);
      }
    }
  }

  const Tables& tables_;
  Memory& memory_;
  const std::size_t cells_;
  const Parts<T>& parts_;
  Means* means_;
  std::uint64_t max_age_, hold_, ramp_;
  T ramp_length_, ramp_slope_;

 private:
  /// Calls `f<Reading>()` for the readings whose wrenches are apart.
  template <class F>
  static SKINCTL_INLINE void each_kind(const F& f) noexcept {
    if constexpr (apart) {
      f.template operator()<Reading::force>();
      f.template operator()<Reading::proximity>();
    } else {
      f.template operator()<Reading::both>();
    }
  }
  /// Adds the cell's unit wrench times the mean of a force over each part, given its integral over time, and
  /// the impulse `made_up`, spread evenly over the whole interval; for an interval without length the impulse
  /// goes to the next one.
  template <Reading R, class Integral>
  SKINCTL_INLINE void add_means(std::size_t i, const T& made_up, const Integral& integral) const noexcept {
    const CellUnit& unit = tables_.cells[i];
    const std::size_t slot = tables_.cells.seat(i).slot;
    if (parts_.from == parts_.to) [[unlikely]] {
      auto& owed = R == Reading::proximity ? memory_.owed.proximity : memory_.owed.force;
      unit.add_to(owed.data[slot], made_up);
      memory_.owes = true;
      return;
    }
    const T evenly = made_up * parts_.per_whole;
    T before = integral(T(0));
    for (std::size_t j = 0; j < parts_.count; ++j) {
      const T after = integral(parts_.length * static_cast<T>(j + 1));
      unit.add_to(wrenches<R>(means_[j]).data[slot], evenly + (after - before) * parts_.per_length);
      before = after;
    }
  }

  /// The wrenches to which readings of a kind belong.
  template <Reading R>
  static SKINCTL_INLINE auto& wrenches(Means& means) noexcept {
    if constexpr (R == Reading::both) {
      return means;
    } else if constexpr (R == Reading::force) {
      return means.force;
    } else {
      return means.proximity;
    }
  }

  /// The push on a held cell changes by `jump` along `ramp`.
  template <Reading R>
  SKINCTL_INLINE void change(std::size_t i, const Ramp<T>& ramp, const T& jump) const noexcept {
    const T made_up = jump * (ramp.integral(T(0)) - ramp.integral(parts_.back));
    add_means<R>(i, made_up, [&](const T& t) SKINCTL_INLINE_LAMBDA { return jump * ramp.integral(t); });
  }
  /// The same for a cell that was fading or silent: `ramp` starts from the remaining force.
  template <Reading R>
  SKINCTL_NOINLINE void change_of_fading(std::size_t i, const Ramp<T>& ramp, const T& from, const T& to,
                                         const Ramp<T>& loss, bool was_heard) const noexcept {
    const T stop = ramp.start();
    const T left = T(1) - loss.value(stop);
    const T jump = to - from * left;
    const auto revised = [&](const T& t) {
      return from * (loss.integral(t) - loss.integral_until(stop, t)) + jump * ramp.integral(t);
    };
    add_means<R>(i, revised(T(0)) - revised(parts_.back), [&](const T& t) {
      const T rest = was_heard ? T(-loss.integral_until(stop, t)) : T(left * t);
      return from * rest + jump * ramp.integral(t);
    });
  }

  /// The ramp of a cell's force from its reading at `last` to the later one at `time`.
  SKINCTL_INLINE Ramp<T> ramp_between(Nanoseconds last, Nanoseconds time) const noexcept {
    const std::uint64_t gap = span(last, time);
    if (gap >= ramp_) [[likely]]
      return {seconds_after<T>(parts_.from, time - nanoseconds_of(ramp_)), ramp_length_, ramp_slope_};
    return {seconds_after<T>(parts_.from, last), seconds<T>(nanoseconds_of(gap))};
  }
  /// The share of a reading that has faded because of the cell's silence since `stamp`.
  SKINCTL_INLINE Ramp<T> loss_since(Nanoseconds stamp) const noexcept {
    return {seconds_after<T>(parts_.from, stamp) + seconds<T>(nanoseconds_of(hold_)),
            seconds<T>(tables_.settings.fade)};
  }

  /// Ages the blocks in which a stamp may lie before `limit`.
  SKINCTL_NOINLINE void age_blocks(Nanoseconds limit) const noexcept {
    for (std::size_t b = 0; 64 * b < cells_; ++b) {
      if (!(memory_.oldest[b] < limit)) continue;
      Nanoseconds oldest = Nanoseconds::max();
      for (std::uint64_t rest = memory_.states[b].heard; rest != 0; rest &= rest - 1) {
        const std::size_t i = 64 * b + static_cast<std::size_t>(std::countr_zero(rest));
        const Nanoseconds stamp = memory_.records[i].stamp;
        if (stamp < limit) age_cell(i);
        if (memory_.hears(i) && stamp < oldest) oldest = stamp;
      }
      memory_.oldest[b] = oldest;
    }
  }
  /// A cell that has been silent for longer than it is held.
  SKINCTL_INLINE void age_cell(std::size_t i) const noexcept {
    const CellRecord& cell = memory_.records[i];
    const CellCounts held = tables_.weigh(i, cell.held);
    const bool ends = span(cell.stamp, parts_.to) >= max_age_;
    if (held != CellCounts{}) {
      const CellSeat seat = tables_.cells.seat(i);
      const Ramp<T> loss = loss_since(cell.stamp);
      each_kind([&]<Reading R>() {
        const T push = tables_.template push_on<R>(seat, held);
        add_means<R>(i, T(0), [&](const T& t) { return -push * loss.integral(t); });
      });
      if (ends) memory_.sums[seat.sums].add(tables_.cells[i], -int(held.force), -int(held.proximity));
    }
    if (ends) memory_.enter(i, 0);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
