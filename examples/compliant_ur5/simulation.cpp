#include "examples/compliant_ur5/simulation.hpp"

#include <algorithm>
#include <boost/asio/ip/address.hpp>

#include "examples/adapters/ur5/program.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "examples/compliant_ur5/summary.hpp"
#include "examples/simulated_ur5/scenario.hpp"
#include "examples/simulated_ur5/skin_faults.hpp"

namespace compliant_ur5 {

using skinctl::Interface;

std::unique_ptr<simulated_ur5::SimulatedUr5> start_simulation(const Settings& s, std::uint16_t skin_port,
                                                              const std::optional<adapters::skin::Key>& key,
                                                              RunLog& log) {
  simulated_ur5::Config config;
  simulated_ur5::read_scenario(s.scenario, config);
  const bool e_series = s.rate > 125 || s.sense == Sense::wrist;
  config.controller.series = e_series ? simulated_ur5::Series::e_series : simulated_ur5::Series::cb3;
  Settings worn = s;
  if (!s.simulated_skin.empty()) worn.skin = s.simulated_skin;
  config.controller.cells = simulated_cells(skin_patches(worn));
  if (!s.skin_faults.empty())
    config.controller.skin.faults = simulated_ur5::read_skin_faults(s.skin_faults, config.controller.cells);
  config.controller.powered = true;
  if (s.hand) {
    config.controller.arm.unknown_payload = s.hand->mass;
    config.controller.arm.payload_centre = {s.hand->centre[0], s.hand->centre[1], s.hand->centre[2]};
  }
  config.ports = {0, 0, 0, 0, 0};  // any that are free
  config.speed = s.speed;
  config.real_time = true;
  config.skin_host = s.skin_address;
  if (boost::asio::ip::make_address(s.skin_address).is_unspecified()) config.skin_host = "127.0.0.1";
  config.skin_port = skin_port;
  config.skin_key = key;
  if (!s.touch_profile.empty()) {
    // One recorded press on the forearm, and again on the upper arm.
    const auto profile = simulated_ur5::read_profile_file(s.touch_profile);
    std::vector<simulated_ur5::Touch> touches;
    double start = 2;
    for (const std::uint32_t cell : {145u, 250u}) {
      simulated_ur5::Touch touch;
      if (!config.controller.touches.empty()) touch = config.controller.touches.front();
      touch.name = s.touch_profile;
      touch.cell = std::min<std::uint32_t>(cell, cells - 20);
      touch.start = start;
      touch.profile = profile;
      touches.push_back(touch);
      start += touch.duration() + 6;
    }
    config.controller.touches = std::move(touches);
  }
  simulated_ur5::check(config);
  double stiffness = 0, travel = 1e9, speed = 0;
  for (const auto& t : config.controller.touches) {
    stiffness = std::max(stiffness, t.stiffness);
    travel = std::min(travel, t.travel);
    speed = std::max(speed, t.approach_speed);
  }
  const auto& arm = config.controller.arm;
  log.scenario = {{"touches of the whole scenario", std::to_string(config.controller.touches.size())},
                  {"stiffness of finger and skin", text("%.0f N/m", stiffness)},
                  {"approach speed", text("%.3f m/s", speed)},
                  {"travel beyond the surface", text("%.1f mm", 1000 * travel)},
                  {"robot's delay", text("%.1f ms", 1000 * arm.delay)},
                  {"robot's lag", text("%.1f ms", 1000 * arm.lag)}};
  if (s.interface == Interface::position)
    log.scenario.push_back({"lookahead of servoj", text("%.1f ms", 1000 * adapters::ur5::servoj_lookahead)});
  if (s.live) {
    config.controller.touches.push_back(simulated_ur5::LedFinger::touch());
    config.controller.touches.back().name = "pointer";
  }
  auto robot = std::make_unique<simulated_ur5::SimulatedUr5>(std::move(config));
  robot->start();
  return robot;
}

}  // namespace compliant_ur5
