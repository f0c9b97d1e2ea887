// The bytes of simulated grippers, and of the drivers that talk to them.
#include "examples/simulated_gripper/device.hpp"

#include <doctest/doctest.h>

#include <random>
#include <string>

#include "examples/adapters/gripper/lacquey.hpp"
#include "examples/adapters/gripper/lines.hpp"
#include "examples/adapters/gripper/onrobot.hpp"
#include "examples/adapters/gripper/robotiq.hpp"

using namespace simulated_gripper;
using namespace adapters::gripper;

TEST_CASE("fingers: soft, hard and no objects") {
  const auto settle = [](Fingers& f) {
    for (int k = 0; k < 5000; ++k) f.step(0.001);
  };
  Fingers f(0.1);
  f.go(0.02, 30, 0.1);
  settle(f);
  CHECK(f.opening() == doctest::Approx(0.02));
  CHECK_FALSE(f.holding());
  CHECK(f.force() == 0);

  f.go(0.1, 30, 0.1), settle(f);
  f.put({0.06, 3000});
  f.go(0, 30, 0.1), settle(f);
  CHECK(f.opening() == doctest::Approx(0.05));  // 30 N press 3 kN/m in by 10 mm
  CHECK(f.holding());
  CHECK(f.force() == doctest::Approx(30));
  f.go(0.055, 30, 0.1), settle(f);  // opened a little: still touching
  CHECK(f.force() == doctest::Approx(15));
  CHECK_FALSE(f.holding());

  f.go(0.1, 30, 0.1), settle(f);
  f.put({0.04});
  f.go(0, 12, 0.1), settle(f);
  CHECK(f.opening() == doctest::Approx(0.04));
  CHECK(f.force() == doctest::Approx(12));
  f.put({});  // it slips out
  settle(f);
  CHECK(f.opening() == doctest::Approx(0).epsilon(1e-9));
  CHECK_FALSE(f.holding());
}

TEST_CASE("Robotiq: activation, motion and answers") {
  RobotiqDevice device;
  CHECK(device.answer("GET STA", 0) == "STA 0\n");
  CHECK(device.answer("SET GTO 1 POS 255", 0) == "ack");  // before its activation it does not move
  CHECK(device.answer("GET POS", 1) == "POS 0\n");
  CHECK(device.answer("SET ACT 0", 1) == "ack");
  CHECK(device.answer("SET ACT 1\r", 1) == "ack");
  CHECK(device.answer("GET STA", 1.1) == "STA 1\n");
  CHECK(device.answer("GET STA", 1.6) == "STA 3\n");
  device.fingers().put({0.0425});
  CHECK(device.answer("SET GTO 1 SPE 255 FOR 0 POS 255", 2) == "ack");
  CHECK(device.answer("GET OBJ", 2.01) == "OBJ 0\n");
  CHECK(device.answer("GET PRE", 2.01) == "PRE 255\n");
  CHECK(device.answer("GET OBJ", 3) == "OBJ 2\n");
  CHECK(device.answer("GET POS", 3) == "POS 128\n");
  CHECK(device.fingers().force() == doctest::Approx(20));
  CHECK(device.answer("SET GTO 1 SPE 255 FOR 0 POS 0", 3) == "ack");
  CHECK(device.answer("GET OBJ", 5) == "OBJ 3\n");
  for (const char* wrong : {"", "GET", "GET XYZ", "SET", "SET POS", "SET POS 256", "SET POS -1",
                            "SET POS 1e3", "SET STA 3", "SET POS 1 SPE", "POS 3", "get POS"})
    CHECK_MESSAGE(device.answer(wrong, 5) == "?\n", wrong);
}

TEST_CASE("Robotiq: answers are read, and nothing else") {
  const auto pos = parse_robotiq("POS 3");
  REQUIRE(pos);
  CHECK(pos->variable == "POS");
  CHECK(pos->value == 3);
  CHECK(parse_robotiq("ack\r")->acknowledged);
  for (const char* wrong :
       {"", "POS", "POS ", "POS x", "POS 256", "POS -1", "POS 3 4", "POSI 3", "ack 1", "?", "nack"})
    CHECK_FALSE_MESSAGE(parse_robotiq(wrong), wrong);
}

TEST_CASE("lines: a word that ends itself, with and without a line end, in any pieces") {
  const std::string said = "POS 3\nackackPRE 9\nack\nOBJ 2\nack\r\nack";
  for (std::size_t piece = 1; piece <= said.size(); ++piece) {
    Lines lines("ack");
    std::string heard;
    for (std::size_t at = 0; at < said.size(); at += piece) {
      const std::string part = said.substr(at, piece);
      std::copy(part.begin(), part.end(), lines.room().begin());
      lines.wrote(part.size());
      for (std::string_view line; lines.next(line);) heard.append(line).append("|");
    }
    CAPTURE(piece);
    CHECK(heard == "POS 3|ack|ack|PRE 9|ack|OBJ 2|ack|ack|");
  }
}

