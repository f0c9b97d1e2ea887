// How the samples of one interval, and the silence of the other cells, change the sums and the mean wrenches.
#pragma once

#include <bit>
#include <span>

#include "skinctl/tactile/detail/held_signal.hpp"
#include "skinctl/tactile/detail/skin_memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// An interval in equal parts; times within it count in seconds from its start.
template <Real T>
struct Parts {
  Nanoseconds from, to;
  std::size_t count;
  T length, per_length, per_whole;  ///< [s], [1/s]; 0 for an interval without length
  T back;                           ///< <= 0: how far impulse is made up for [s]

  static Parts of(Nanoseconds from, Nanoseconds to, std::size_t count, Nanoseconds back) noexcept {
    const T whole = seconds<T>(elapsed(from, to));
    const T parts = static_cast<T>(count);
    if (!(whole > T(0))) return {from, from, count, T(0), T(0), T(0), -seconds<T>(back)};
    return {from, to, count, whole / parts, parts / whole, T(1) / whole, -seconds<T>(back)};
  }
};

/// One reception. `means` hold the wrenches of the sums as they were before; every change of a cell's force
/// is added to them as it happens.
template <Real T, class Tables, class Memory, class Wrenches>
class Reception {
 public:
  SKINCTL_INLINE Reception(const Tables& tables, Memory& memory, const Parts<T>& parts,
                           Wrenches* means) noexcept
      : tables_(tables),
        force_gate_(tables.force_gate),
        proximity_gate_(tables.proximity_gate),
        places_(tables.cells.places()),
        memory_(memory),
        parts_(parts),
        means_(means),
        latest_(after(parts.to, tables.settings.max_ahead)),
        silent_since_(before(parts.to, tables.settings.max_age)),
        fading_since_(before(parts.to, tables.settings.max_age - tables.settings.fade)),
        ramp_(static_cast<std::uint64_t>(tables.settings.ramp)) {}

  /// Two passes over so many samples at a time: which of them change a force, which nobody can foresee, and
  /// then those changes.
  SKINCTL_INLINE Status take(std::span<const CellSample> samples) const noexcept {
    constexpr std::size_t most = 64;
    Change changes[most];
    Status status;
    while (!samples.empty()) {
      const auto batch = samples.first(samples.size() < most ? samples.size() : most);
      std::size_t count = 0;
      for (const CellSample& sample : batch) count += admit(sample, changes[count], status);
      for (std::size_t k = 0; k < count; ++k) apply(changes[k]);
      samples = samples.subspan(batch.size());
    }
    return status;
  }

  /// Lets the forces of cells that have fallen silent go, and says whether any cell is silent.
  SKINCTL_INLINE Status age() const noexcept {
    bool all = true;
    for (std::size_t b = 0; b < Memory::blocks; ++b) {
      if (memory_.oldest[b] < fading_since_) [[unlikely]]
        age_block(b);
      all = all && memory_.hears_all_of(b);
    }
    return all ? Status{} : Status{Reason::sample_stale};
  }

 private:
  /// A sample that changes the force of a cell.
  struct Change {
    Nanoseconds last, time;
    std::uint32_t cell;
    CellCounts old, passed;
    bool was_heard, fading;
  };

  /// Notes the sample in the memory; 1 and what it changes if it changes a force, else 0.
  SKINCTL_INLINE std::size_t admit(const CellSample& sample, Change& found, Status& status) const noexcept {
    const std::size_t i = sample.cell < places_.size() ? places_[sample.cell] : Memory::cells;
    const Nanoseconds time = sample.time < parts_.to ? sample.time : parts_.to;
    if (i >= Memory::cells || !believable(numbers(sample)) || time <= memory_.stamp[i] ||
        time <= silent_since_ || sample.time > latest_) [[unlikely]] {
      status |= refusal(sample, i, time);
      return 0;
    }
    const Nanoseconds last = memory_.stamp[i];
    const CellCounts old = memory_.held[i], raw = counts(sample);
    std::uint64_t& heard = memory_.heard[i / 64];
    const std::uint64_t bit = std::uint64_t(1) << (i % 64);
    const std::uint32_t was_heard = (heard & bit) != 0;
    const auto in_sums = std::bit_cast<CellCounts>(whole(old) & (0u - was_heard));
    const CellCounts passed{
        static_cast<std::uint16_t>(force_gate_.pass(raw.force, in_sums.force != 0)),
        static_cast<std::uint16_t>(proximity_gate_.pass(raw.proximity, in_sums.proximity != 0))};
    Nanoseconds& oldest = memory_.oldest[i / 64];
    oldest = time < oldest ? time : oldest;
    heard |= bit;
    memory_.stamp[i] = time;
    memory_.held[i] = passed;

    const bool fading = (last < fading_since_) & (whole(old) != 0);
    // One by one: as a whole it would be put together elsewhere first, and copied before it has arrived.
    found.last = last, found.time = time;
    found.cell = static_cast<std::uint32_t>(i);
    found.old = old, found.passed = passed;
    found.was_heard = was_heard != 0, found.fading = fading;
    return static_cast<std::size_t>((whole(passed) != whole(old)) | fading);
  }
  /// Both counts as one word.
  static SKINCTL_INLINE std::uint32_t whole(CellCounts c) noexcept { return std::bit_cast<std::uint32_t>(c); }

