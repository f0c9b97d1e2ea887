// SPDX-License-Identifier: BSD-3-Clause
// A row of numbers over time from stamped samples, and its means over the parts of an interval.
#pragma once

#include <algorithm>

#include "skinctl/core/status.hpp"
#include "skinctl/tactile/detail/held_signal.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The memory of a `SampledInterval`.
template <std::size_t K, Real T>
struct SampledRow {
  Nanoseconds stamp = Nanoseconds::min();  ///< stamp of the last sample; `min`: silent
  Nanoseconds begin = Nanoseconds::min();  ///< time before which no missing impulse is added
  T held[K] = {};                          ///< numbers of the last sample
  T owed[K] = {};                          ///< impulse to be added in the next interval [s]
  friend bool operator==(const SampledRow&, const SampledRow&) noexcept = default;
};

/// One interval of a signal that is linear in time through its samples, or constant until `ramp` before the
/// next one; held after the last one, and gone by `max_age`. A change that shows itself only after the
/// interval in which it began has its missing impulse added, up to `catch_up` back. After a silence nothing
/// is missing: the signal goes on from what is left of it.
///
/// @tparam Row  `row(j)` is the mean over part `j`, a pointer to `K` numbers.
template <std::size_t K, Real T, class Row>
class SampledInterval {
 public:
  SKINCTL_INLINE SampledInterval(const SampledTimes& times, SampledRow<K, T>& memory, Nanoseconds from,
                                 Nanoseconds to, std::size_t parts, const Row& row) noexcept
      : times_(times),
        m_(memory),
        p_(Parts<T>::of(from, to, parts, std::min(elapsed(memory.begin, from), times.catch_up))),
        row_(row) {
    if (m_.stamp > p_.to) m_.stamp = p_.to;  // the clock was set back
    fading_ = is_silent() || age() > hold();
    for (std::size_t j = 0; j < p_.count; ++j) {
      const T kept = keep(j);
      T* mean = row_(j);
      for (std::size_t r = 0; r < K; ++r) mean[r] = kept * m_.held[r] + p_.per_whole * m_.owed[r];
    }
    if (p_.from != p_.to)
      for (T& x : m_.owed) x = T(0);
  }

  /// Empty if a sample of this stamp counts, else the reason why not.
  [[nodiscard]] SKINCTL_INLINE Status admits(Nanoseconds time) const noexcept {
    if (!is_silent() && time <= m_.stamp) return Reason::time_backwards;
    if (time > p_.to && span(p_.to, time) > static_cast<std::uint64_t>(times_.max_ahead.count()))
      return Reason::sample_out_of_range;
    if (time < p_.to && span(time, p_.to) >= max_age()) return Reason::sample_stale;
    return !is_silent() && m_.stamp == p_.to ? Status{Reason::time_backwards} : Status{};
  }
  /// Takes a sample: the signal is `value` at `stamp`, which `admits` has admitted.
  SKINCTL_INLINE void take(Nanoseconds stamp, const T (&value)[K]) noexcept {
    const Nanoseconds time = stamp < p_.to ? stamp : p_.to;
    Nanoseconds since = time - times_.ramp;
    T back = p_.back;
    if (fading_) {
      const T left = is_silent() ? T(0) : T(T(1) - loss().value(T(0)));
      for (std::size_t j = 0; j < p_.count; ++j) add(left - keep(j), m_.held, row_(j));
      for (T& x : m_.held) x = left * x;
      since = since > p_.from ? since : (p_.from < time ? p_.from : time - 1ns);
      back = T(0);
      fading_ = false;
    } else if (m_.stamp > since) {
      since = m_.stamp;
    }
    T jump[K];
    for (std::size_t r = 0; r < K; ++r) jump[r] = value[r] - m_.held[r];
    const Ramp<T> ramp(seconds_after<T>(p_.from, since), seconds<T>(time - since));
    T before = ramp.integral(T(0));
    const T missing = before - ramp.integral(back);
    if (p_.from == p_.to) {
      add(missing, jump, m_.owed);
    } else {
      for (std::size_t j = 0; j < p_.count; ++j) {
        const T after = ramp.integral(p_.length * static_cast<T>(j + 1));
        add(missing * p_.per_whole + (after - before) * p_.per_length, jump, row_(j));
        before = after;
      }
    }
    for (std::size_t r = 0; r < K; ++r) m_.held[r] = value[r];
    m_.stamp = time;
  }
  /// Ends the interval after its last sample; returns whether the signal is silent from now on.
  [[nodiscard]] SKINCTL_INLINE bool end() noexcept {
    if (is_silent()) return true;
    if (age() < max_age()) return false;
    m_.stamp = Nanoseconds::min();
    for (T& x : m_.held) x = T(0);
    return true;
  }

 private:
  static SKINCTL_INLINE void add(const T& share, const T (&value)[K], T* to) noexcept {
    for (std::size_t r = 0; r < K; ++r) to[r] = to[r] + share * value[r];
  }
  [[nodiscard]] SKINCTL_INLINE bool is_silent() const noexcept { return m_.stamp == Nanoseconds::min(); }
  [[nodiscard]] SKINCTL_INLINE std::uint64_t age() const noexcept { return span(m_.stamp, p_.to); }
  [[nodiscard]] SKINCTL_INLINE std::uint64_t max_age() const noexcept {
    return static_cast<std::uint64_t>(times_.max_age.count());
  }
  [[nodiscard]] SKINCTL_INLINE std::uint64_t hold() const noexcept {
    return static_cast<std::uint64_t>((times_.max_age - times_.fade).count());
  }
  [[nodiscard]] SKINCTL_INLINE Ramp<T> loss() const noexcept {
    return {seconds_after<T>(p_.from, m_.stamp) + seconds<T>(nanoseconds_of(hold())),
            seconds<T>(times_.fade)};
  }
  /// Mean share of the held value over part `j`.
  [[nodiscard]] SKINCTL_INLINE T keep(std::size_t j) const noexcept {
    if (!fading_) return T(1);
    if (is_silent()) return T(0);
    const Ramp<T> gone = loss();
    if (p_.from == p_.to) return T(1) - gone.value(T(0));
    const T t = p_.length * static_cast<T>(j);
    return T(1) - (gone.integral(T(t + p_.length)) - gone.integral(t)) * p_.per_length;
  }

  const SampledTimes& times_;
  SampledRow<K, T>& m_;
  const Parts<T> p_;
  const Row& row_;
  bool fading_ = false;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
