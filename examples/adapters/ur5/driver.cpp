#include "examples/adapters/ur5/driver.hpp"

#include <cmath>
#include <cstdio>
#include <thread>

namespace adapters::ur5 {
namespace {

using Clock = std::chrono::steady_clock;
using skinctl::Heard;
using skinctl::Interface;

/// Modes of the reverse socket's messages.
constexpr std::int32_t stopped = -2, idle = 0, servoj = 1, speedj = 2;

Timeout left_until(Clock::time_point deadline) {
  return std::max(Timeout(0), std::chrono::ceil<Timeout>(deadline - Clock::now()));
}

}  // namespace

Driver::Driver(const DriverConfig& config) : config_(config) {
  skinctl::require(config.rate >= 1 && config.rate <= 500, "rate", config.rate, "1 to 500 1/s");
  skinctl::require(config.interface != Interface::torque, "interface", 2, "position or velocity");
  skinctl::require(config.robot_patience.count() >= 4 && config.robot_patience.count() <= 2000,
                   "robot patience", static_cast<double>(config.robot_patience.count()), "4 to 2000 ms");
}

Driver::~Driver() {
  stop();
}

void Driver::connect() {
  error_.clear();
  rtde_.connect(config_.host, config_.rtde_port, "the robot's RTDE", config_.connect_timeout);
  negotiate();
  if (config_.power_up) power_up();
  upload();
  running_ = true;
}

void Driver::negotiate() {
  const auto send = [&](PackageWriter& w) {
    if (!rtde_.write(w.finish(), config_.connect_timeout)) throw ConnectionError("the robot's RTDE hung up");
  };
  PackageWriter version(package::version);
  version.u16(2);
  send(version);
  if (PayloadReader in(expect(package::version, "version").payload); in.u8() != 1)
    throw ConnectionError("the robot does not speak RTDE version 2");

  PackageWriter ask_controller(package::controller);
  send(ask_controller);
  PayloadReader numbers(expect(package::controller, "controller version").payload);
  controller_ = std::to_string(numbers.u32());
  for (int k = 0; k < 3; ++k) controller_ += "." + std::to_string(numbers.u32());

  PackageWriter outputs(package::outputs);
  outputs.f64(config_.rate);
  outputs.text(Report::recipe);
  send(outputs);
  PayloadReader in(expect(package::outputs, "outputs").payload);
  recipe_ = in.u8();
  const std::string types = in.rest();
  if (recipe_ == 0 || types != Report::types)
    throw ConnectionError("the robot does not offer what is needed: asked for " +
                          std::string(Report::recipe) + ", got " + types);
  PackageWriter start(package::start);
  send(start);
  if (PayloadReader answer(expect(package::start, "start").payload); answer.u8() != 1)
    throw ConnectionError("the robot refuses to send data");
}

Package Driver::expect(std::uint8_t type, const char* what) {
  const auto deadline = Clock::now() + config_.connect_timeout;
  Package p{};
  while (read_package(p, left_until(deadline))) {
    if (p.type == type) return p;
    if (p.type != package::message && p.type != package::data) ++nonsense_;  // data may overtake an answer
  }
  throw ConnectionError(std::string("the robot's RTDE gave no answer to ") + what +
                        (error_.empty() ? "" : ": " + error_));
}

bool Driver::read_package(Package& p, Timeout timeout) noexcept {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    if (const auto whole = framer_.next()) {
      p = *whole;
      return true;
    }
    if (framer_.broken()) {
      error_ = "nonsense on the robot's RTDE stream: a package of impossible size";
      return false;
    }
    std::size_t count = 0;
    const Read got = rtde_.read_some(framer_.room(), count, left_until(deadline));
    if (got == Read::closed) {
      error_ = "the robot closed the RTDE connection";
      return false;
    }
    if (got == Read::nothing) return false;
    framer_.received(count);
  }
}

