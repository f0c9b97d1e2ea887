// SPDX-License-Identifier: BSD-3-Clause
// The robot's joints at the time of a sample.
#pragma once

#include <array>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The last states of a robot, and its joints at times between them: a sample was measured where the robot
/// was then, not where it is when the sample is read. Linear between two states: within `a h^2 / 8` for
/// joints that accelerate by a, 0.12 mrad at 15 rad/s^2 and states h = 8 ms apart.
///
/// @tparam Size  states that are kept: 16 reach 120 ms back at 125 Hz.
template <std::size_t N, Real T = double, std::size_t Size = 16>
class JointHistory {
  static_assert(Size >= 2, "a line takes two states");

 public:
  /// Trivially copyable; `Memory{}` has no state.
  struct Memory {
    std::array<State<N, T>, Size> states{};
    std::size_t newest = 0, count = 0;
  };
  /// The joints at a time.
  struct At {
    State<N, T> state;  ///< state at the time asked for, or at the nearest one for which the joints are known
    bool known = false;  ///< whether the state is of the time asked for
  };

  /// Throws `ConfigurationError` unless `period` is in (0, 1] s.
  /// @param period  planned time between two states; the newest one is extrapolated for as long.
  explicit JointHistory(Nanoseconds period) : period_(period) {
    require(period > 0ns && period <= 1s, "JointHistory: period", milliseconds(period), "> 0, <= 1000 ms");
  }

  /// Takes a state, unless it is not finite (`state_not_finite`) or not later than the newest one
  /// (`time_backwards`; after a clock was set back, begin anew with `Memory{}`).
  Status add(Memory& m, const State<N, T>& state) const noexcept {
    if (!detail::is_plausible(state) || !detail::is_plausible(state.time)) return Reason::state_not_finite;
    if (m.count > 0 && state.time <= m.states[m.newest].time) return Reason::time_backwards;
    if (m.count > 0) m.newest = (m.newest + 1) % Size;
    m.states[m.newest] = state;
    if (m.count < Size) ++m.count;
    return {};
  }

  /// The joints at `t`: linear between two states; after the newest `q + dq t`, for at most a period; those
  /// of the oldest state before it; zero without any.
  [[nodiscard]] At at(const Memory& m, Nanoseconds t) const noexcept {
    if (m.count == 0) return {};
    const State<N, T>& last = m.states[m.newest];
    if (t >= last.time) {
      const Nanoseconds end = last.time + period_;
      At out{last, t <= end};
      out.state.time = t < end ? t : end;
      out.state.q = integrate(last.q, last.dq, seconds<T>(out.state.time - last.time));
      return out;
    }
    std::size_t later = m.newest;
    for (std::size_t k = 1; k < m.count; ++k) {
      const std::size_t earlier = (m.newest + Size - k) % Size;
      const State<N, T>&a = m.states[earlier], &b = m.states[later];
      if (t >= a.time) {
        const T share = seconds<T>(t - a.time) / seconds<T>(b.time - a.time);
        At out{a, true};
        out.state.time = t;
        for (std::size_t i = 0; i < N; ++i) {
          out.state.q[i] = a.q[i] + share * (b.q[i] - a.q[i]);
          out.state.dq[i] = a.dq[i] + share * (b.dq[i] - a.dq[i]);
        }
        return out;
      }
      later = earlier;
    }
    return {m.states[later], false};
  }

 private:
  Nanoseconds period_;
};

SKINCTL_END_NAMESPACE