TEST_CASE("lines: pieces, long ones, many") {
  Lines lines;
  std::string_view line;
  const auto put = [&](const std::string& s) {
    auto room = lines.room();
    REQUIRE(room.size() >= s.size());
    std::copy(s.begin(), s.end(), room.begin());
    lines.wrote(s.size());
  };
  put("one");
  CHECK_FALSE(lines.next(line));
  put("\ntwo\n\nth");
  REQUIRE(lines.next(line));
  CHECK(line == "one");
  REQUIRE(lines.next(line));
  CHECK(line == "two");
  CHECK_FALSE(lines.next(line));   // an empty line says nothing
  for (int k = 0; k < 100; ++k) {  // never without room, whatever comes
    const std::size_t n = lines.room().size();
    REQUIRE(n > 0);
    put(std::string(n, 'x'));
    CHECK_FALSE(lines.next(line));
  }
  CHECK(lines.overlong() == 100);
}

TEST_CASE("Modbus: frames byte for byte") {
  const std::uint16_t words[] = {400, 1100, 1};
  const auto request = modbus::write_request(7, 65, 0, words);
  const std::vector<std::uint8_t> expected{0, 7, 0, 0, 0, 13, 65, 16, 0, 0, 0, 3, 6, 1, 0x90, 4, 0x4c, 0, 1};
  CHECK(std::vector<std::uint8_t>(request.span().begin(), request.span().end()) == expected);
  const auto read = modbus::read_request(0x102, 65, 267, 2);
  const std::vector<std::uint8_t> bytes{1, 2, 0, 0, 0, 6, 65, 3, 1, 11, 0, 2};
  CHECK(std::vector<std::uint8_t>(read.span().begin(), read.span().end()) == bytes);

  modbus::Frame frame;
  std::size_t size = 0;
  for (std::size_t n = 0; n < bytes.size(); ++n)
    CHECK(modbus::find_frame({bytes.data(), n}, frame, size) == modbus::Found::more);
  CHECK(modbus::find_frame(bytes, frame, size) == modbus::Found::frame);
  CHECK(size == bytes.size());
  CHECK(frame.transaction == 0x102);
  for (const std::vector<std::uint8_t>& wrong :
       {std::vector<std::uint8_t>{1, 2, 0, 1, 0, 6, 65}, {1, 2, 0, 0, 0, 1, 65}, {1, 2, 0, 0, 1, 0, 65}})
    CHECK(modbus::find_frame(wrong, frame, size) == modbus::Found::nonsense);

  OnRobotDevice device;
  const auto reply = device.answer(frame, 0);
  REQUIRE(modbus::find_frame(reply.span(), frame, size) == modbus::Found::frame);
  std::array<std::uint16_t, 2> registers{};
  REQUIRE(modbus::registers_of(frame, registers));
  CHECK(registers[0] == 1100);
  CHECK(registers[1] == 0);
  CHECK_FALSE(modbus::registers_of(frame, std::span(registers).first(1)));
}

TEST_CASE("Lacquey: words and frames") {
  CHECK(lacquey_words(true) == std::array<std::uint8_t, 8>{0, 0, 0, 20, 0, 0, 0, 23});
  CHECK(lacquey_words(false) == std::array<std::uint8_t, 8>{0, 0, 0, 20, 0, 0, 0, 22});
  const adapters::can::Frame close = lacquey_frame(LacqueySide::right, true);
  CHECK(close.id == 65);
  CHECK(close.size == 4);
  CHECK(close.data[3] == 0x42);  // 100.0f = 0x42c80000
  CHECK(close.data[2] == 0xc8);
  CHECK(lacquey_frame(LacqueySide::left, false).data[3] == 0xc2);

  LacqueyDevice device;
  device.hear(23, 0);  // not yet active
  device.hear(0, 2);
  CHECK(device.fingers().opening() == doctest::Approx(0.08));
  device.hear(20, 2), device.hear(23, 2);
  device.hear(22, 2.5);  // deaf
  device.hear(0, 3.1);
  CHECK(device.fingers().opening() == doctest::Approx(0).epsilon(1e-9));
}

TEST_CASE("grippers: random bytes harm nobody") {
  std::mt19937 rng(5);
  const char letters[] = "GETSPOACKRFL 0123456789\r-?";
  RobotiqDevice robotiq(true);
  OnRobotDevice onrobot;
  double now = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string line;
    for (std::size_t n = rng() % 40; n > 0; --n)
      line += rng() % 8 == 0 ? static_cast<char>(rng()) : letters[rng() % (sizeof letters - 1)];
    if (rng() % 2) line = "SET " + line;
    const std::string said = robotiq.answer(line, now += 0.001);
    CHECK_MESSAGE((said == "?\n" || said == "ack" || parse_robotiq(said.substr(0, said.size() - 1))), line);
    static_cast<void>(parse_robotiq(line));

    std::vector<std::uint8_t> bytes(rng() % 40);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(rng());
    if (bytes.size() > 12)
      bytes[2] = bytes[3] = bytes[4] = 0, bytes[5] = static_cast<std::uint8_t>(bytes.size() - 6);
    if (bytes.size() > 12 && rng() % 2) bytes[6] = 65, bytes[7] = rng() % 2 ? 3 : 16, bytes[8] = 0;
    modbus::Frame frame;
    std::size_t size = 0;
    if (modbus::find_frame(bytes, frame, size) == modbus::Found::frame) {
      CHECK(size <= bytes.size());
      CHECK(onrobot.answer(frame, now).span().size() >= 9);
    }
    const double opening = onrobot.fingers().opening();
    CHECK((opening >= 0 && opening <= OnRobotDevice::opening));
  }
}
