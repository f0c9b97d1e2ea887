// SPDX-License-Identifier: BSD-3-Clause
// Servos: how a robot as declared answers its commands.
#pragma once

#include <cmath>

#include "skinctl/core/command.hpp"
#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The commands under way, and the position that they have brought. Trivially copyable.
///
/// Between two commands the commanded position is `value + slope * (time since)`: slope zero for a robot by
/// position, the velocity for one by velocity.
template <std::size_t N, Real T, std::size_t Capacity>
struct CommandsUnderWay {
  static_assert(Capacity >= 2 && Capacity <= 4096, "room for the present command and one under way");
  Nanoseconds time[Capacity] = {};
  JointPosition<N, T> value[Capacity];
  JointVelocity<N, T> slope[Capacity];
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  Nanoseconds now{};            ///< time for which `reached` has been computed
  Nanoseconds span{};           ///< last step of `reached`, for which `decay` is known: most are alike
  T lag = T(0);                 ///< lag for which `decay` is known [s]
  T decay = T(1);               ///< factor `exp(-span / lag)` of a first-order lag
  JointPosition<N, T> reached;  ///< position of the declared robot at `now` [rad], [m]
};

/// The operator H of the resolver: a pure delay and a lag of first order,
/// `lag * dq/dt = command(t - delay) - q`. Exact for held commands and for held velocities.
template <std::size_t N, Real T, std::size_t Capacity>
class DelayLag {
 public:
  using Memory = CommandsUnderWay<N, T, Capacity>;
  using Pushed = JointTorque<N, T>;
  static constexpr bool gives_way = false;

  /// @param delay  from sending a command until the robot begins to move, and from there until its measured
  ///               position is stamped [ns], >= 0.
  /// @param lag    time constant of the robot's own control loop [s], >= 0.
  constexpr DelayLag(Nanoseconds delay, const T& lag) noexcept : delay_(delay), lag_(lag) {}
  /// Throws `ConfigurationError` for a configuration with springs.
  SKINCTL_COLD explicit DelayLag(const RobotConfiguration<N, T>& c) : DelayLag(c.delay, seconds<T>(c.lag)) {
    refuse_springs(c);
  }

  /// Begins with a robot at `q` that has moved steadily at `dq`, as if by commands.
  [[nodiscard]] SKINCTL_INLINE Memory start(Nanoseconds time, const JointPosition<N, T>& q,
                                            const JointVelocity<N, T>& dq) const noexcept {
    Memory m;
    m.time[0] = time - delay_;
    m.value[0] = integrate(q, dq, lag_);
    m.slope[0] = dq;
    m.count = 1;
    m.now = time;
    m.reached = q;
    return m;
  }

  /// Takes a command that was sent. If there is no room for it, the oldest one under way counts as carried
  /// out.
  SKINCTL_INLINE void send(Memory& m, Nanoseconds time, const JointPosition<N, T>& value,
                           const JointVelocity<N, T>& slope) const noexcept {
    if (m.count == Capacity) drop(m);
    const std::uint32_t k = (m.first + m.count) % Capacity;
    m.time[k] = time;
    m.value[k] = value;
    m.slope[k] = slope;
    ++m.count;
  }
  /// Replaces position and velocity of the last command, which was sent with other values than `send` was
  /// given.
  SKINCTL_INLINE void correct(Memory& m, const JointPosition<N, T>& value,
                              const JointVelocity<N, T>& slope) const noexcept {
    const std::uint32_t k = last(m);
    m.value[k] = value;
    m.slope[k] = slope;
  }

  /// Starts again after a clock that leapt, or was set: at `time` the newest command is being carried out,
  /// all others are done.
  SKINCTL_COLD void restart(Memory& m, Nanoseconds time) const noexcept {
    m.first = last(m);
    m.count = 1;
    m.time[m.first] = time - delay_;
    m.now = time;
  }

  /// Calls `f(position)` for the command that is being carried out and every one under way, in their order.
  template <class F>
  SKINCTL_INLINE void each_under_way(const Memory& m, F&& f) const noexcept {
    for (std::uint32_t k = 0; k < m.count; ++k) f(m.value[(m.first + k) % Capacity]);
  }

