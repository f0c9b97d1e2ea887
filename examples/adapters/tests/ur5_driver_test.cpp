// The UR driver against the simulated robot: connecting, power, protective stops, inputs, reconnection,
// versions.
//
// Promise: the UR driver powers up by dashboard or REST, releases a protective stop on request only, and
// connects again after a restart only when told to
// Tried: against the simulated robot; torques are refused below 5.23 and 10.11

#include <doctest/doctest.h>

#include <cstring>
#include <thread>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/adapters/ur5/panel.hpp"
#include "examples/adapters/ur5/round_trip.hpp"
#include "examples/simulated_ur5/faults.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/core/contract.hpp"

using namespace adapters;
using namespace adapters::ur5;
using namespace std::chrono_literals;
using simulated_ur5::SimulatedUr5;
using skinctl::Heard;

namespace {

simulated_ur5::Config robot_config(bool powered, simulated_ur5::Series series = simulated_ur5::Series::cb3) {
  simulated_ur5::Config c;
  std::memset(static_cast<void*>(&c.ports), 0, sizeof c.ports);  // any that are free
  c.controller.series = series;
  c.controller.powered = powered;
  c.controller.power_on_time = c.controller.brake_release_time = 0.1;
  c.controller.unlock_time = 0.3;
  return c;
}
DriverConfig driver_config(const SimulatedUr5& robot) {
  DriverConfig c;
  c.rtde_port = robot.ports().rtde;
  c.script_port = robot.ports().secondary;
  c.dashboard_port = robot.ports().dashboard;
  c.connect_timeout = Timeout(2000);
  return c;
}
/// A powered robot behind a wire that can be spoiled, and how a driver reaches it.
struct WiredRobot {
  SimulatedUr5 robot{robot_config(true)};
  simulated_ur5::FaultyWire wire{(robot.start(), robot.ports().rtde), true};
  DriverConfig config = driver_config(robot);

