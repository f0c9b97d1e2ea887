// Reception: updates the sums and the mean wrenches for the samples of one interval and for silent cells.
#pragma once

#include "skinctl/tactile/detail/held_signal.hpp"
#include "skinctl/tactile/detail/skin_memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The front end of a skin that trusts its cells: the readings are those of the samples.
struct AsSent {
  SKINCTL_INLINE CellCounts reading(std::size_t, const CellSample& sample) const noexcept {
    return counts(sample);
  }
};

/// An interval in equal parts; times within it are in seconds from its start.
template <Real T>
struct Parts {
  Nanoseconds from, to;
  std::size_t count;
  T length, per_length, per_whole;  ///< [s], [1/s]; 0 for an interval without length
  T back;                           ///< <= 0: start of the time for which missing impulse is added [s]

  static Parts of(Nanoseconds from, Nanoseconds to, std::size_t count, Nanoseconds back) noexcept {
    const T whole = seconds<T>(elapsed(from, to));
    const T parts = static_cast<T>(count);
    if (!(whole > T(0))) return {from, from, count, T(0), T(0), T(0), -seconds<T>(back)};
    return {from, to, count, whole / parts, parts / whole, T(1) / whole, -seconds<T>(back)};
  }
};

/// One reception. `means` starts with the wrenches of the previous sums; every change of a cell's push is
/// added when it occurs. `Means` is a `LinkWrenches`, or a `TouchWrenches` for forces and proximities apart.
template <Real T, class Tables, class Memory, class Means>
class Reception {
  static constexpr bool apart = requires(const Means& m) { m.proximity; };

 public:
  SKINCTL_INLINE Reception(const Tables& tables, Memory& memory, const Parts<T>& parts, Means* means) noexcept
      : tables_(tables),
        memory_(memory),
        parts_(parts),
        means_(means),
        max_age_(static_cast<std::uint64_t>((tables.settings.max_age).count())),
        hold_(static_cast<std::uint64_t>((tables.settings.max_age - tables.settings.fade).count())),
        max_ahead_(static_cast<std::uint64_t>((tables.settings.max_ahead).count())),
        ramp_(static_cast<std::uint64_t>((tables.settings.ramp).count())),
        ramp_length_(seconds<T>(tables.settings.ramp)),
        ramp_slope_(T(1) / ramp_length_) {}

  /// `front.reading(i, sample)` says what the sample of cell `i` is worth.
  template <class Front = AsSent>
  SKINCTL_INLINE Status take(const CellSample& sample, Front&& front = {}) const noexcept {
    if (const Status bad = check(sample); bad.any()) [[unlikely]]
      return bad;
    const std::size_t i = tables_.cells.index(sample.cell);
    if (i >= Memory::cells) [[unlikely]]
      return Reason::sample_unknown;
    const bool ahead = memory_.stamp[i] > parts_.to;  // the clock was set back since
    Nanoseconds last = ahead ? Nanoseconds::min() : memory_.stamp[i];
    const Nanoseconds time = sample.time < parts_.to ? sample.time : parts_.to;
    if (sample.time <= last || time <= last) [[unlikely]]
      return Reason::time_backwards;
    if (sample.time > parts_.to && span(parts_.to, sample.time) > max_ahead_) [[unlikely]]
      return Reason::sample_out_of_range;
    if (span(time, parts_.to) >= max_age_) [[unlikely]]
      return Reason::sample_stale;
    if (ahead) [[unlikely]]
      last = time - nanoseconds_of(ramp_);

    const bool was_heard = memory_.hears(i);
    const CellCounts old = memory_.held[i];
    const CellCounts in_sums = was_heard ? old : CellCounts{};
    const CellCounts raw = front.reading(i, sample);
    const CellCounts passed{
        static_cast<std::uint16_t>(tables_.force_gate.pass(raw.force, in_sums.force != 0)),
        static_cast<std::uint16_t>(tables_.proximity_gate.pass(raw.proximity, in_sums.proximity != 0))};
    std::uint64_t& heard = memory_.heard[i / 64];
    Nanoseconds& oldest = memory_.oldest[i / 64];
    oldest = heard == 0 || time < oldest ? time : oldest;
    heard |= std::uint64_t(1) << (i % 64);
    memory_.stamp[i] = time;
    memory_.held[i] = passed;

    const bool fading = span(last, parts_.to) > hold_ && old != CellCounts{};
    if (passed == old && !fading) return {};
    const CellEntry& cell = tables_.cells[i];
    memory_.sums[cell.patch].add(cell, passed.force - in_sums.force, passed.proximity - in_sums.proximity);
    const Ramp<T> ramp = ramp_between(last, time);
    const auto revise = [&]<Reading R>() SKINCTL_INLINE_LAMBDA {
      const T from = tables_.template push_on<R>(cell, old), to = tables_.template push_on<R>(cell, passed);
      if (!fading) [[likely]] {
        change<R>(cell, ramp, to - from);
      } else {
        change_of_fading<R>(cell, ramp, from, to, loss_since(last), was_heard);
      }
    };
    if constexpr (apart) {
      if (passed.force != old.force || fading) revise.template operator()<Reading::force>();
      if (passed.proximity != old.proximity || fading) revise.template operator()<Reading::proximity>();
    } else {
      revise.template operator()<Reading::both>();
    }
    return {};
  }

