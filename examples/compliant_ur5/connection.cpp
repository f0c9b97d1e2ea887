#include "examples/compliant_ur5/connection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "examples/adapters/ur5/round_trip.hpp"
#include "examples/compliant_ur5/simulation.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "examples/compliant_ur5/summary.hpp"
#include "skinctl/hardware/scheduling.hpp"

namespace compliant_ur5 {

using namespace skinctl;

namespace {

bool by_the_clock(const Settings& s) {
  return s.robot || s.speed == 1;
}

adapters::Timeout milliseconds_of(double seconds) {
  return adapters::Timeout(static_cast<int>(std::lround(1000 * seconds)));
}

adapters::skin::ReceiverConfig receiver_config(const Settings& s,
                                               const std::optional<adapters::skin::Key>& key) {
  return {.address = s.skin_address,
          .port = s.skin_port,
          .sender = s.skin_sender,
          .key = key,
          .noise = force_noise,
          .real_time = by_the_clock(s)};
}

adapters::ur5::DriverConfig driver_config(const Settings& s, simulated_ur5::SimulatedUr5* simulation) {
  adapters::ur5::DriverConfig config;
  config.rate = s.rate;
  config.interface = s.interface;
  config.rtde_port = s.rtde_port;
  config.script_port = s.script_port;
  config.dashboard_port = s.dashboard_port;
  config.rest_port = s.rest_port;
  config.reverse_port = s.reverse_port;
  config.told_port = s.told_port;
  config.unlock = s.unlock;
  config.echo = true;
  config.give_up = milliseconds_of(s.control.state_patience);
  if (s.interface == Interface::torque) {
    config.silence = adapters::Timeout(20);  // before the robot's patience
    config.torque.viscous = s.torque.viscous_scale;
    config.torque.coulomb = s.torque.coulomb_scale;
    config.robot_patience = milliseconds_of(s.torque.patience);
  }
  config.real_time = by_the_clock(s);
  if (simulation == nullptr) {
    config.host = *s.robot;
    return config;
  }
  const auto ports = simulation->ports();
  config.rtde_port = ports.rtde;
  config.script_port = ports.secondary;
  config.dashboard_port = ports.dashboard;
  if (s.speed == 0) config.silence = config.give_up = std::chrono::milliseconds(3000);
  return config;
}

}  // namespace

double network_delay(const Settings& s, RunLog& log) {
  if (!s.robot || s.network_delay >= 0) return std::max(s.network_delay, 0.0);
  const auto trip = adapters::ur5::measure_round_trip(*s.robot, s.rtde_port, s.rate, 25);
  const double beyond = std::max(0.0, seconds<double>(trip.controller_median) - 1 / s.rate);
  log.scenario.push_back(
      {"round trip to the controller, median", text("%.2f ms", milliseconds(trip.median))});
  log.scenario.push_back({"beyond one cycle, declared as delay", text("%.1f ms", 1000 * beyond)});
  return beyond;
}

Connection::Connection(const Settings& s, void (*ask)(adapters::ur5::DriverConfig&), RunLog& log)
    : key(s.skin_key.empty() ? std::nullopt : std::optional(adapters::skin::Key::read(s.skin_key))),
      receiver(receiver_config(s, key)),
      simulation(s.robot ? nullptr : start_simulation(s, receiver.port(), key, log)),
      driver([&] {
        auto config = driver_config(s, simulation.get());
        ask(config);
        return config;
      }()) {
  driver.connect();
  if (s.hand && !driver.set_payload(s.hand->mass, s.hand->centre))
    throw adapters::ConnectionError("the robot does not take the payload");
  if (s.quiet) return;
  std::printf("connected to %s, controller %s, %.0f Hz, %s\n",
              s.robot ? s.robot->c_str() : "the simulated UR5", driver.controller().text().c_str(), s.rate,
              in_words(s.interface));
  if (s.speed != 0 || s.robot) std::printf("%s", request_real_time().report.c_str());
}

}  // namespace compliant_ur5
