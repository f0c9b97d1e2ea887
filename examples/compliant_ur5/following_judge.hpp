// Does the arm do what it is told? A joint that stands, and a lag beyond the declared one.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "skinctl/core/status.hpp"
#include "skinctl/resolver/following_monitor.hpp"

namespace compliant_ur5 {

/// Judges once a cycle, from the memory of the scene's resolver. A finger that holds the arm is no fault:
/// while the skin feels a touch, and 0.5 s after it, a standing joint does not count.
template <std::size_t N>
class FollowingJudge {
 public:
  static constexpr double standing = 0.3;  ///< for so long a joint may stand beside its commands [s]
  static constexpr double hopeless =
      1;  ///< for so long a joint may stay where the resolver found it blocked [s]
  static constexpr double untouched = 0.5;    ///< since the last touch [s]
  static constexpr double still = 0.01;       ///< [rad/s]
  static constexpr double most_lag = 0.04;    ///< beyond the declared one [s]
  static constexpr double uncertain = 0.008;  ///< standard deviation of a lag that is believed [s]

  explicit FollowingJudge(const skinctl::RobotConfiguration<N>& robot)
      : monitor_(robot), band_(robot.dead_band) {
    lag_ = monitor_.estimate(memory_);
  }

  /// @param force  that the skin feels [N].
  template <class RobotMemory>
  void cycle(double t, double dt, const RobotMemory& memory, skinctl::Status status, double force,
             const skinctl::JointPosition<N>&) noexcept {
    const auto& robot = memory.group();
    monitor_.step(memory_, robot);
    if (force > 1) touched_at_ = t;
    const bool free = t - touched_at_ > untouched;
    const bool blocked = status.has(skinctl::Reason::blocked) || status.has(skinctl::Reason::displaced);
    for (std::size_t i = 0; i < N; ++i) {
      const bool beside =
          std::abs(robot.residual[i]) > band_[i] || (blocked && std::abs(robot.residual[i]) > 0.5 * band_[i]);
      const bool stands = std::abs(robot.measured.dq[i]) < still;
      // Blocked, it is let go and tried again a second later: the times add up.
      if (!free)
        stood_[i] = 0;
      else if (beside && stands)
        stood_[i] += dt;
      else
        stood_[i] = std::max(0.0, stood_[i] - (stands ? 0.1 : 2.0) * dt);
    }
    episode(t, robot, blocked, free);
    if (t < next_look_) return;
    next_look_ = t + 0.1;
    lag_ = monitor_.estimate(memory_);
  }

  /// 1 to N, or 0: none.
  [[nodiscard]] std::size_t stuck_joint() const noexcept {
    for (std::size_t i = 0; i < N; ++i)
      if (stood_[i] > standing) return i + 1;
    return blocked_for_ > hopeless ? blocked_ + 1 : 0;
  }
  [[nodiscard]] bool late() const noexcept { return lag_.lag_deviation < uncertain && lag_.lag > most_lag; }
  /// Lag beyond the declared one [s], if it is known.
  [[nodiscard]] const skinctl::Following<N>& following() const noexcept { return lag_; }

 private:
  /// From the cycle in which the resolver finds a joint blocked, until that joint has moved.
  template <class RobotMemory>
  void episode(double t, const RobotMemory& robot, bool blocked, bool free) noexcept {
    if (began_ < 0 && blocked && free) {
      began_ = t;
      blocked_ = 0;
      for (std::size_t i = 1; i < N; ++i)
        if (std::abs(robot.residual[i]) * band_[blocked_] > std::abs(robot.residual[blocked_]) * band_[i])
          blocked_ = i;
      from_ = robot.measured.q[blocked_];
    }
    if (began_ >= 0 && (!free || std::abs(robot.measured.q[blocked_] - from_) > 0.5 * band_[blocked_]))
      began_ = -1;
    blocked_for_ = began_ >= 0 ? t - began_ : 0;
  }

  skinctl::FollowingMonitor<N> monitor_;
  skinctl::JointPosition<N> band_;
  typename skinctl::FollowingMonitor<N>::Memory memory_{};
  skinctl::Following<N> lag_{};
  std::array<double, N> stood_{};
  double touched_at_ = -1e9, next_look_ = 0, began_ = -1, blocked_for_ = 0, from_ = 0;
  std::size_t blocked_ = 0;
};

/// The same of an arm by torque, which is told no position: a joint that stands away from its target, nothing
/// touches the skin, and the arm keeps clear of nothing. What it is told too late shakes the arm; the robot
/// stops it then.
template <std::size_t N>
class StandingJudge {
 public:
  static constexpr double hopeless = 3;     ///< for so long [s]: what friction is left over is learnt sooner
  static constexpr double standing = 0.3;   ///< for so long under twice the torque of friction [s]
  static constexpr double away = 0.03;      ///< [rad]
  static constexpr double untouched = 0.5;  ///< since the last touch [s]
  static constexpr double still = 0.01;     ///< [rad/s]
  static constexpr double uncertain = 0;

  /// @param friction  the most that holds a joint [N m].
  explicit StandingJudge(const skinctl::JointTorque<N>& friction) noexcept : friction_(friction) {
    lag_.lag_deviation = std::numeric_limits<double>::infinity();
  }
  /// @param robot   the resolver's memory.
  /// @param force   that the skin feels [N].
  /// @param target  of the task [rad].
  template <class RobotMemory>
  void cycle(double t, double dt, const RobotMemory& robot, skinctl::Status status, double force,
             const skinctl::JointPosition<N>& target) noexcept {
    if (force > 1 || status.has(skinctl::Reason::clearance_kept)) touched_at_ = t;
    const bool free = t - touched_at_ > untouched;
    for (std::size_t i = 0; i < N; ++i) {
      const bool stands = free && std::abs(robot.measured().dq[i]) < still &&
                          std::abs(robot.measured().q[i] - target[i]) > away;
      const bool pulled = std::abs(robot.command().torque[i]) > 2 * friction_[i];
      stood_[i] = stands ? stood_[i] + dt : 0;
      resisted_[i] = stands && pulled ? resisted_[i] + dt : 0;
    }
  }
  /// 1 to N, or 0: none.
  [[nodiscard]] std::size_t stuck_joint() const noexcept {
    for (std::size_t i = 0; i < N; ++i)
      if (stood_[i] > hopeless || resisted_[i] > standing) return i + 1;
    return 0;
  }
  [[nodiscard]] bool late() const noexcept { return false; }
  [[nodiscard]] const skinctl::Following<N>& following() const noexcept { return lag_; }

 private:
  skinctl::JointTorque<N> friction_;
  skinctl::Following<N> lag_{};
  std::array<double, N> stood_{}, resisted_{};
  double touched_at_ = -1e9;
};

}  // namespace compliant_ur5