  /// Why a sample is not taken.
  SKINCTL_COLD Status refusal(const CellSample& sample, std::size_t i, Nanoseconds time) const noexcept {
    if (const Status bad = check(sample); bad.any()) return bad;
    if (i >= Memory::cells) return Reason::sample_unknown;
    if (time <= memory_.stamp[i]) return Reason::time_backwards;
    return sample.time > latest_ ? Reason::sample_out_of_range : Reason::sample_stale;
  }

  SKINCTL_INLINE void apply(const Change& c) const noexcept {
    const CellEntry& cell = tables_.cells[c.cell];
    const CellCounts in_sums = c.was_heard ? c.old : CellCounts{};
    memory_.sums[cell.patch].add(cell, c.passed.force - in_sums.force,
                                 c.passed.proximity - in_sums.proximity);
    const std::uint64_t gap = span(c.last, c.time);
    const auto rise = static_cast<Nanoseconds>(gap < ramp_ ? gap : ramp_);
    const Ramp<T> ramp(seconds_after<T>(parts_.from, c.time - rise), seconds<T>(rise));
    const T from = tables_.force_on(cell, c.old), to = tables_.force_on(cell, c.passed);
    if (!c.fading) [[likely]] {
      change(cell, ramp, to - from);
    } else {
      change_of_fading(cell, ramp, from, to, loss_since(c.last), c.was_heard);
    }
  }

  /// Adds the cell's unit wrench times the mean of a force over each part, given its integral over time, and
  /// the impulse `made_up` evenly over the whole; an interval without length owes it to the next one.
  template <class Integral>
  SKINCTL_INLINE void add_means(const CellEntry& cell, const T& made_up,
                                const Integral& integral) const noexcept {
    if (parts_.from == parts_.to) [[unlikely]] {
      cell.add_to(memory_.owed.data[cell.slot], made_up);
      return;
    }
    const T evenly = made_up * parts_.per_whole;
    T before = integral(T(0));
    for (std::size_t j = 0; j < parts_.count; ++j) {
      const T after = integral(parts_.length * static_cast<T>(j + 1));
      cell.add_to(means_[j].data[cell.slot], evenly + (after - before) * parts_.per_length);
      before = after;
    }
  }

  /// The force of a cell changes by `jump` along `ramp`. Until now it was held.
  SKINCTL_INLINE void change(const CellEntry& cell, const Ramp<T>& ramp, const T& jump) const noexcept {
    const T made_up = jump * (ramp.integral(T(0)) - ramp.integral(parts_.back));
    add_means(cell, made_up, [&](const T& t) SKINCTL_INLINE_LAMBDA { return jump * ramp.integral(t); });
  }
  /// The same for a cell that was fading, or silent, until `ramp` starts from what was left.
  __attribute__((noinline)) void change_of_fading(const CellEntry& cell, const Ramp<T>& ramp, const T& from,
                                                  const T& to, const Ramp<T>& loss,
                                                  bool was_heard) const noexcept {
    const T stop = ramp.start();
    const T left = T(1) - loss.value(stop);
    const T jump = to - from * left;
    const auto revised = [&](const T& t) {
      return from * (loss.integral(t) - loss.integral_until(stop, t)) + jump * ramp.integral(t);
    };
    add_means(cell, revised(T(0)) - revised(parts_.back), [&](const T& t) {
      const T rest = was_heard ? T(-loss.integral_until(stop, t)) : T(left * t);
      return from * rest + jump * ramp.integral(t);
    });
  }

  /// The share of a reading that is lost to the cell's silence since `stamp`.
  SKINCTL_INLINE Ramp<T> loss_since(Nanoseconds stamp) const noexcept {
    return {
        seconds_after<T>(parts_.from, stamp) + seconds<T>(tables_.settings.max_age - tables_.settings.fade),
        seconds<T>(tables_.settings.fade)};
  }

  __attribute__((noinline)) void age_block(std::size_t b) const noexcept {
    Nanoseconds oldest = INT64_MAX;
    for (std::uint64_t rest = memory_.heard[b]; rest != 0; rest &= rest - 1) {
      const std::size_t i = 64 * b + static_cast<std::size_t>(std::countr_zero(rest));
      const Nanoseconds stamp = memory_.stamp[i];
      const CellCounts held = memory_.held[i];
      const bool ends = stamp <= silent_since_;
      if (stamp < fading_since_ && held != CellCounts{}) {
        const CellEntry& cell = tables_.cells[i];
        const Ramp<T> loss = loss_since(stamp);
        const T force = tables_.force_on(cell, held);
        add_means(cell, T(0), [&](const T& t) { return -force * loss.integral(t); });
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
  // Copies: what the loop over samples writes could be theirs, and they would be read again for each.
  EventGate<std::int32_t> force_gate_, proximity_gate_;
  std::span<const std::uint32_t> places_;
  Memory& memory_;
  const Parts<T>& parts_;
  Wrenches* means_;
  Nanoseconds latest_, silent_since_, fading_since_;
  std::uint64_t ramp_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