  /// Position of the declared robot at `until`, which no contact moves; a time before that of the last call
  /// changes nothing.
  SKINCTL_INLINE const JointPosition<N, T>& due(Memory& m, Nanoseconds until,
                                                const Pushed& = {}) const noexcept {
    while (m.now < until) {
      const std::uint32_t next = (m.first + 1) % Capacity;
      const bool more = m.count > 1 && m.time[next] + delay_ <= until;
      const Nanoseconds end = !more ? until : (m.time[next] + delay_ > m.now ? m.time[next] + delay_ : m.now);
      follow(m, end);
      if (more) drop(m);
      if (!more) break;
    }
    return m.reached;
  }

 private:
  static SKINCTL_INLINE std::uint32_t last(const Memory& m) noexcept {
    return (m.first + m.count + std::uint32_t(Capacity) - 1) % Capacity;
  }
  static SKINCTL_INLINE void drop(Memory& m) noexcept {
    m.first = (m.first + 1) % Capacity;
    --m.count;
  }
  SKINCTL_INLINE void follow(Memory& m, Nanoseconds end) const noexcept {
    using std::exp;
    if (end <= m.now) return;
    using R = detail::Row<N, T>;
    const R slope = m.slope[m.first];
    const R goal = m.value[m.first] + seconds<T>(end - delay_ - m.time[m.first]) * slope;
    const T dt = seconds<T>(end - m.now);
    // Below a ten-thousandth of the step a lag cannot be told from none.
    const bool lags = lag_ * T(1e4) > dt;
    if (end - m.now != m.span || lag_ != m.lag) {
      m.span = end - m.now;
      m.lag = lag_;
      m.decay = lags ? T(exp(-dt / lag_)) : T(0);
    }
    const T behind = lags ? lag_ : T(0);
    const R last_goal = goal - slope * dt, lead = slope * behind;
    (goal - lead + (m.reached - last_goal + lead) * m.decay).store(m.reached);
    m.now = end;
  }

  Nanoseconds delay_;
  T lag_;
};

/// Stand-in for a servo, for joints that take torques, which have no commanded position.
struct NoServo {};

namespace detail {
template <Interface Ix, std::size_t N, Real T, std::size_t Capacity>
struct ServoBy;  // by impedance: see robot/spring.hpp
template <std::size_t N, Real T, std::size_t Capacity>
struct ServoBy<Interface::position, N, T, Capacity> {
  using type = DelayLag<N, T, Capacity>;
};
template <std::size_t N, Real T, std::size_t Capacity>
struct ServoBy<Interface::velocity, N, T, Capacity> {
  using type = DelayLag<N, T, Capacity>;
};
template <std::size_t N, Real T, std::size_t Capacity>
struct ServoBy<Interface::torque, N, T, Capacity> {
  using type = NoServo;
};
}  // namespace detail

/// The servo of `N` joints that take `Ix`:
///
/// | member | |
/// |---|---|
/// | `Memory` | trivially copyable: at least `reached`, the position of the robot at the time of the last `due` |
/// | `start(time, q, dq)` | of a robot that has moved steadily |
/// | `send(m, time, value, slope)` | a command was sent; `correct`: the last one with other values |
/// | `due(m, until, pushed)` | where a robot as declared would be, pushed by the joint torque of the contacts felt |
/// | `each_under_way(m, f)` | calls `f` with the position of each command from the present one on |
/// | `restart(m, time)` | the clock was set |
/// | `gives_way` | whether pushes deflect it: `Memory` then has `deflection` [rad] |
template <Interface Ix, std::size_t N, Real T, std::size_t Capacity>
using ServoOf = typename detail::ServoBy<Ix, N, T, Capacity>::type;
/// Whether commands of the interface say where the joints should be: all but torques do.
template <Interface Ix>
inline constexpr bool has_servo = !std::is_same_v<ServoOf<Ix, 1, double, 2>, NoServo>;

SKINCTL_END_NAMESPACE
