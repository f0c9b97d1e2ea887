// What moves joints by positions, whatever its protocol and the number of its joints.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "examples/calibrate_skin/calibration.hpp"
#include "skinctl/hardware/robot.hpp"

namespace calibrate_skin {

/// A connected driver. Throws `std::runtime_error` where the robot is lost.
class Drive {
 public:
  virtual ~Drive() = default;
  /// Waits for the next state; its time by the robot's clock.
  virtual skinctl::Nanoseconds hear() = 0;
  virtual void tell(const JointAngles& q) = 0;
  virtual void stop() = 0;
  [[nodiscard]] virtual JointAngles measured() const = 0;
  /// Where a motion has to begin: there an arm on springs was told to be.
  [[nodiscard]] virtual JointAngles start() const = 0;
  /// Currents of the motors [A]; empty: it tells none.
  [[nodiscard]] virtual JointAngles currents() const = 0;
};

template <class Driver, std::size_t N>
class DriveOf : public Drive {
 public:
  template <class... Args>
  explicit DriveOf(Args&&... args) : driver_(std::forward<Args>(args)...) {
    driver_.connect();
  }
  skinctl::Nanoseconds hear() override {
    for (;;) {
      const skinctl::Heard heard = driver_.wait(state_);
      if (heard == skinctl::Heard::lost)
        throw std::runtime_error(std::string("the robot was lost: ") + driver_.error());
      if (heard == skinctl::Heard::state) return state_.time;
    }
  }
  void tell(const JointAngles& q) override {
    skinctl::PositionCommand<N> command;
    command.valid = true;
    command.time = state_.time;
    for (std::size_t i = 0; i < N; ++i) command.position[i] = q.at(i);
    if (!driver_.send(command))
      throw std::runtime_error(std::string("the robot takes no commands: ") + driver_.error());
  }
  void stop() override { driver_.stop(); }
  [[nodiscard]] JointAngles measured() const override {
    JointAngles q;
    for (std::size_t i = 0; i < N; ++i) q.push_back(state_.q[i]);
    return q;
  }
  [[nodiscard]] JointAngles start() const override {
    if constexpr (requires { driver_.newest().told; })
      return {driver_.newest().told.begin(), driver_.newest().told.end()};
    else
      return measured();
  }
  [[nodiscard]] JointAngles currents() const override {
    if constexpr (requires { driver_.report().motors; })
      return {driver_.report().motors.begin(), driver_.report().motors.end()};
    else
      return {};
  }

 private:
  Driver driver_;
  skinctl::State<N> state_;
};

/// By a controller that is the clock: stream_motion, rsi, egm, fri, franka. Throws what its driver throws, and
/// `ConfigurationError` for a robot of another number of joints.
[[nodiscard]] std::unique_ptr<Drive> clocked_drive(const ArmOptions& options);

}  // namespace calibrate_skin