std::string Driver::ask(const std::string& line) {
  const std::string message = line + "\n";
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.data());
  if (!line.empty() && !dashboard_.write({bytes, message.size()}, config_.connect_timeout))
    throw ConnectionError("the robot's dashboard hung up");
  const auto deadline = Clock::now() + config_.connect_timeout;
  for (;;) {
    if (const auto end = dashboard_rest_.find('\n'); end != std::string::npos) {
      std::string answer = dashboard_rest_.substr(0, end);
      dashboard_rest_.erase(0, end + 1);
      if (!answer.empty() && answer.back() == '\r') answer.pop_back();
      return answer;
    }
    std::array<std::uint8_t, 512> block{};
    std::size_t count = 0;
    if (dashboard_rest_.size() > 4096 ||
        dashboard_.read_some(block, count, left_until(deadline)) != Read::some)
      throw ConnectionError("the robot's dashboard gave no answer to '" + line + "'");
    dashboard_rest_.append(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

void Driver::power_up() {
  const auto deadline = Clock::now() + 4 * config_.connect_timeout;
  const auto refresh = [&] {
    Package p{};
    while (read_package(p, Timeout(0)) || (error_.empty() && read_package(p, Timeout(50)))) {
      if (p.type == package::data && p.payload.size() > 1 && p.payload[0] == recipe_ &&
          report_.decode(p.payload.subspan(1)))
        return;
    }
    if (!error_.empty()) throw ConnectionError(error_);
  };
  refresh();
  if (report_.safety_mode >= 3)
    throw ConnectionError("the robot is in " + describe_safety_mode(report_.safety_mode) +
                          ": clear that first");
  if (report_.robot_mode == 7) return;
  dashboard_.connect(config_.host, config_.dashboard_port, "the robot's dashboard", config_.connect_timeout);
  ask("");  // greeting
  ask("power on");
  for (bool released = false; report_.robot_mode != 7;) {
    if (Clock::now() > deadline)
      throw ConnectionError("the robot did not come to run: it is " +
                            describe_robot_mode(report_.robot_mode));
    refresh();
    if (report_.robot_mode == 5 && !released) {
      ask("brake release");
      released = true;
    }
  }
  dashboard_.close();
}

void Driver::upload() {
  script_.connect(config_.host, config_.script_port, "the robot's script interface", config_.connect_timeout);
  const std::string address =
      config_.reverse_address.empty() ? script_.local_address() : config_.reverse_address;
  auto acceptor = listen(io_, address, config_.reverse_port);
  const std::string text = program(address, acceptor.local_endpoint().port(), config_.rate);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  if (!script_.write({bytes, text.size()}, config_.connect_timeout))
    throw ConnectionError("the robot's script interface hung up");
  reverse_.accept(acceptor, script_.remote_address(), "the program on the robot", config_.connect_timeout);
  // Hold still until the first command, which may take as long as the loop takes to start.
  if (!reverse_.write(message(2000, {}, idle), config_.connect_timeout))
    throw ConnectionError("the program on the robot hung up");
}

std::string Driver::program(const std::string& address, std::uint16_t port, double rate) {
  char text[3000];
  // One thread moves, the other reads; what is read counts until the next message or the time-out in it.
  std::snprintf(text, sizeof text, R"(def skinctl():
  steptime = %.6f
  global target = [0, 0, 0, 0, 0, 0]
  global mode = 0
  thread mover():
    while True:
      enter_critical
      q = target
      m = mode
      exit_critical
      if m == 1:
        servoj(q, t=steptime, lookahead_time=%.2f, gain=2000)
      elif m == 2:
        speedj(q, 40.0, steptime)
      else:
        stopj(4.0)
        sync()
      end
    end
  end
  if not socket_open("%s", %u, "reverse_socket"):
    popup("skinctl: the computer cannot be reached", error=True)
    halt
  end
  moving = run mover()
  timeout = 2.0
  alive = True
  while alive:
    got = socket_read_binary_integer(8, "reverse_socket", timeout)
    if got[0] == 8:
      timeout = got[1] / 1000.0
      enter_critical
      target = [got[2] / 1000000.0, got[3] / 1000000.0, got[4] / 1000000.0, got[5] / 1000000.0, got[6] / 1000000.0, got[7] / 1000000.0]
      mode = got[8]
      exit_critical
      alive = got[8] != -2
    else:
      alive = False
    end
  end
  kill moving
  stopj(4.0)
  socket_close("reverse_socket")
end
)",
                1 / rate, servoj_lookahead, address.c_str(), static_cast<unsigned>(port));
  return text;
}

std::array<std::uint8_t, 32> Driver::message(std::int32_t timeout_ms, const std::array<double, 6>& values,
                                             std::int32_t mode) noexcept {
  std::array<std::uint8_t, 32> bytes{};
  std::size_t at = 0;
  const auto put = [&](std::int32_t x) {
    const auto u = static_cast<std::uint32_t>(x);
    for (int shift = 24; shift >= 0; shift -= 8) bytes[at++] = static_cast<std::uint8_t>(u >> shift);
  };
  put(timeout_ms);
  for (const double v : values) {
    const double millionths = v * 1e6;  // |v| below 2147: a guard has seen it
    put(millionths >= -2147483647 && millionths <= 2147483647
            ? static_cast<std::int32_t>(std::lround(millionths))
            : 0);
  }
  put(mode);
  return bytes;
}

Heard Driver::fail(const std::string& what) noexcept {
  if (error_.empty()) error_ = what;
  return Heard::lost;
}

Heard Driver::wait(skinctl::State<6>& state) noexcept {
  if (!running_) return fail("the robot is not connected");
  const auto begin = Clock::now();
  const auto silent_at = begin + config_.silence, lost_at = begin + config_.give_up;
  for (;;) {
    Package p{};
    const bool waited_long = Clock::now() >= silent_at;
    if (!read_package(p, left_until(waited_long ? lost_at : silent_at))) {
      if (!error_.empty()) return fail(error_);
      if (waited_long)
        return fail("no state from the robot for " + std::to_string(config_.give_up.count()) + " ms");
      // One cycle on the last state, then the rest of the patience.
      if (silent_) continue;
      silent_ = true;
      return Heard::silent;
    }
    if (p.type == package::message) continue;
    if (p.type != package::data || p.payload.empty() || p.payload[0] != recipe_ ||
        !report_.decode(p.payload.subspan(1))) {
      ++nonsense_;
      continue;
    }
    silent_ = false;
    // The newest of what has come counts; time is the controller's, so that skipped packages lose nothing.
    while (const auto more = framer_.next()) {
      Report newer;
      if (more->type == package::data && !more->payload.empty() && more->payload[0] == recipe_ &&
          newer.decode(more->payload.subspan(1))) {
        report_ = newer;
      } else if (more->type != package::message) {
        ++nonsense_;
      }
    }
    if (report_.safety_mode >= 3)
      return fail("the robot went into " + describe_safety_mode(report_.safety_mode));
    if (report_.robot_mode != 7)
      return fail("the robot stopped running: " + describe_robot_mode(report_.robot_mode));
    state.time = clock();
    for (std::size_t i = 0; i < 6; ++i) {
      state.q[i] = report_.q[i];
      state.dq[i] = report_.dq[i];
    }
    return Heard::state;
  }
}

skinctl::Nanoseconds Driver::clock() const noexcept {
  // Whole microseconds: a double of seconds after a boot long ago is not much finer, and equal intervals stay
  // equal.
  return skinctl::nanoseconds(report_.timestamp * 1e-3) * 1000;
}

bool Driver::send(const skinctl::JointCommand<6>& command) noexcept {
  std::array<double, 6> values{};
  const bool position = config_.interface == Interface::position;
  for (std::size_t i = 0; i < 6; ++i) values[i] = position ? command.position[i] : command.velocity[i];
  const auto patience = static_cast<std::int32_t>(config_.robot_patience.count());
  if (reverse_.write(message(patience, values, position ? servoj : speedj), Timeout(20))) return true;
  fail("the program on the robot hung up");
  return false;
}

void Driver::stop() noexcept {
  if (!running_) return;
  running_ = false;
  static_cast<void>(reverse_.write(
      message(static_cast<std::int32_t>(config_.robot_patience.count()), {}, stopped), Timeout(20)));
  reverse_.close();
  script_.close();
  rtde_.close();
}

}  // namespace adapters::ur5
