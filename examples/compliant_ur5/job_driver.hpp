// Robot and skin as the loop of a run wants them.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "examples/adapters/allegro/palm.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/ur5/driver.hpp"
#include "examples/compliant_ur5/sense_reader.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "skinctl/hardware/robot.hpp"

namespace compliant_ur5::running {

using namespace skinctl;

/// The receiver as a source of samples on the robot's clock. Of the cycles that a silent robot owes, which
/// run at once, only the last asks for any: the others are of a time before the samples that have come. So is
/// the cycle of a state that is late.
struct SkinOnRobotClock {
  static constexpr Nanoseconds behind = 5ms;  ///< so far the cycle's time may lag
  adapters::skin::Receiver& receiver;
  const adapters::ur5::Driver& driver;
  adapters::allegro::Palm* palm = nullptr;
  std::vector<CellSample> both{};  ///< room for the receiver's and the palm's

  std::span<const CellSample> poll() noexcept {
    const auto now = driver.clock_now();
    if (now - driver.clock() > behind) return {};
    const auto received = receiver.poll(now);
    if (palm == nullptr) return received;
    const std::size_t n = std::min(received.size(), both.size() - 1);
    std::copy_n(received.begin(), n, both.begin());
    const auto felt = palm->take(palm_cell, now);
    if (felt) both[n] = *felt;
    return {both.data(), n + (felt ? 1 : 0)};
  }
};

/// The driver, which sends no torque for a state that nobody knows: it would accelerate. The robot's program
/// brakes and holds.
template <Sense S>
struct JobDriver {
  adapters::ur5::Driver& driver;
  SenseReader<S>& reader;
  bool by_torque = false;
  Heard heard = Heard::state;

  Heard wait(State<6>& state) noexcept { return heard = driver.wait(state); }
  JointPosition<6> told() noexcept { return driver.told(); }
  bool send(const auto& command) noexcept {
    if (by_torque && heard == Heard::silent) return driver.hold();
    return driver.send(command);
  }
  auto wrenches() noexcept
    requires(S == Sense::wrist)
  {
    return reader.read(driver);
  }
  auto motor_torque() noexcept
    requires(S == Sense::motors)
  {
    return reader.read(driver);
  }
  void stop() noexcept { driver.stop(); }
};

/// Takes what the wrist sensor reads in 0.5 s, while the arm is told to stay, for its zero. Throws
/// `skinctl::ConfigurationError` where the readings do not rest; a robot that is lost is found by the loop.
template <Interface I>
void tare(JobDriver<Sense::wrist>& robot, double rate) {
  std::vector<WrenchSample> samples;
  State<6> state;
  for (int k = 0; k < static_cast<int>(0.5 * rate); ++k) {
    if (robot.wait(state) == Heard::lost) return;
    for (const WrenchSample& s : robot.wrenches()) samples.push_back(s);
    bool sent = false;
    if constexpr (I == Interface::position) {
      PositionCommand<6> stay;
      stay.position = robot.told();
      sent = robot.send(stay);
    } else {
      sent = robot.send(VelocityCommand<6>());
    }
    if (!sent) return;
  }
  robot.reader.tare(samples, state.q);
}

}  // namespace compliant_ur5::running
