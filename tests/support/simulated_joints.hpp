// Stiff industrial joints: they follow commands after a delay and with a first-order lag, whatever pushes on
// them. Standard library only.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace skinctl::testing {

template <std::size_t N>
class SimulatedJoints {
 public:
  using Row = std::array<double, N>;
  enum class Kind { position, velocity };

  /// @param delay, lag  [s] of every joint: `lag * dq/dt = command(t - delay) - q`, or the same of
  ///                    velocities.
  SimulatedJoints(Kind kind, double delay, double lag, const Row& q)
      : kind_(kind), delay_(delay), lag_(lag), q_(q), target_(kind == Kind::position ? q : Row{}) {}

  /// Holds this command from `t + delay` on.
  void command(double t, const Row& value) { under_way_.push_back({t + delay_, value}); }

  /// Runs to time `t` [s].
  void advance(double t) {
    while (!under_way_.empty() && under_way_.front().time <= t) {
      run(under_way_.front().time);
      target_ = under_way_.front().value;
      under_way_.pop_front();
    }
    run(t);
  }

  /// Whether joint `i` cannot move.
  void hold_fast(std::size_t i, bool fast) { stuck_[i] = fast; }
  /// Joint `i` is moved by hand.
  void displace(std::size_t i, double by) { q_[i] += by; }

  const Row& q() const { return q_; }
  const Row& dq() const { return dq_; }
  double time() const { return time_; }

 private:
  struct Command {
    double time;
    Row value;
  };

  // Exact for a constant target.
  void run(double t) {
    const double dt = t - time_;
    if (dt <= 0) return;
    const double decay = lag_ > 0 ? std::exp(-dt / lag_) : 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (stuck_[i]) {
        dq_[i] = 0;
        continue;
      }
      if (kind_ == Kind::position) {
        const double old = q_[i];
        q_[i] = target_[i] + (old - target_[i]) * decay;
        dq_[i] = lag_ > 0 ? (target_[i] - q_[i]) / lag_ : (q_[i] - old) / dt;
      } else {
        q_[i] += target_[i] * dt + (dq_[i] - target_[i]) * lag_ * (1 - decay);
        dq_[i] = target_[i] + (dq_[i] - target_[i]) * decay;
      }
    }
    time_ = t;
  }

  Kind kind_;
  double delay_, lag_, time_ = 0;
  Row q_, dq_{}, target_;
  std::array<bool, N> stuck_{};
  std::deque<Command> under_way_;
};

}  // namespace skinctl::testing
