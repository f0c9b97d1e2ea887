// The ways to robot and skin.
#pragma once

#include <memory>
#include <optional>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/ur5/driver.hpp"
#include "examples/compliant_ur5/run_log.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"

namespace compliant_ur5 {

/// What the way to the robot and back takes beyond one cycle, which the declared delay has in it [s].
double network_delay(const Settings& settings, RunLog& log);

/// Receiver of the skin and driver of the robot, connected; the robot too, if it is a simulated one.
struct Connection {
  /// Throws `adapters::ConnectionError`; the numbers of a simulated robot go to `log.scenario`.
  /// @param ask  adds to the driver's configuration what the run reads beside the state.
  Connection(const Settings& settings, void (*ask)(adapters::ur5::DriverConfig&), RunLog& log);

  const std::optional<adapters::skin::Key> key;
  adapters::skin::Receiver receiver;
  const std::unique_ptr<simulated_ur5::SimulatedUr5> simulation;  ///< null: a real robot
  adapters::ur5::Driver driver;
};

}  // namespace compliant_ur5
