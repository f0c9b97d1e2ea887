// Drivers of grippers against simulated ones, over real sockets, and what they do when these misbehave.
//
// Promise: a gripper's driver says what the fingers do, or that it does not know: silent, lost, stopped,
// faulty; an old goal's arrival is not taken for the new one's
// Tried: Robotiq, OnRobot, Lacquey and digital outputs against simulated ones: soft, hard and slipping
// objects, answers in single bytes, twice, none, garbage, hang-up, 20 000 random requests; libmodbus
// reads the simulated OnRobot. Also: `examples/simulated_gripper/tests/`

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "examples/adapters/gripper/digital.hpp"
#include "examples/adapters/gripper/lacquey.hpp"
#include "examples/adapters/gripper/onrobot.hpp"
#include "examples/adapters/gripper/robotiq.hpp"
#include "examples/simulated_gripper/server.hpp"
#include "skinctl/core/contract.hpp"
#if SKINCTL_HAS_MODBUS
#include <modbus/modbus.h>
#endif

using namespace std::chrono_literals;
using namespace adapters::gripper;
using simulated_gripper::Kind;
using simulated_gripper::Server;
using skinctl::GripperError;
using skinctl::GripperState;

static_assert(skinctl::GripperDriver<Robotiq> && skinctl::GripperDriver<OnRobot>);

namespace {

constexpr double fast = 10;  // times real time

/// Polls every 2 ms until `done(state)` or `most` is over; gives the last state.
template <class G, class Done>
GripperState poll(G& gripper, Done&& done, std::chrono::milliseconds most = 3000ms) {
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    const auto now = std::chrono::steady_clock::now();
    const GripperState state = gripper.poll(now.time_since_epoch());
    if (done(state) || now - start > most) return state;
    std::this_thread::sleep_for(2ms);
  }
}
template <class G>
GripperState settled(G& gripper) {
  return poll(gripper, [](const GripperState& s) { return s.heard && !s.moving; });
}
Robotiq robotiq_at(const Server& server) {
  RobotiqConfig config;
  config.port = server.port();
  config.patience = {50ms, 300ms, 100ms};
  return Robotiq(config);
}
OnRobot onrobot_at(const Server& server) {
  OnRobotConfig config;
  config.port = server.port();
  config.patience = {50ms, 300ms};
  config.begins_within = 20ms;
  return OnRobot(config);
}

/// Opens, closes on soft, hard and no object, is stopped: the same for every gripper that measures.
template <class G>
void work(G& gripper, Server& server, double resolution) {
  const auto range = gripper.range();
  CHECK(gripper.move(close_goal(range, 30)));
  GripperState s = settled(gripper);
  CHECK(s.error == GripperError::none);
  CHECK(s.measured);
  CHECK_FALSE(s.holding);
  CHECK(s.opening == doctest::Approx(0).epsilon(1e-9 + resolution));

  CHECK(gripper.move(open_goal(range)));
  s = settled(gripper);
  CHECK(std::abs(s.opening - range.opening) <= resolution);

  server.put({0.05, 3000});
  CHECK(gripper.move(close_goal(range, 30)));
  s = settled(gripper);
  CHECK(s.holding);
  CHECK(s.force == doctest::Approx(30));
  CHECK(std::abs(s.opening - 0.04) <= 2 * resolution);
  CHECK(server.seen().force == doctest::Approx(30).epsilon(0.03));

  server.put({});  // it slips: the fingers go on, and the driver says so
  s = poll(gripper, [](const GripperState& x) { return !x.holding && !x.moving; });
  CHECK(s.opening <= resolution);

  CHECK(gripper.move(open_goal(range)));
  CHECK(settled(gripper).opening > 0.9 * range.opening);
  server.put({0.03});
  CHECK(gripper.move(close_goal(range, 25)));
  s = settled(gripper);
  CHECK(s.holding);
  CHECK(std::abs(s.opening - 0.03) <= resolution);

  // The newest goal counts, and an old one's arrival is not taken for its own.
  server.put({});
  CHECK(gripper.move(open_goal(range)));
  settled(gripper);
  CHECK(gripper.move(close_goal(range, 25)));
  poll(gripper, [&](const GripperState& x) { return x.opening < 0.8 * range.opening; });
  CHECK(gripper.move({0.9 * range.opening, 25, range.max_speed}));
  s = settled(gripper);
  CHECK(std::abs(s.opening - 0.9 * range.opening) <= 2 * resolution);

  CHECK(gripper.move(close_goal(range, 25)));
  poll(gripper, [&](const GripperState& x) { return x.opening < 0.7 * range.opening; });
  gripper.stop();
  s = settled(gripper);
  const double where = s.opening;
  CHECK(where > 0.05 * range.opening);
  std::this_thread::sleep_for(30ms);
  CHECK(std::abs(settled(gripper).opening - where) <= resolution + 0.1 * range.opening);
  const double rest = settled(gripper).opening;
  std::this_thread::sleep_for(30ms);
  CHECK(settled(gripper).opening == rest);

  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(gripper.move({nan, 20, 0.1}));
  CHECK_FALSE(gripper.move({0.01, nan, 0.1}));
  CHECK(gripper.nonsense() == 0);
}