  /// Another reading for a cell that is heard: from `raw` at the end of the interval on, with a change within
  /// the last `ramp` of it. Nothing before the interval is revised, and the cell goes on ageing. One that is
  /// silent or fades stays as it is.
  SKINCTL_INLINE void revise(std::size_t i, CellCounts raw) const noexcept {
    if (!memory_.hears(i)) return;
    if (memory_.stamp[i] < parts_.to && span(memory_.stamp[i], parts_.to) > hold_) return;
    const CellCounts old = memory_.held[i], passed = pass_gates(raw, old);
    if (passed == old) return;
    memory_.held[i] = passed;
    const CellEntry& cell = tables_.cells[i];
    memory_.sums[cell.patch].add(cell, passed.force - old.force, passed.proximity - old.proximity);
    if (parts_.from == parts_.to) return;
    const Ramp<T> ramp = ramp_between(parts_.from, parts_.to);
    const auto alter = [&]<Reading R>() SKINCTL_INLINE_LAMBDA {
      const T from = tables_.template push_on<R>(cell, old), to = tables_.template push_on<R>(cell, passed);
      const T jump = to - from;
      add_means<R>(cell, T(0), [&](const T& t) SKINCTL_INLINE_LAMBDA { return jump * ramp.integral(t); });
    };
    if constexpr (apart) {
      alter.template operator()<Reading::force>();
      alter.template operator()<Reading::proximity>();
    } else {
      alter.template operator()<Reading::both>();
    }
  }

  /// Fades the forces of cells that have fallen silent; reports whether any cell is silent.
  SKINCTL_INLINE Status age() const noexcept {
    bool all = true;
    for (std::size_t b = 0; b < Memory::blocks; ++b) {
      if (memory_.heard[b] != 0 && memory_.oldest[b] < parts_.to &&
          span(memory_.oldest[b], parts_.to) > hold_)
        age_block(b);
      all = all && memory_.hears_all_of(b);
    }
    return all ? Status{} : Status{Reason::sample_stale};
  }

 private:
  /// What the gates let through of a cell's reading, by whether they were open.
  SKINCTL_INLINE CellCounts pass_gates(CellCounts raw, CellCounts before) const noexcept {
    return {static_cast<std::uint16_t>(tables_.force_gate.pass(raw.force, before.force != 0)),
            static_cast<std::uint16_t>(tables_.proximity_gate.pass(raw.proximity, before.proximity != 0))};
  }

  /// Adds the cell's unit wrench times the mean of a force over each part, given its integral over time, and
  /// the impulse `made_up`, spread evenly over the whole interval; for an interval without length the impulse
  /// goes to the next one.
  template <Reading R, class Integral>
  SKINCTL_INLINE void add_means(const CellEntry& cell, const T& made_up,
                                const Integral& integral) const noexcept {
    if (parts_.from == parts_.to) [[unlikely]] {
      auto& owed = R == Reading::proximity ? memory_.owed.proximity : memory_.owed.force;
      cell.add_to(owed.data[cell.slot], made_up);
      return;
    }
    const T evenly = made_up * parts_.per_whole;
    T before = integral(T(0));
    for (std::size_t j = 0; j < parts_.count; ++j) {
      const T after = integral(parts_.length * static_cast<T>(j + 1));
      cell.add_to(wrenches<R>(means_[j]).data[cell.slot], evenly + (after - before) * parts_.per_length);
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
  SKINCTL_INLINE void change(const CellEntry& cell, const Ramp<T>& ramp, const T& jump) const noexcept {
    const T made_up = jump * (ramp.integral(T(0)) - ramp.integral(parts_.back));
    add_means<R>(cell, made_up, [&](const T& t) SKINCTL_INLINE_LAMBDA { return jump * ramp.integral(t); });
  }
  /// The same for a cell that was fading or silent: `ramp` starts from the remaining force.
  template <Reading R>
  __attribute__((noinline)) void change_of_fading(const CellEntry& cell, const Ramp<T>& ramp, const T& from,
                                                  const T& to, const Ramp<T>& loss,
                                                  bool was_heard) const noexcept {
    const T stop = ramp.start();
    const T left = T(1) - loss.value(stop);
    const T jump = to - from * left;
    const auto revised = [&](const T& t) {
      return from * (loss.integral(t) - loss.integral_until(stop, t)) + jump * ramp.integral(t);
    };
    add_means<R>(cell, revised(T(0)) - revised(parts_.back), [&](const T& t) {
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

  __attribute__((noinline)) void age_block(std::size_t b) const noexcept {
    Nanoseconds oldest = Nanoseconds::max();
    for (std::uint64_t rest = memory_.heard[b]; rest != 0; rest &= rest - 1) {
      const std::size_t i = 64 * b + static_cast<std::size_t>(std::countr_zero(rest));
      const Nanoseconds stamp = memory_.stamp[i];
      const std::uint64_t silence = stamp < parts_.to ? span(stamp, parts_.to) : 0;
      const CellCounts held = memory_.held[i];
      const bool ends = silence >= max_age_;
      if (silence > hold_ && held != CellCounts{}) {
        const CellEntry& cell = tables_.cells[i];
        const Ramp<T> loss = loss_since(stamp);
        const auto fade = [&]<Reading R>() {
          const T push = tables_.template push_on<R>(cell, held);
          add_means<R>(cell, T(0), [&](const T& t) { return -push * loss.integral(t); });
        };
        if constexpr (apart) {
          fade.template operator()<Reading::force>();
          fade.template operator()<Reading::proximity>();
        } else {
          fade.template operator()<Reading::both>();
        }
        if (ends) memory_.sums[cell.patch].add(cell, -int(held.force), -int(held.proximity));
      }
      if (ends) {
        memory_.heard[b] &= ~(rest & (~rest + 1));
      } else if (stamp < oldest) {
        oldest = stamp;
      }
    }
    memory_.oldest[b] = oldest;
  }

  const Tables& tables_;
  Memory& memory_;
  const Parts<T>& parts_;
  Means* means_;
  std::uint64_t max_age_, hold_, max_ahead_, ramp_;
  T ramp_length_, ramp_slope_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