  explicit WiredRobot(Timeout give_up) {
    config.rtde_port = wire.port();
    config.robot_patience = Timeout(2000);
    config.give_up = give_up;
  }
};
/// Holds the arm where it is for so many cycles; the last state.
Heard hold(Driver& driver, int cycles) {
  skinctl::State<6> state;
  skinctl::PositionCommand<6> command;
  Heard heard = Heard::state;
  for (int k = 0; k < cycles && heard != Heard::lost; ++k) {
    heard = driver.wait(state);
    command.position = driver.told();
    if (heard != Heard::lost && !driver.send(command)) return Heard::lost;
  }
  return heard;
}
/// A controller that reports another version, on the wire.
simulated_ur5::Change reports(const Version& v) {
  return [v](simulated_ur5::Bytes p, const simulated_ur5::RtdeLayout&) {
    if (p.size() == 19 && p[2] == 118) {
      const std::uint32_t numbers[4] = {v.major, v.minor, v.bugfix, v.build};
      for (std::size_t k = 0; k < 16; ++k)
        p[3 + k] = static_cast<std::uint8_t>(numbers[k / 4] >> (24 - 8 * (k % 4)));
    }
    return std::vector<simulated_ur5::Bytes>{p};
  };
}

/// Answers one HTTP request after the other, each on a connection of its own, with what `answer(request)`
/// gives.
class Web {
 public:
  explicit Web(std::function<std::string(const std::string&)> answer)
      : acceptor_(listen(io_, "127.0.0.1", 0)), thread_([this, answer = std::move(answer)] {
          while (!end_) {
            Stream stream;
            try {
              stream.accept(acceptor_, {}, "a client", Timeout(50));
            } catch (const ConnectionError&) {
              continue;
            }
            std::string request;
            std::array<std::uint8_t, 2048> block{};
            std::size_t n = 0;
            const auto whole = [&] {
              const auto end = request.find("\r\n\r\n");
              return end != std::string::npos &&
                     (request.rfind("GET", 0) == 0 || request.find('}', end) != std::string::npos);
            };
            while (!whole() && stream.read_some(block, n, Timeout(300)) == Read::some)
              request.append(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(n));
            const std::string out = answer(request);
            stream.write({reinterpret_cast<const std::uint8_t*>(out.data()), out.size()}, Timeout(300));
          }
        }) {}
  ~Web() {
    end_ = true;
    thread_.join();
  }
  std::uint16_t port() { return acceptor_.local_endpoint().port(); }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};
std::string http(const std::string& status, const std::string& body) {
  return "HTTP/1.1 " + status +
         "\r\nContent-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
         body;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("UR driver: powers up by the dashboard, sets slider, outputs and payload, and measures the way") {
  SimulatedUr5 robot(robot_config(false));
  robot.start();
  Driver driver(driver_config(robot));
  driver.connect();
  CHECK(driver.controller().major == 3);
  REQUIRE(hold(driver, 20) == Heard::state);
  CHECK(driver.set_digital_output(1, true));
  CHECK(driver.set_digital_output(9, true));
  CHECK(driver.set_digital_output(17, true));
  CHECK_FALSE(driver.set_digital_output(18, true));
  CHECK(driver.set_speed_slider(0.5));
  CHECK_FALSE(driver.set_speed_slider(1.5));
  CHECK(driver.set_payload(1.2, {0, 0, 0.05}));
  CHECK_THROWS_AS(driver.set_payload(-1, {0, 0, 0}), skinctl::ConfigurationError);
  REQUIRE(hold(driver, 15) == Heard::state);
  CHECK((driver.report().digital_outputs & 0x20202) == 0x20202);
  CHECK(driver.report().slider == doctest::Approx(0.5));
  CHECK(driver.set_digital_output(1, false));
  REQUIRE(hold(driver, 15) == Heard::state);
  CHECK((driver.report().digital_outputs & 0x20202) == 0x20200);

  const RoundTrip trip = measure_round_trip("127.0.0.1", robot.ports().rtde, 125, 10);
  CHECK(trip.echoes == 10);
  CHECK(trip.controller_median >= std::chrono::milliseconds(8));
  CHECK(trip.controller_median <= std::chrono::milliseconds(16));
  CHECK(trip.median <= std::chrono::milliseconds(40));
}

TEST_CASE("UR driver: takes commands of the interface that it was opened for, and no others") {
  SimulatedUr5 robot(robot_config(true));
  robot.start();
  Driver driver(driver_config(robot));
  driver.connect();
  REQUIRE(hold(driver, 5) == Heard::state);
  CHECK_FALSE(driver.send(skinctl::VelocityCommand<6>()));
  CHECK_FALSE(driver.send(skinctl::TorqueCommand<6>()));
  CHECK(hold(driver, 5) == Heard::state);  // nothing was sent: the arm goes on
  driver.stop();
}

TEST_CASE("UR driver: the program's echo tells the round trip; an older controller has no register for it") {
  SimulatedUr5 robot(robot_config(true));
  robot.start();
  simulated_ur5::FaultyWire wire(robot.ports().rtde, true);
  auto config = driver_config(robot);
  config.rtde_port = wire.port();
  for (const bool asked : {true, false}) {
    for (const Version& version : {Version{3, 15, 8, 0}, Version{3, 9}, Version{3, 8, 99, 0}}) {
      CAPTURE(version.text());
      wire.set(reports(version));
      wire.set_delay(0);
      config.echo = asked;
      Driver driver(config);
      driver.connect();
      REQUIRE(hold(driver, 20) == Heard::state);
      CHECK((driver.round_trip() >= 0) == (asked && version.has_upper_registers()));
      wire.set_delay(30);
      REQUIRE(hold(driver, 30) != Heard::lost);
      CHECK((driver.round_trip() >= 0.03) == (asked && version.has_upper_registers()));
    }
  }
}

TEST_CASE("UR driver: states that wait are waited for, and the clock goes on meanwhile") {
  WiredRobot wired(1000ms);
  Driver driver(wired.config);
  driver.connect();
  REQUIRE(hold(driver, 20) == Heard::state);
  const auto begun = driver.clock();
  auto before = begun;
  wired.wire.set(simulated_ur5::change::stalled(0.3));
  skinctl::State<6> state;
  Heard heard = Heard::state;
  int silent = 0;
  skinctl::Nanoseconds least_behind = 1s;
  for (int k = 0; k < 500 && (silent == 0 || heard == Heard::silent); ++k) {
    if (silent == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(6));  // a loop that is busy until then
    heard = driver.wait(state);
    if (heard == Heard::silent) least_behind = std::min(least_behind, driver.clock_now() - driver.clock());
    REQUIRE(heard != Heard::lost);
    silent += heard == Heard::silent;
    if (heard == Heard::silent) CHECK(driver.clock() - before == 8ms);
    if (silent == 1) CHECK(driver.clock_now() - before >= 40ms);  // what a sensor sends has gone on, too
    if (heard == Heard::state) CHECK(driver.clock_now() - driver.clock() < 4ms);  // but how late it came
    before = driver.clock();
    REQUIRE(driver.hold());
  }
  CHECK(silent >= 5);                     // of 40 ms, at once
  CHECK(least_behind < 3ms);              // however late the loop asked for the state that did not come
  CHECK(driver.clock() - begun > 250ms);  // all of them have come
  CHECK(state.time == driver.clock());
  wired.wire.set(simulated_ur5::change::lost(1));
  while (heard != Heard::lost) heard = driver.wait(state);
  CHECK(driver.fault() == Fault::silent);
}

TEST_CASE("UR driver: the clock does not go back when TCP brings states that waited piece by piece") {
  WiredRobot wired(450ms);
  // At once; longer than the silence that is allowed; in all longer than it is waited for without any state.
  for (const double rest_after : {0.001, 0.1, 0.3}) {
    CAPTURE(rest_after);
    wired.wire.set(simulated_ur5::Change());
    Driver driver(wired.config);
    driver.connect();
    REQUIRE(hold(driver, 20) == Heard::state);
    wired.wire.set(simulated_ur5::change::stalled(0.2, rest_after));
    auto before = driver.clock();
    skinctl::Nanoseconds back{};
    int silent = 0;
    for (int k = 0; k < 100; ++k) {
      skinctl::State<6> state;
      const Heard heard = driver.wait(state);
      REQUIRE(heard != Heard::lost);
      silent += heard == Heard::silent;
      back = std::max(back, before - driver.clock());
      before = driver.clock();
      REQUIRE(driver.hold());
    }
    CHECK(silent >= 15);  // of 200 ms
    CHECK(back < 20ms);   // and not the 150 of the first piece
    driver.stop();
  }
}

TEST_CASE("UR driver: a state that TCP keeps back does not turn the robot's clock back") {
  WiredRobot wired(450ms);
  Driver driver(wired.config);
  driver.connect();
  REQUIRE(hold(driver, 20) == Heard::state);
  // Of 20 states one is kept back for a period and a half, and with it the next one.
  skinctl::Nanoseconds first{}, last{}, oldest{};
  for (int k = 0; k < 200; ++k) {
    if (k % 20 == 5) wired.wire.set_delay(12);
    if (k % 20 == 6) wired.wire.set_delay(0);
    skinctl::State<6> state;
    REQUIRE(driver.wait(state) == Heard::state);
    const auto here = std::chrono::steady_clock::now().time_since_epoch();
    const auto ahead = driver.clock_now() - here;
    first = k == 0 ? ahead : std::min(first, ahead);
    last = k == 0 ? ahead : std::max(last, ahead);
    oldest = std::max(oldest, driver.clock_now() - driver.clock());
    REQUIRE(driver.hold());
  }
  CHECK(oldest > 3ms);        // such states there were
  CHECK(last - first < 3ms);  // and a sensor's clock did not seem to leap
  wired.wire.set_delay(12);   // a way that is longer for good is the way
  REQUIRE(hold(driver, 15) == Heard::state);
  CHECK(driver.clock_now() - driver.clock() < 3ms);
}

TEST_CASE("UR driver: a robot whose clock stood is believed after the silence that is allowed") {
  WiredRobot wired(1000ms);
  Driver driver(wired.config);
  driver.connect();
  REQUIRE(hold(driver, 20) == Heard::state);
  wired.wire.set(simulated_ur5::change::lost(1));
  skinctl::State<6> state;
  for (int k = 0; k < 25; ++k) REQUIRE(driver.wait(state) == Heard::silent);  // 200 ms
  wired.wire.set(simulated_ur5::change::clock_back(0.15));
  Heard heard = Heard::silent;
  int silent = 0;
  for (; heard == Heard::silent && silent < 30; ++silent) heard = driver.wait(state);
  CHECK(heard == Heard::state);
  CHECK(silent < 10);
}

TEST_CASE("UR driver: a protective stop is explained, and released on request only") {
  SimulatedUr5 robot(robot_config(true));
  robot.start();
  auto config = driver_config(robot);
  Driver driver(config);
  driver.connect();
  REQUIRE(hold(driver, 5) == Heard::state);
  robot.call([](auto& c) { c.protective_stop("a test"); });
  CHECK(hold(driver, 20) == Heard::lost);
  CHECK(driver.fault() == Fault::protective_stop);
  CHECK(driver.error().find("protective stop: ") == 0);
  driver.stop();
  CHECK_THROWS_WITH_AS(driver.connect(), doctest::Contains("protective stop: clear that first"),
                       ConnectionError);
  CHECK(robot.snapshot().state.safety_mode == simulated_ur5::SafetyMode::protective_stop);
  config.unlock = true;
  Driver consented(config);
  std::this_thread::sleep_for(std::chrono::milliseconds(350));
  consented.connect();
  CHECK(robot.snapshot().state.safety_mode == simulated_ur5::SafetyMode::normal);
  CHECK(hold(consented, 5) == Heard::state);
}

TEST_CASE("UR driver: words name the cause that it knows") {
  SimulatedUr5 robot(robot_config(true));
  robot.start();
  {
    Driver driver(driver_config(robot));
    driver.connect();
    REQUIRE(hold(driver, 5) == Heard::state);
    robot.call([](auto& c) { c.run("def other():\n  sleep(20)\nend\n"); });
    for (int k = 0; k < 60 && driver.fault() == Fault::none; ++k) static_cast<void>(hold(driver, 1));
    CHECK(driver.fault() == Fault::program_ended);
    CHECK_MESSAGE(driver.error().find("another program plays in its place") != std::string::npos,
                  driver.error());
  }
  auto config = driver_config(robot);
  config.told_port = 9;  // nobody listens there
  config.connect_timeout = Timeout(300);
  const auto why = [&] {
    try {
      Driver(config).connect();
    } catch (const ConnectionError& e) {
      return std::string(e.what());
    }
    return std::string();
  }();
  CHECK_MESSAGE(why.find("did not connect back within 300 ms to 127.0.0.1:9") != std::string::npos, why);
  for (const char* cause : {"the robot reaches this computer", "firewall", "refused the program"})
    CHECK(why.find(cause) != std::string::npos);
  adapters::ur5::RtdeClient client;
  client.connect("127.0.0.1", robot.ports().rtde, Timeout(1000));
  CHECK_THROWS_WITH_AS(
      static_cast<void>(client.outputs(125, "timestamp,no_such_output,actual_q", "DOUBLE,DOUBLE,DOUBLE")),
      doctest::Contains("does not offer the outputs no_such_output, actual_q (as VECTOR6D)"),
      ConnectionError);
}

TEST_CASE("UR driver: after a controller restart it connects again, and only then goes on") {
  auto robot = std::make_unique<SimulatedUr5>(robot_config(true));
  robot->start();
  const auto ports = robot->ports();
  Driver driver(driver_config(*robot));
  driver.connect();
  REQUIRE(hold(driver, 5) == Heard::state);
  robot->stop();
  CHECK(hold(driver, 20) == Heard::lost);
  CHECK(driver.fault() == Fault::stream_closed);
  skinctl::State<6> state;
  CHECK(driver.wait(state) == Heard::lost);
  auto again = robot_config(true);
  again.ports = ports;
  robot = std::make_unique<SimulatedUr5>(again);
  robot->start();
  CHECK(driver.wait(state) == Heard::lost);  // not by itself
  driver.connect();
  CHECK(driver.fault() == Fault::none);
  CHECK(driver.error().empty());
  CHECK(hold(driver, 10) == Heard::state);
}

TEST_CASE("UR driver: torques from the version on that takes them, with friction as that version wants it") {
  ProgramSettings s{
      .address = "10.0.0.7", .port = 50001, .rate = 500, .interface = skinctl::Interface::torque};
  s.version = {5, 23, 0, 0};
  CHECK(program(s).find("direct_torque(q, friction_comp=True)") != std::string::npos);
  s.torque.friction = false;
  CHECK(program(s).find("direct_torque(q, friction_comp=False)") != std::string::npos);
  s.torque.friction = true;
  for (const Version v : {Version{5, 25, 1, 0}, Version{10, 12, 1, 0}}) {
    s.version = v;
    CHECK(program(s).find("direct_torque(q, viscous_scale=[0.900, 0.900, 0.800, 0.900, 0.900, 0.900], "
                          "coulomb_scale=[0.800, 0.800, 0.700, 0.800, 0.800, 0.800])") != std::string::npos);
  }
  s.interface = skinctl::Interface::position;
  CHECK(program(s).find("direct_torque") == std::string::npos);
  CHECK_FALSE(Version{5, 22, 9, 9}.takes_torques());
  CHECK_FALSE(Version{10, 10, 0, 0}.takes_torques());
  CHECK(Version{10, 11, 0, 0}.takes_torques());
  CHECK_FALSE(Version{5, 25, 0, 0}.takes_friction_scales());
  CHECK_FALSE(Version{10, 12, 0, 0}.takes_friction_scales());

  SimulatedUr5 robot(robot_config(true, simulated_ur5::Series::e_series));
  robot.start();
  simulated_ur5::FaultyWire wire(robot.ports().rtde, true);
  auto config = driver_config(robot);
  config.rtde_port = wire.port();
  config.interface = skinctl::Interface::torque;
  config.rate = 500;
  wire.set(reports({5, 22, 1, 0}));
  Driver refused(config);
  CHECK_THROWS_WITH_AS(refused.connect(), doctest::Contains("5.22.1.0 takes no torques: 5.23 or later"),
                       ConnectionError);
  CHECK(refused.fault() == Fault::unreachable);
  config.torque.coulomb[2] = 1.1;
  CHECK_THROWS_AS(Driver{config}, skinctl::ConfigurationError);
}

TEST_CASE("UR driver: PolyScope X is powered by REST, and a refusal is told") {
  SimulatedUr5 robot(robot_config(false, simulated_ur5::Series::e_series));
  robot.start();
  simulated_ur5::FaultyWire wire(robot.ports().rtde, true);
  wire.set(reports({10, 12, 1, 0}));
  std::vector<std::string> asked;
  Web web([&](const std::string& request) {
    asked.push_back(request);
    if (request.find("POWER_ON") != std::string::npos) robot.call([](auto& c) { c.power_on(); });
    if (request.find("BRAKE_RELEASE") != std::string::npos) robot.call([](auto& c) { c.brake_release(); });
    if (request.find("robotmode") != std::string::npos) return http("200 OK", R"({"mode": "RUNNING"})");
    if (request.find("UNLOCK") != std::string::npos) return http("409 Conflict", "not in this state");
    if (request.find("safetymode") != std::string::npos)
      return std::string(
          "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n12\r\n{\"mode\": \"NORMAL\"}\r\n0\r\n\r\n");
    return http("200 OK", R"({"message": "done"})");
  });
  auto config = driver_config(robot);
  config.rtde_port = wire.port();
  config.dashboard_port = 1;  // there is none
  config.rest_port = web.port();
  config.rate = 500;
  Driver driver(config);
  driver.connect();
  CHECK(hold(driver, 20) == Heard::state);
  REQUIRE(asked.size() == 2);
  CHECK(asked[0].rfind("PUT /universal-robots/robot-api/robotstate/v1/state HTTP/1.0\r\n", 0) == 0);
  CHECK(asked[0].find(R"({"action": "POWER_ON"})") != std::string::npos);
  Rest rest("127.0.0.1", web.port(), Timeout(500));
  CHECK(rest.get("robotmode") == "RUNNING");
  CHECK_THROWS_WITH_AS(rest.act("UNLOCK_PROTECTIVE_STOP"), doctest::Contains("409 not in this state"),
                       ConnectionError);
  CHECK_THROWS_WITH_AS(rest.get("safetymode"), doctest::Contains("in chunks"), ConnectionError);
}

TEST_SUITE_END();

TEST_CASE("Driver: asks for what the motors give only if it is told to, and names outputs that are missing") {
  auto config = robot_config(true, simulated_ur5::Series::e_series);
  SimulatedUr5 robot(config);
  robot.start();
  auto c = driver_config(robot);
  c.real_time = false;
  for (const MotorOutput motors : {MotorOutput::none, MotorOutput::current, MotorOutput::torque}) {
    c.motors = motors;
    Driver driver(c);
    driver.connect();
    CHECK(hold(driver, 20) == Heard::state);
    CHECK(driver.motors_in_newton_metres() == (motors == MotorOutput::torque));
    const auto& m = driver.report().motors;
    CHECK((std::abs(m[1]) > 1) == (motors != MotorOutput::none));  // it holds the upper arm's weight
  }
  RtdeClient client;
  client.connect(c.host, c.rtde_port, Timeout(2000));
  const auto words = [&](const char* names, const char* types) -> std::string {
    try {
      static_cast<void>(client.outputs(125, names, types));
    } catch (const ConnectionError& e) {
      return e.what();
    }
    return {};
  };
  CHECK(words("timestamp,actual_q", "DOUBLE,VECTOR6D").empty());
  CHECK(words("timestamp,of_no_robot,actual_q,nor_this", "DOUBLE,DOUBLE,VECTOR6D,DOUBLE")
            .find("does not offer the outputs of_no_robot, nor_this") != std::string::npos);
}
