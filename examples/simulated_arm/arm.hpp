// The body of a simulated industrial arm: six stiff joints that follow positions late, and a sensor in the
// wrist.
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "examples/adapters/robot_clock.hpp"
#include "skinctl/testing/undeclared_joints.hpp"

namespace simulated_arm {

using adapters::SixJoints;

/// A hand that pushes the tool, along the axes of the sensor, whatever the arm does.
struct Push {
  double start = 0, duration = 1;      ///< [s]
  std::array<double, 3> force{};       ///< [N]
  static constexpr double rise = 0.2;  ///< in which it comes and goes [s]
  [[nodiscard]] double share(double t) const {
    return std::clamp(std::min(t - start, start + duration - t) / rise, 0.0, 1.0);
  }
};

/// What goes wrong from `from` on: shares of datagrams, and times; negative: never.
struct Faults {
  double from = 0;
  double lose = 0, twice = 0, swap = 0, cut = 0;  ///< of the controller's datagrams
  double lose_answers = 0;
  double late_answers = 0;  ///< [s]
  double garbled = 0;       ///< share of the datagrams that are noise
  double silent_at = -1;    ///< the controller ends
  double halted_at = -1;    ///< an emergency stop
  double restart_at = -1;   ///< numbers begin anew
  bool fewer_joints = false, mute = false;
};

struct Config {
  SixJoints home{0, 0.3, 0.2, 0, 1.0, 0};  ///< [rad]
  double delay = 0.008, lag = 0.03;        ///< from an answer to the joints [s]
  double speed = 1;                        ///< 0: as fast as answers come
  bool sensor = true;
  std::vector<Push> pushes;
  Faults faults;
  /// Told the time [s] and the joints [rad] of each cycle, before its state is sent.
  std::function<void(double time, std::span<const double> q)> watched{};
};

class Arm {
 public:
  static constexpr std::size_t joints = 6;
  explicit Arm(const Config& config)
      : config_(config), told_(config.home), joints_(Joints::Kind::position, truth(config), config.home) {}

  void advance(double t) { joints_.advance(t); }
  void command(const SixJoints& q) {
    told_ = q;
    joints_.command(joints_.time(), q);
  }
  /// The drives hold where the joints are.
  void halt() {
    if (std::exchange(halted_, true)) return;
    command(joints_.q());
  }
  [[nodiscard]] const SixJoints& q() const { return joints_.q(); }
  [[nodiscard]] const SixJoints& dq() const { return joints_.dq(); }
  [[nodiscard]] const SixJoints& told() const { return told_; }
  [[nodiscard]] double time() const { return joints_.time(); }
  /// What the sensor reads: hands, no weight.
  [[nodiscard]] SixJoints wrench() const {
    SixJoints w{};
    for (const Push& p : config_.pushes)
      for (std::size_t i = 0; i < 3; ++i) w[i] += p.share(time()) * p.force[i];
    return w;
  }

 private:
  using Joints = skinctl::testing::UndeclaredJoints<6>;
  static skinctl::testing::JointTruth<6> truth(const Config& c) {
    skinctl::testing::JointTruth<6> t;
    t.delay = c.delay;
    t.lag = c.lag;
    return t;
  }
  Config config_;
  SixJoints told_;
  Joints joints_;
  bool halted_ = false;
};

}  // namespace simulated_arm
