// A simulated robot beside the program, as a real one would stand there.
#pragma once

#include <unistd.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>

#include "examples/compliant_ur5/run.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "examples/simulated_ur5/scenario.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace compliant_ur5 {

inline Settings settings() {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  s.quiet = true;
  read_scenario(s.scenario, s);
  return s;
}

/// A port on which nobody listens just now, and that no connection gets by itself: below those that the
/// system gives away (32768 and up) and those of a robot (29999 and up), so that nobody takes it before it is
/// listened on.
template <class Socket>
std::uint16_t free_port() {
  using boost::asio::ip::address_v4;
  static std::atomic<unsigned> next{static_cast<unsigned>(getpid()) * 97};
  boost::asio::io_context io;
  for (int tries = 0; tries < 1000; ++tries) {
    const auto port = static_cast<std::uint16_t>(20000 + next++ % 9000);
    boost::system::error_code error;
    Socket socket(io);
    const typename Socket::protocol_type::endpoint here(address_v4::loopback(), port);
    socket.open(here.protocol(), error);
    if (!error) socket.bind(here, error);
    if (!error) return port;
  }
  throw std::runtime_error("no port is free");
}
inline std::uint16_t free_tcp_port() {
  return free_port<boost::asio::ip::tcp::acceptor>();
}
inline std::uint16_t free_udp_port() {
  return free_port<boost::asio::ip::udp::socket>();
}

/// A simulated robot beside the program, as a real one would stand there.
class Beside {
 public:
  /// @param change  of the robot before it starts, as its addresses and what touches it: nothing does
  ///                without it.
  explicit Beside(Settings& s, const std::function<void(simulated_ur5::Config&)>& change = {}) {
    const auto add = [&]<std::size_t I, std::size_t N>(simulated_ur5::Config& to,
                                                       const skinctl::Patch<I, N>& patch) {
      for (const auto& c : patch.placed()) {
        const auto p = c.X_LC.origin(), n = c.X_LC.axis_z();
        simulated_ur5::SkinCell cell;
        cell.id = c.id;
        cell.link = I;
        cell.position = {p.x, p.y, p.z};
        cell.normal = {n.x, n.y, n.z};
        simulated_ur5::complete(cell);
        to.controller.cells.push_back(cell);
      }
    };
    simulated_ur5::Config config;
    simulated_ur5::read_scenario(s.scenario, config);
    config.controller.series = s.rate > 125 ? simulated_ur5::Series::e_series : simulated_ur5::Series::cb3;
    config.controller.powered = false;  // the program has to switch it on
    config.controller.power_on_time = config.controller.brake_release_time = 0.1;
    config.controller.touches.clear();
    std::apply([&](const auto&... patch) { (add(config, patch), ...); },
               skinctl::ur5::skin_patches<compliant_ur5::cells>());
    std::memset(static_cast<void*>(&config.ports), 0, sizeof config.ports);  // any that are free
    config.speed = 1;
    s.skin_port = free_udp_port();
    config.skin_port = s.skin_port;
    if (change) change(config);
    s.robot = config.address;
    s.speed = 1;
    s.compare = false;
    robot = std::make_unique<simulated_ur5::SimulatedUr5>(config);
    robot->start();
    s.rtde_port = robot->ports().rtde;
    s.script_port = robot->ports().secondary;
    s.dashboard_port = robot->ports().dashboard;
  }
  /// Whether all joints stand still within two seconds.
  bool comes_to_rest() {
    for (int k = 0; k < 40; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      const auto now = robot->snapshot();
      double speed = 0;
      for (const double v : now.true_dq) speed = std::max(speed, std::abs(v));
      if (speed < 1e-6) return true;
    }
    return false;
  }
  std::unique_ptr<simulated_ur5::SimulatedUr5> robot;
};

}  // namespace compliant_ur5
