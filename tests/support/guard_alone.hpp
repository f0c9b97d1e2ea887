// A guard without a resolver: with a clock of its own.
#pragma once

#include "skinctl/guard/joint_guard.hpp"

namespace skinctl::testing {

/// A guard whose memory holds the time of the last cycle, judged as a resolver judges it.
template <Interface I, std::size_t N, class T = double, class Smooth = Abrupt>
struct GuardAlone : JointGuard<I, N, T, Smooth> {
  using Base = JointGuard<I, N, T, Smooth>;
  using Base::Base;
  struct Memory : GuardMemory<N, T> {
    Nanoseconds time{};
    Nanoseconds odd_time = detail::no_time;
    Nanoseconds carried{};
  };

  [[nodiscard]] Memory start(const JointCommand<N, T>& command, const State<N, T>& measured) const noexcept {
    return {Base::start(command, measured), command.time};
  }
  Guarded<N, T> step(Memory& m, const JointCommand<N, T>& wish, const State<N, T>& measured, Nanoseconds now,
                     const JointTorque<N, T>& fallback = {}, Status found = {}) const noexcept {
    Interval interval = detail::interval_since(true, m.time, m.odd_time, now, this->longest_interval());
    interval.carried = m.carried;
    const auto out = Base::step(m, wish, measured, interval, fallback, found);
    if (!m.begun) return out;
    m.odd_time = detail::odd_time_of(interval);
    m.time = interval.to;
    const Nanoseconds left =
        interval.to - interval.from + m.carried - interval.command_duration(this->period());
    m.carried = left < this->period() ? left : this->period();
    return out;
  }
};

}  // namespace skinctl::testing
