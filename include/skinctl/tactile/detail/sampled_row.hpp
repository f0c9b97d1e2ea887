// A row of numbers over time from stamped samples, and its means over the parts of an interval.
#pragma once

#include "skinctl/core/status.hpp"
#include "skinctl/tactile/detail/held_signal.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// See `SampledInterval`.
template <std::size_t K, Real T>
struct SampledRow {
  Nanoseconds stamp = Nanoseconds::min();  ///< of the last sample; `min`: silent
  Nanoseconds begin = Nanoseconds::min();  ///< no missing impulse is added before this time
  T held[K] = {};                          ///< of the last sample
  T owed[K] = {};                          ///< impulse to be added in the next interval [s]
  friend bool operator==(const SampledRow&, const SampledRow&) noexcept = default;
};

/// One interval of a signal that is linear in time through its samples, or constant until `ramp` before the
/// next one; held after the last one, and gone by `max_age`. A change that shows itself only after the
/// interval in which it began has its missing impulse added, up to `catch_up` back. After a silence nothing is
/// missing: the signal goes on from what is left of it.
///
/// @tparam Row  `row(j)` is the mean over part `j`, a pointer to `K` numbers.
template <std::size_t K, Real T, class Row>
class SampledInterval {
 public:
  SKINCTL_INLINE SampledInterval(const SampledTimes& times, SampledRow<K, T>& memory, Nanoseconds from,
                                 Nanoseconds to, std::size_t parts, const Row& row) noexcept
      : times_(times), m_(memory), from_(from), to_(to < from ? from : to), parts_(parts), row_(row) {
    if (m_.stamp > to_) m_.stamp = to_;  // the clock was set back
    const T whole = seconds<T>(elapsed(from_, to_));
    length_ = whole / static_cast<T>(parts);
    per_length_ = length_ > T(0) ? T(1) / length_ : T(0);
    per_whole_ = whole > T(0) ? T(1) / whole : T(0);
    const Nanoseconds known = elapsed(m_.begin, from_);
    back_ = -seconds<T>(known < times_.catch_up ? known : times_.catch_up);
    fading_ = is_silent() || span(m_.stamp, to_) > hold();
    for (std::size_t j = 0; j < parts_; ++j) {
      const T kept = keep(j);
      T* mean = row_(j);
      for (std::size_t r = 0; r < K; ++r) mean[r] = kept * m_.held[r] + per_whole_ * m_.owed[r];
    }
    if (whole > T(0))
      for (T& x : m_.owed) x = T(0);
  }

  /// Whether a sample of this stamp counts, else why not.
  [[nodiscard]] SKINCTL_INLINE Status admits(Nanoseconds time) const noexcept {
    if (!is_silent() && time <= m_.stamp) return Reason::time_backwards;
    if (time > to_ && span(to_, time) > static_cast<std::uint64_t>(times_.max_ahead.count()))
      return Reason::sample_out_of_range;
    if (time < to_ && span(time, to_) >= static_cast<std::uint64_t>(times_.max_age.count()))
      return Reason::sample_stale;
    return !is_silent() && m_.stamp == to_ ? Status{Reason::time_backwards} : Status{};
  }
  /// The signal is `value` at `stamp`, which is admitted.
  SKINCTL_INLINE void take(Nanoseconds stamp, const T (&value)[K]) noexcept {
    const Nanoseconds time = stamp < to_ ? stamp : to_;
    T jump[K];
    Nanoseconds since = time - times_.ramp;
    T back = back_;
    if (fading_) {
      const T left = left_at_start();
      for (std::size_t j = 0; j < parts_; ++j) {
        const T change = left - keep(j);
        T* mean = row_(j);
        for (std::size_t r = 0; r < K; ++r) mean[r] = mean[r] + change * m_.held[r];
      }
      for (std::size_t r = 0; r < K; ++r) m_.held[r] = left * m_.held[r];
      since = since > from_ ? since : (from_ < time ? from_ : time - 1ns);
      back = T(0);
      fading_ = false;
    } else if (m_.stamp > since) {
      since = m_.stamp;
    }
    for (std::size_t r = 0; r < K; ++r) jump[r] = value[r] - m_.held[r];
    const Ramp<T> ramp(seconds_after<T>(from_, since), seconds<T>(time - since));
    const T missing = ramp.integral(T(0)) - ramp.integral(back);
    T before = ramp.integral(T(0));
    if (!(length_ > T(0))) {
      for (std::size_t r = 0; r < K; ++r) m_.owed[r] = m_.owed[r] + missing * jump[r];
    } else {
      for (std::size_t j = 0; j < parts_; ++j) {
        const T after = ramp.integral(length_ * static_cast<T>(j + 1));
        const T share = missing * per_whole_ + (after - before) * per_length_;
        T* mean = row_(j);
        for (std::size_t r = 0; r < K; ++r) mean[r] = mean[r] + share * jump[r];
        before = after;
      }
    }
    for (std::size_t r = 0; r < K; ++r) m_.held[r] = value[r];
    m_.stamp = time;
  }
  /// After the last sample: whether the signal is silent from now on.
  [[nodiscard]] SKINCTL_INLINE bool end() noexcept {
    if (is_silent()) return true;
    if (span(m_.stamp, to_) < static_cast<std::uint64_t>(times_.max_age.count())) return false;
    m_.stamp = Nanoseconds::min();
    for (T& x : m_.held) x = T(0);
    return true;
  }

 private:
  [[nodiscard]] SKINCTL_INLINE bool is_silent() const noexcept { return m_.stamp == Nanoseconds::min(); }
  [[nodiscard]] SKINCTL_INLINE std::uint64_t hold() const noexcept {
    return static_cast<std::uint64_t>((times_.max_age - times_.fade).count());
  }
  [[nodiscard]] SKINCTL_INLINE Ramp<T> loss() const noexcept {
    return {seconds_after<T>(from_, m_.stamp) + seconds<T>(nanoseconds_of(hold())), seconds<T>(times_.fade)};
  }
  /// Mean share of the held value over part `j`.
  [[nodiscard]] SKINCTL_INLINE T keep(std::size_t j) const noexcept {
    if (!fading_) return T(1);
    if (is_silent()) return T(0);
    const Ramp<T> gone = loss();
    if (!(length_ > T(0))) return T(1) - gone.value(T(0));
    const T t = length_ * static_cast<T>(j);
    return T(1) - (gone.integral(T(t + length_)) - gone.integral(t)) * per_length_;
  }
  [[nodiscard]] SKINCTL_INLINE T left_at_start() const noexcept {
    return is_silent() ? T(0) : T(T(1) - loss().value(T(0)));
  }

  const SampledTimes& times_;
  SampledRow<K, T>& m_;
  Nanoseconds from_, to_;
  std::size_t parts_;
  const Row& row_;
  T length_, per_length_, per_whole_, back_;
  bool fading_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
