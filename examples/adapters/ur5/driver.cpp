#include "examples/adapters/ur5/driver.hpp"

#include <future>

#include "examples/adapters/ur5/panel.hpp"
#include "skinctl/io/formatted.hpp"

namespace adapters::ur5 {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

Driver::Driver(const DriverConfig& config) : config_(config) {
  skinctl::require(config.rate >= 1 && config.rate <= 500, "rate", config.rate, "1 to 500 1/s");
  skinctl::require(config.interface != skinctl::Interface::torque || config.rate == 500, "rate by torque",
                   config.rate, "500 1/s: a torque counts for 2 ms");
  skinctl::require(config.robot_patience.count() >= 4 && config.robot_patience.count() <= 2000,
                   "robot patience", static_cast<double>(config.robot_patience.count()), "4 to 2000 ms");
  for (std::size_t i = 0; i < 6; ++i) {
    skinctl::require(config.torque.viscous[i] >= 0 && config.torque.viscous[i] <= 1, "viscous scale",
                     config.torque.viscous[i], "0 to 1");
    skinctl::require(config.torque.coulomb[i] >= 0 && config.torque.coulomb[i] <= 1, "Coulomb scale",
                     config.torque.coulomb[i], "0 to 1");
  }
}

Driver::~Driver() {
  stop();
}

void Driver::connect() {
  stop();
  error_.clear();
  fault_ = Fault::none;
  playing_ = false;
  silent_waits_ = 0;
  wrong_windows_ = 0;
  posted_ = 0;
  round_trip_ = -1;
  report_ = {};
  try {
    rtde_.connect(config_.host, config_.rtde_port, config_.connect_timeout);
    if (config_.interface == skinctl::Interface::torque && !rtde_.version().takes_torques())
      throw ConnectionError("the controller's version " + rtde_.version().text() +
                            " takes no torques: 5.23 or later, PolyScope X 10.11 or later");
    subscribe();
    try {
      inputs_ = rtde_.inputs(
          "speed_slider_mask,speed_slider_fraction,standard_digital_output_mask,"
          "standard_digital_output,configurable_digital_output_mask,configurable_digital_output,"
          "tool_digital_output_mask,tool_digital_output");
    } catch (const ConnectionError&) {
      inputs_ = 0;  // somebody else's: slider and outputs are not ours to set
    }
    rtde_.start();
    refresh();
    if (report_.safety_mode == 3 && config_.unlock) unlock_protective_stop();
    if (report_.safety_mode >= 3)
      throw ConnectionError("the robot is in " + describe_safety_mode(report_.safety_mode) +
                            ": clear that first");
    if (config_.power_up) power_up();
    upload();
  } catch (const ConnectionError& e) {
    fault_ = Fault::unreachable;
    error_ = e.what();
    reverse_.close();
    script_.close();
    rtde_.close();
    throw;
  }
  started_ = slider_up_ = finite_at_ = window_stamp_ = report_.timestamp;
  window_ = heard_at_ = Clock::now();
  fastest_since_ = {}, late_ = {};  // a controller that was restarted counts anew
  running_ = true;
}

void Driver::subscribe() {
  std::string names = Report::recipe, types = Report::types;
  if (config_.tool) names += ",actual_TCP_pose", types += ",VECTOR6D";
  if (config_.motors != MotorOutput::none) {
    names += motors_in_newton_metres() ? ",actual_current_as_torque" : ",actual_current";
    types += ",VECTOR6D";
  }
  if (echoes()) names += ",output_int_register_" + std::to_string(echo_register), types += ",INT32";
  recipe_ = rtde_.outputs(config_.rate, names, types);
}

bool Driver::by_rest() const noexcept {
  return config_.panel == PanelKind::rest ||
         (config_.panel == PanelKind::automatic && rtde_.version().is_polyscope_x());
}

bool Driver::is_state(const Package& p, Report& report) const noexcept {
  return p.type == package::data && !p.payload.empty() && p.payload[0] == recipe_ &&
         report.decode(p.payload.subspan(1), {config_.tool, config_.motors != MotorOutput::none, echoes()});
}

void Driver::refresh() {
  const auto deadline = Clock::now() + config_.connect_timeout;
  bool found = false;
  Package p{};
  while (!found && Clock::now() < deadline) {
    const RtdeEnd end = rtde_.read(p, Timeout(50));
    if (end == RtdeEnd::closed || end == RtdeEnd::nonsense)
      throw ConnectionError(row(end == RtdeEnd::closed ? Fault::stream_closed : Fault::nonsense).words);
    if (end == RtdeEnd::none && p.type == package::message) rtde_.hear(p.payload);
    found = end == RtdeEnd::none && is_state(p, report_);
  }
  if (!found) throw ConnectionError("no state from the robot");
  while (const auto more = rtde_.next()) static_cast<void>(is_state(*more, report_));
}

/// Asks the panel, and reads states meanwhile: the controller hangs up on those who stop reading.
void Driver::act(const char* dashboard_command, const char* rest_action) {
  std::string answer;
  auto done = std::async(std::launch::async, [&] {
    if (by_rest()) {
      Rest(config_.host, config_.rest_port, 4 * config_.connect_timeout).act(rest_action);
    } else {
      Dashboard dashboard;
      dashboard.connect(config_.host, config_.dashboard_port, config_.connect_timeout);
      answer = dashboard.ask(dashboard_command);
    }
  });
  while (done.wait_for(std::chrono::milliseconds(0)) != std::future_status::ready) refresh();
  done.get();
  const bool refused =
      answer.find("Cannot") != std::string::npos || answer.find("ailed") != std::string::npos ||
      answer.find("could not") != std::string::npos || answer.find("not allowed") != std::string::npos;
  if (refused)
    throw ConnectionError("the robot's panel refuses '" + std::string(dashboard_command) + "': " + answer);
}

void Driver::power_up() {
  const auto deadline = Clock::now() + 4 * config_.connect_timeout;
  if (report_.robot_mode == 7) return;
  act("power on", "POWER_ON");
  for (bool released = false; report_.robot_mode != 7;) {
    if (Clock::now() > deadline)
      throw ConnectionError("the robot did not come to run: it is " +
                            describe_robot_mode(report_.robot_mode));
    refresh();
    if (report_.robot_mode == 5 && !released) {
      act("brake release", "BRAKE_RELEASE");
      released = true;
    }
  }
}

void Driver::unlock_protective_stop() {
  if (!by_rest()) act("close safety popup", "");
  act("unlock protective stop", "UNLOCK_PROTECTIVE_STOP");
  const auto deadline = Clock::now() + config_.connect_timeout;
  do refresh();
  while (report_.safety_mode == 3 && Clock::now() < deadline);
}

void Driver::upload() {
  script_.connect(config_.host, config_.script_port, "the robot's script interface", config_.connect_timeout);
  ProgramSettings settings{.address = config_.reverse_address,
                           .port = config_.told_port,
                           .rate = config_.rate,
                           .interface = config_.interface,
                           .version = rtde_.version(),
                           .torque = config_.torque,
                           .echo = echoes()};
  if (settings.address.empty()) settings.address = script_.local_address();
  auto acceptor =
      listen(io_, config_.told_port == 0 ? settings.address : script_.local_address(), config_.reverse_port);
  if (settings.port == 0) settings.port = acceptor.local_endpoint().port();
  const std::string text = program(settings);
  if (!script_.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                     config_.connect_timeout))
    throw ConnectionError("the robot's script interface hung up");
  try {
    reverse_.accept(acceptor, script_.remote_address(), "the program on the robot", config_.connect_timeout);
  } catch (const ConnectionError& e) {
    throw ConnectionError(
        std::string(e.what()) + " to " + settings.address + ":" + std::to_string(settings.port) +
        ". Is that the address by which the robot reaches this computer, does a firewall here close the "
        "port, or has the controller refused the program (see the log at its panel; it may not be in remote "
        "control)?");
  }
  static_cast<void>(reverse_.set_retransmission_wait(config_.robot_patience / 10));
  // Hold still until the first command, which may take as long as the loop takes to start.
  if (!reverse_.write(message(2000, {}, mode::idle), config_.connect_timeout))
    throw ConnectionError("the program on the robot hung up");
  posted_ = 1;
  posted_at_[1] = Clock::now();
  refresh();
}