/// Silence, hanging up, garbage, single bytes, repeated answers.
template <class G>
void suffer(G& gripper, Server& server) {
  auto& wrong = server.misbehave();
  wrong.byte_by_byte = true;
  CHECK(gripper.move({0.02, 30, 0.1}));
  GripperState s = settled(gripper);
  CHECK(s.error == GripperError::none);
  CHECK(s.opening == doctest::Approx(0.02).epsilon(0.02));
  wrong.byte_by_byte = false;

  wrong.twice = true;  // an answer to the question before is none to this one
  CHECK(gripper.move({0.06, 30, 0.1}));
  s = settled(gripper);
  CHECK(s.opening == doctest::Approx(0.06).epsilon(0.02));
  CHECK(gripper.nonsense() > 0);
  wrong.twice = false;

  wrong.silent = true;
  s = poll(gripper, [](const GripperState& x) { return x.error != GripperError::none; });
  CHECK(s.error == GripperError::silent);
  CHECK(s.heard);  // what it said last is still there
  s = poll(gripper, [](const GripperState& x) { return x.error == GripperError::lost; });
  CHECK(s.error == GripperError::lost);
  CHECK_FALSE(gripper.move({0.02, 30, 0.1}));
  wrong.silent = false;
  gripper.connect();  // the way back is asked for
  CHECK(settled(gripper).error == GripperError::none);

  wrong.garbage = true;
  s = poll(gripper, [](const GripperState& x) { return x.error == GripperError::lost; });
  CHECK(s.error == GripperError::lost);
  CHECK(gripper.nonsense() > 0);
  wrong.garbage = false;
  gripper.connect();
  CHECK(settled(gripper).error == GripperError::none);

  wrong.hang_up = true;
  s = poll(gripper, [](const GripperState& x) { return x.error == GripperError::lost; }, 200ms);
  CHECK(s.error == GripperError::lost);
  CHECK_THROWS_AS(gripper.connect(), adapters::ConnectionError);
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("Robotiq: works") {
  Server server({.kind = Kind::robotiq, .speed = fast});
  Robotiq gripper = robotiq_at(server);
  CHECK(gripper.poll(0ns).error == GripperError::lost);
  CHECK_FALSE(gripper.move({}));
  gripper.connect();  // activates it
  work(gripper, server, gripper.range().opening / 255);
}

TEST_CASE(
    "Robotiq: public clients compare the answer to SET with exactly \"ack\"; the driver takes a line end "
    "too") {
  Server server({.kind = Kind::robotiq, .speed = fast, .active = true});
  adapters::Stream client;
  client.connect("127.0.0.1", server.port(), "the gripper", 1s);
  const std::string_view said = "SET GTO 1 SPE 255 FOR 150 POS 255\n";
  REQUIRE(client.write({reinterpret_cast<const std::uint8_t*>(said.data()), said.size()}, 1s));
  std::array<std::uint8_t, 64> heard{};
  std::size_t n = 0;
  REQUIRE(client.read_some(heard, n, 1s) == adapters::Read::some);
  CHECK(std::string_view(reinterpret_cast<const char*>(heard.data()), n) == "ack");

  for (const bool line_end : {false, true}) {
    CAPTURE(line_end);
    server.misbehave().line_end_after_ack = line_end;
    Robotiq gripper = robotiq_at(server);
    gripper.connect();
    work(gripper, server, gripper.range().opening / 255);
  }
}

TEST_CASE("Grippers: a web page moves none") {
  for (const Kind kind : {Kind::robotiq, Kind::onrobot}) {
    Server server({.kind = kind, .speed = fast, .active = true});
    const double before = server.seen().opening;
    for (const std::string_view request :
         {"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\nSET GTO 1 SPE 255 FOR 150 POS 255\n",
          "\x16\x03\x01\nSET GTO 1 SPE 255 FOR 150 POS 255\n"}) {
      adapters::Stream client;
      client.connect("127.0.0.1", server.port(), "the gripper", 1s);
      REQUIRE(client.write({reinterpret_cast<const std::uint8_t*>(request.data()), request.size()}, 1s));
      std::array<std::uint8_t, 64> heard{};
      std::size_t n = 0;
      CHECK(client.read_some(heard, n, 1s) == adapters::Read::closed);
    }
    std::this_thread::sleep_for(50ms);
    CHECK(server.seen().opening == before);
  }
}

TEST_CASE("Robotiq: half an answer does not spoil those after it") {
  Server server({.kind = Kind::robotiq, .speed = fast, .active = true});
  Robotiq gripper = robotiq_at(server);
  gripper.connect();
  server.misbehave().cut_short = true;  // "a" for "ack"
  CHECK(gripper.move({0.02, 30, 0.1}));
  poll(gripper, [&](const GripperState&) { return server.seen().opening < 0.03; });
  server.misbehave().cut_short = false;
  const GripperState s = settled(gripper);
  CHECK(s.error == GripperError::none);
  CHECK(s.opening == doctest::Approx(0.02).epsilon(0.02));
}

TEST_CASE("Robotiq: misbehaves") {
  Server server({.kind = Kind::robotiq, .speed = fast, .active = true});
  Robotiq gripper = robotiq_at(server);
  gripper.connect();
  server.fault(9);
  GripperState s = poll(gripper, [](const GripperState& x) { return x.error != GripperError::none; });
  CHECK(s.error == GripperError::fault);
  CHECK(s.code == 9);
  server.fault(0);
  poll(gripper, [](const GripperState& x) { return x.error == GripperError::none; });
  suffer(gripper, server);
}

TEST_CASE("Robotiq: what cannot be is refused") {
  RobotiqConfig config;
  config.port = 1;
  CHECK_THROWS_AS(Robotiq(config).connect(), adapters::ConnectionError);
  config.count_open = 255;
  CHECK_THROWS_AS(Robotiq{config}, skinctl::ConfigurationError);
  Server server({.kind = Kind::robotiq, .speed = fast});
  RobotiqConfig passive;
  passive.port = server.port();
  passive.activate = false;
  CHECK_THROWS_AS(Robotiq(passive).connect(), adapters::ConnectionError);
}

TEST_CASE("OnRobot: works") {
  Server server({.kind = Kind::onrobot, .speed = fast});
  OnRobot gripper = onrobot_at(server);
  CHECK(gripper.poll(0ns).error == GripperError::lost);
  gripper.connect();
  work(gripper, server, 1e-4);
}

TEST_CASE("OnRobot: misbehaves") {
  Server server({.kind = Kind::onrobot, .speed = fast});
  OnRobot gripper = onrobot_at(server);
  gripper.connect();
  server.fault(4);
  GripperState s = poll(gripper, [](const GripperState& x) { return x.error != GripperError::none; });
  CHECK(s.error == GripperError::stopped);
  CHECK(s.code == 4);
  server.fault(0);
  poll(gripper, [](const GripperState& x) { return x.error == GripperError::none; });
  suffer(gripper, server);
}

#if SKINCTL_HAS_MODBUS
TEST_CASE("OnRobot: an independent client believes the simulated one") {
  Server server({.kind = Kind::onrobot, .speed = fast, .object = {.width = 0.03}});
  modbus_t* client = modbus_new_tcp("127.0.0.1", server.port());
  REQUIRE(client);
  modbus_set_slave(client, 65);
  REQUIRE(modbus_connect(client) == 0);
  std::uint16_t read[2] = {};
  CHECK(modbus_read_registers(client, 267, 2, read) == 2);
  CHECK(read[0] == 1100);
  const std::uint16_t words[3] = {200, 0, 1};
  CHECK(modbus_write_registers(client, 0, 3, words) == 3);
  CHECK(modbus_read_registers(client, 268, 1, read) == 1);
  CHECK((read[0] & 1) == 1);
  for (int k = 0; k < 500 && (read[0] & 1); ++k) {
    std::this_thread::sleep_for(2ms);
    modbus_read_registers(client, 268, 1, read);
  }
  CHECK(read[0] == 2);
  CHECK(modbus_read_registers(client, 267, 1, read) == 1);
  CHECK(read[0] == 300);
  CHECK(modbus_read_registers(client, 300, 1, read) == -1);
  // One register a request (function 6), as the maker's example does; widths between fingertips.
  server.fingertips(50);
  CHECK(modbus_read_registers(client, 258, 1, read) == 1);
  CHECK(read[0] == 50);
  CHECK(modbus_write_register(client, 1, 600) == 1);
  CHECK(modbus_write_register(client, 2, 16) == 1);
  CHECK(modbus_write_register(client, 300, 1) == -1);
  CHECK(modbus_write_register(client, 1, 900) == 1);
  CHECK(modbus_write_register(client, 2, 16) == 1);  // ignored: it moves
  for (int k = 0; k < 500 && (k == 0 || (read[0] & 1)); ++k) {
    std::this_thread::sleep_for(2ms);
    modbus_read_registers(client, 268, 1, read);
  }
  CHECK(modbus_read_registers(client, 267, 1, read) == 1);
  CHECK(read[0] == 700);
  CHECK(modbus_read_registers(client, 275, 1, read) == 1);
  CHECK(read[0] == 600);
  modbus_close(client);
  modbus_free(client);
}
#else
TEST_CASE("OnRobot: an independent client" * doctest::skip()) {}
#endif

TEST_CASE("Lacquey: words go out, and time tells the opening") {
  LacqueyServer line("127.0.0.1", 0);
  CHECK_THROWS_AS(line.accept(adapters::Timeout(1)), adapters::ConnectionError);
  auto robot = std::make_unique<Server>(
      simulated_gripper::ServerConfig{.kind = Kind::lacquey, .port = line.port(), .speed = fast});
  line.accept(adapters::Timeout(1000));
  BinaryGripper gripper(line, {.travel = 100ms});
  static_assert(skinctl::GripperDriver<decltype(gripper)>);
  CHECK_FALSE(gripper.poll(0ns).heard);
  CHECK(gripper.move(close_goal(gripper.range(), 20)));
  GripperState s = settled(gripper);
  CHECK(s.opening == 0);
  CHECK_FALSE(s.measured);
  std::this_thread::sleep_for(20ms);
  CHECK(robot->seen().opening == doctest::Approx(0).epsilon(1e-9));

  // While it is deaf the word waits; of two the newer counts.
  CHECK(gripper.move(open_goal(gripper.range())));
  poll(gripper, [](const GripperState& x) { return x.opening > 0.02; });
  CHECK(gripper.move(close_goal(gripper.range(), 20)));
  CHECK(gripper.move(open_goal(gripper.range())));
  s = settled(gripper);
  CHECK(s.opening == doctest::Approx(0.08));
  std::this_thread::sleep_for(20ms);
  CHECK(robot->seen().opening == doctest::Approx(0.08));

  robot.reset();  // its program ends
  s = poll(gripper, [](const GripperState& x) { return x.error == GripperError::lost; });
  CHECK(s.error == GripperError::lost);
  CHECK_FALSE(gripper.move(open_goal(gripper.range())));
}

TEST_CASE("Lacquey by CAN, and digital outputs") {
  auto [here, there] = adapters::can::FrameSocket::pair();
  LacqueyCan can(here, LacqueySide::left);
  BinaryGripper by_can(can, {.travel = 10ms});
  by_can.move(close_goal(by_can.range(), 20));
  CHECK(by_can.poll(1s).moving);
  adapters::can::Frame frame;
  REQUIRE(there.read(frame, std::chrono::steady_clock::now() + 1s) == adapters::Read::some);
  CHECK(frame == lacquey_frame(LacqueySide::left, true));
  CHECK_FALSE(by_can.poll(2s).moving);
  there.close();
  by_can.move(open_goal(by_can.range()));
  by_can.poll(3s);
  CHECK(by_can.poll(4s).error == GripperError::lost);

  struct Outputs {
    bool write(int bit, bool on) noexcept {
      set = (set & ~(1ull << bit)) | (std::uint64_t{on} << bit);
      both = both || (set & 3) == 3;
      return true;
    }
    std::optional<std::uint64_t> bits() const noexcept {
      return echo ? std::optional(set & working) : std::nullopt;
    }
    std::uint64_t set = 0, working = ~0ull;
    bool echo = true, both = false;
  } outputs;
  DigitalLine valve(outputs, 0, 1);
  BinaryGripper gripper(valve, {.travel = 100ms});
  gripper.move(close_goal(gripper.range(), 0));
  CHECK(gripper.poll(0ns).error == GripperError::none);
  CHECK(outputs.set == 1);
  CHECK(gripper.poll(2s).error == GripperError::none);
  gripper.move(open_goal(gripper.range()));
  gripper.poll(3s);
  CHECK(outputs.set == 2);
  CHECK_FALSE(outputs.both);  // never both coils at once
  outputs.working = 0;        // the relay does not follow
  gripper.move(close_goal(gripper.range(), 0));
  CHECK(gripper.poll(4s).error == GripperError::none);
  CHECK(gripper.poll(4400ms).error == GripperError::none);
  CHECK(gripper.poll(4600ms).error == GripperError::fault);
  CHECK_THROWS_AS(BinaryGripper(valve, {.travel = 0ms}), skinctl::ConfigurationError);
}

TEST_SUITE_END();
