// SPDX-License-Identifier: BSD-3-Clause
// Velocity Control: joints move as they are told, by whoever plans anew each cycle.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/robot/robot_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A goal of `VelocityControl`: velocities of the joints from now on.
template <std::size_t N, Real T = double>
struct VelocityGoal {
  JointVelocity<N, T> velocity;

  template <class F>
  friend void each_number(VelocityGoal& g, F&& f) {
    for (T& v : g.velocity) f(v);
  }
};

/// `tau = rate M (dq_d - dq)`: the joints reach the velocities dq_d of the last `VelocityGoal`, each in the
/// same time 1/rate however heavy the links are. It holds neither gravity nor a position: what moves the
/// robot else, moves it.
///
/// Without a new goal for `lasts` it brings the joints to rest, so a planner has to go on sending goals.
/// Behind a virtual robot with the damping c [1/s] the joints come to `rate / (rate + c)` of the velocities
/// wanted.
template <std::size_t N, Real T = double>
class VelocityControl : public Composable {
 public:
  using Goal = VelocityGoal<N, T>;
  using scalar = T;
  static constexpr std::size_t joints = N;
  static constexpr Needs needs = {.mass = true};
  static constexpr LawRole role = LawRole::reactive;
  static constexpr const char* name = "velocity";
  struct Memory {
    JointVelocity<N, T> wanted;
    T left = T(0);  ///< remaining time for which the goal holds [s]
  };

  /// @param rate   one over the time in which velocities are reached [1/s], > 0, at most 0.25 / D: see
  ///               `check_for`.
  /// @param lasts  time for which a goal holds, > 0. Throws `ConfigurationError` for numbers out of range.
  explicit VelocityControl(const T& rate = T(20), Nanoseconds lasts = 50ms)
      : rate_(rate), lasts_(seconds<T>(lasts)) {
    require(rate > T(0) && rate <= T(1e3), "rate of a velocity control", static_cast<double>(rate),
            "> 0, <= 1000 1/s");
    require(lasts > 0ns && lasts <= 10s, "velocity control: how long a goal lasts", milliseconds(lasts),
            "> 0, <= 10 000 ms");
  }
  /// Throws `ConfigurationError` for a rate above 0.25 / D, D the loop's delay: see
  /// `RobotDescription::loop_delay`.
  void check_for(const LawTerms<N, T>& robot) const {
    const double most = 0.25 / seconds<double>(robot.loop_delay);
    require(static_cast<double>(rate_) <= most, "rate of a velocity control", static_cast<double>(rate_),
            "at most 0.25 / D [1/s], D = delay + lag + 1.5 period by torque, else a sub-step");
  }

  template <class K>
  [[nodiscard]] Memory start(const K&) const noexcept {
    return {};
  }
  /// Takes a goal; refused if it is not finite.
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K&, const Goal& goal) const noexcept {
    T sum(0);
    for (const T& v : goal.velocity) sum = sum + v;
    if (!(sum - sum == T(0))) return {memory, Reason::goal_refused};
    return {{goal.velocity, lasts_}, {}};
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known) const noexcept {
    static_assert(K::joints == N, "velocities of another robot");
    JointAcceleration<N, T> a;
    for (std::size_t i = 0; i < N; ++i)
      a[i] = rate_ * ((memory.left > T(0) ? memory.wanted[i] : T(0)) - known.dq()[i]);
    return known.mass() * a;
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K&, const T& dt, Opposition) const noexcept {
    Memory out = memory;
    out.left = memory.left > dt ? T(memory.left - dt) : T(0);
    return out;
  }

 private:
  T rate_, lasts_;
};

SKINCTL_END_NAMESPACE