bool Driver::set_speed_slider(double share) noexcept {
  if (inputs_ == 0 || !(share >= 0 && share <= 1)) return false;
  std::array<std::uint8_t, 22> bytes{0, 22, package::data, inputs_, 0, 0, 0, 1};
  const auto bits = std::bit_cast<std::uint64_t>(share);
  for (std::size_t k = 0; k < 8; ++k) bytes[8 + k] = static_cast<std::uint8_t>(bits >> (56 - 8 * k));
  return rtde_.write(bytes, Timeout(20));
}

bool Driver::set_digital_output(unsigned output, bool on) noexcept {
  if (inputs_ == 0 || output > 17) return false;
  std::array<std::uint8_t, 22> bytes{0, 22, package::data, inputs_};
  const std::size_t group = output / 8;
  const auto bit = static_cast<std::uint8_t>(1u << (output % 8));
  bytes[16 + 2 * group] = bit;
  bytes[17 + 2 * group] = on ? bit : std::uint8_t(0);
  return rtde_.write(bytes, Timeout(20));
}

bool Driver::set_payload(double mass, const std::array<double, 3>& centre) {
  skinctl::require(mass >= 0 && mass <= 50, "payload", mass, "0 to 50 kg");
  for (const double x : centre)
    skinctl::require(x >= -1 && x <= 1, "payload's centre of mass", x, "-1 to 1 m");
  const std::string text =
      skinctl::formatted("sec skinctl_payload():\n  set_payload(%.4f, [%.5f, %.5f, %.5f])\nend\n", mass,
                         centre[0], centre[1], centre[2]);
  return script_.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, Timeout(1000));
}

}  // namespace adapters::ur5
