// Datagrams of RSI, EGM, FRI and stream motion: layouts, what is refused, and that no bytes do harm.
//
// Promise: messages of KUKA RSI, ABB EGM and FANUC stream motion are read whatever the bytes
// Tried: truncated, mutated and random datagrams; the XML against tinyxml2, EGM's and FRI's bytes as
// protobuf's page writes them

#include "examples/adapters/rsi/messages.hpp"

#include <doctest/doctest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "examples/adapters/egm/messages.hpp"
#include "examples/adapters/fri/messages.hpp"
#include "examples/adapters/stream_motion/packets.hpp"
#include "tests/support/by_day.hpp"

using skinctl::testing::rounds;
namespace rsi = adapters::rsi;
namespace stream = adapters::stream_motion;

namespace {

// As KUKA's example files write them.
const std::string rob_text =
    "<Rob Type=\"KUKA\"><RIst X=\"445.0\" Y=\"0\" Z=\"790\" A=\"180\" B=\"0\" C=\"180\"/>"
    "<AIPos A1=\"1.5\" A2=\"-90\" A3=\"90.25\" A4=\"0\" A5=\"90\" A6=\"-1e-3\"/>"
    "<EIPos E1=\"0\" E2=\"0\" E3=\"0\" E4=\"0\" E5=\"0\" E6=\"0\"/><Delay "
    "D=\"3\"/><IPOC>4208163634</IPOC></Rob>";

std::string printed(const rsi::Sen& sen) {
  std::string out(rsi::longest, ' ');
  out.resize(print(sen, "KROSHU", out));
  return out;
}
std::string printed(const rsi::Rob& rob) {
  std::string out(rsi::longest, ' ');
  out.resize(print(rob, out));
  return out;
}
/// A damaged copy: bits, bytes, pieces.
template <class Bytes>
Bytes damaged(Bytes bytes, std::mt19937& rng) {
  for (unsigned n = 1 + rng() % 4; n > 0 && !bytes.empty(); --n) {
    const std::size_t at = rng() % bytes.size();
    switch (rng() % 4) {
      case 0:
        bytes[at] = static_cast<typename Bytes::value_type>(static_cast<unsigned char>(bytes[at]) ^
                                                            (1u << rng() % 8));
        break;
      case 1:
        bytes[at] = static_cast<typename Bytes::value_type>(rng());
        break;
      case 2:
        bytes.resize(at);
        break;
      default:
        bytes.insert(bytes.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end());
    }
  }
  return bytes;
}

}  // namespace

TEST_CASE("RSI: the controller's datagram is read, whatever order and case its configuration has") {
  rsi::Rob rob;
  REQUIRE(parse(rob_text, rob));
  CHECK(rob.actual == std::array<double, 6>{1.5, -90, 90.25, 0, 90, -1e-3});
  CHECK((rob.ipoc == 4208163634u && rob.late == 3 && rob.axes == 6));
  CHECK_FALSE(rob.has_setpoint);
  REQUIRE(
      parse("<?xml version=\"1.0\"?>\r\n<Rob TYPE='KUKA'>\n <IPOC> 7 </IPOC>\n"
            "<aspos a1='1' A2='2' A3='3' A4='4' A5='5' A6='6'></aspos><Other/>"
            "<AIPos A6=\"6\" A5=\"5\" A4=\"4\" A3=\"3\" A2=\"2\" A1=\"1\" />\n</Rob>\n",
            rob));
  CHECK((rob.has_setpoint && rob.actual == rob.setpoint && rob.ipoc == 7 && !rob.has_late));
  REQUIRE(parse("<Rob><AIPos A1=\"0\" A2=\"0\" A3=\"0\" A4=\"0\"/><IPOC>1</IPOC></Rob>", rob));
  CHECK(rob.axes == 4);
}

TEST_CASE("RSI: what is no such XML is refused") {
  rsi::Rob rob;
  const auto with = [](const std::string& from, const std::string& to) {
    auto text = rob_text;
    return text.replace(text.find(from), from.size(), to);
  };
  for (const std::string& bad : {std::string(),
                                 std::string("<Rob"),
                                 std::string("</Rob>"),
                                 std::string("<Rob/>"),
                                 with("</Rob>", ""),
                                 with("<IPOC>4208163634</IPOC>", ""),
                                 with("4208163634", "-1"),
                                 with("4208163634", "99999999999999999999"),
                                 with("A1=\"1.5\"", "A1=\"nan\""),
                                 with("A1=\"1.5\"", "A1=\"inf\""),
                                 with("A1=\"1.5\"", "A1=\"1e99\""),
                                 with("A1=\"1.5\"", "A1=\"1,5\""),
                                 with("A1=\"1.5\"", "A1=1.5"),
                                 with("A1=\"1.5\"", "A1=\"1.5"),
                                 with("</Rob>", "</Sen>"),
                                 with("<Rob ", "<Sen "),
                                 with("</Rob>", "</Rob><Rob/>"),
                                 with("<Delay D=\"3\"/>", "<a><b><c><d></d></c></b></a>"),
                                 with("D=\"3\"", "D=\"-3\""),
                                 with("KUKA", std::string(3000, 'K'))}) {
    CAPTURE(bad);
    CHECK_FALSE(parse(bad, rob));
  }
}

TEST_CASE("RSI: what is written is read again, and by another reader") {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> degrees(-360, 360);
  for (int k = 0; k < 200; ++k) {
    rsi::Sen sen{.ipoc = rng(), .stop = k % 2 == 0};
    for (double& x : sen.correction) x = degrees(rng);
    rsi::Sen read;
    const std::string text = printed(sen);
    REQUIRE(parse(text, read));
    CHECK((read.ipoc == sen.ipoc && read.stop == sen.stop));
    tinyxml2::XMLDocument other;
    REQUIRE(other.Parse(text.c_str(), text.size()) == tinyxml2::XML_SUCCESS);
    const auto* ak = other.FirstChildElement("Sen")->FirstChildElement("AK");
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(std::abs(read.correction[i] - sen.correction[i]) < 1e-6);
      CHECK(ak->DoubleAttribute(("A" + std::to_string(i + 1)).c_str()) == read.correction[i]);
    }
    CHECK(text.size() < 1024);
  }
  rsi::Rob rob{.ipoc = 8, .late = 2};
  rob.has_setpoint = rob.has_wrench = true;
  rob.wrench = {1, -2, 3, 0.1, 0.2, -0.3};
  rob.setpoint[5] = -170;
  rsi::Rob read;
  REQUIRE(parse(printed(rob), read));
  CHECK((read.wrench == rob.wrench && read.setpoint == rob.setpoint && read.late == 2));
  char small[40];
  CHECK(print(rob, small) == 0);
}

TEST_CASE("RSI: of damaged datagrams nothing is read that the other reader refuses as XML") {
  std::mt19937 rng(5);
  rsi::Rob rob;
  rsi::Sen sen;
  int read = 0;
  for (int k = 0; k < rounds(20'000); ++k) {
    const std::string bytes = damaged(k % 2 == 0 ? rob_text : printed(rsi::Sen{.ipoc = 4}), rng);
    // In a buffer of its own, so that a reader that runs over its end is seen.
    const std::vector<char> exact(bytes.begin(), bytes.end());
    const std::string_view view(exact.data(), exact.size());
    if (!parse(view, rob) && !parse(view, sen)) continue;
    ++read;
    if (bytes.find('\0') != bytes.npos) continue;  // an end to one, a blank to the other
    for (const double x : rob.actual) CHECK(std::isfinite(x));
    tinyxml2::XMLDocument other;
    CAPTURE(bytes);
    const auto error = other.Parse(bytes.data(), bytes.size());
    // Names in another case close each other here, and do not there.
    CHECK((error == tinyxml2::XML_SUCCESS || error == tinyxml2::XML_ERROR_MISMATCHED_ELEMENT));
  }
  CHECK(read > rounds(100));
}

TEST_CASE("Stream motion: sizes and places of the maker's packets") {
  std::array<std::uint8_t, stream::max_bytes> b{};
  CHECK(print(stream::Header{stream::type::start, 3}, b) == 8);
  CHECK(std::memcmp(b.data(), "\0\0\0\xc8\0\0\0\3", 8) == 0);
  CHECK(print(stream::Capability{}, b) == 28);
  CHECK(print(stream::LimitsQuestion{}, b) == 16);
  CHECK(print(stream::Limits{}, b) == 184);
  stream::Status status{.sequence = 0x01020304};
  CHECK(print(status, b) == 388);
  CHECK((b[8] == 1 && b[11] == 4));
  status.header.type = stream::type::status_4;
  CHECK(print(status, b) == 416);
  stream::Command c{.sequence = 5, .last = 1};
  c.joints = {-90};
  REQUIRE(print(c, b) == 344);
  CHECK((b[12] == 1 && b[13] == 1 && b[14] == 0xff && b[15] == 0xff));  // last, moves, joints
  CHECK((b[16] == 0xc0 && b[17] == 0x56 && b[18] == 0x80));             // -90, big-endian
  CHECK(print(c, std::span(b).first(100)) == 0);
}

TEST_CASE("Stream motion: packets of another length or type are refused, whatever their bytes") {
  std::mt19937 rng(11);
  std::array<std::uint8_t, stream::max_bytes> b{};
  stream::Status status{.sequence = 9};
  status.joints = {1, 2, 3, 4, 5, 6};
  status.force = {1, 2, 3};
  status.header.type = stream::type::status_4;
  const auto size = print(status, b);
  stream::Status read;
  REQUIRE(parse(std::span<const std::uint8_t>(b).first(size), read));
  CHECK((read.joints == status.joints && read.force == status.force && read.sequence == 9));
  CHECK_FALSE(parse(std::span<const std::uint8_t>(b).first(size - 1), read));
  CHECK_FALSE(parse(std::span<const std::uint8_t>(b).first(size + 1), read));
  CHECK_FALSE(parse(std::span<const std::uint8_t>(b).first(388), read));
  stream::Command command;
  CHECK_FALSE(parse(std::span<const std::uint8_t>(b).first(344), command));
  const std::vector<std::uint8_t> good(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(size));
  int taken = 0;
  for (int k = 0; k < rounds(20'000); ++k) {
    const auto bytes = damaged(good, rng);
    taken += parse(std::span<const std::uint8_t>(bytes), read);
    stream::Limits limits;
    stream::Capability capability;
    stream::Header header;
    static_cast<void>(parse(std::span<const std::uint8_t>(bytes), limits));
    static_cast<void>(parse(std::span<const std::uint8_t>(bytes), capability));
    static_cast<void>(parse(std::span<const std::uint8_t>(bytes), header));
  }
  CHECK(taken > rounds(100));
}

namespace egm = adapters::egm;

TEST_CASE("EGM: a controller's message byte by byte, and what the job answers") {
  // Header {7, 28, data}, feedback {joints {0, -10, 20, 0, 30, 0}}.
  std::vector<std::uint8_t> bytes{0x0a, 6, 8, 7, 0x10, 0x1c, 0x18, 2, 0x12, 0x38, 0x0a, 0x36};
  for (const double q : {0.0, -10.0, 20.0, 0.0, 30.0, 0.0}) {
    bytes.push_back(9);
    std::array<std::uint8_t, 8> b;
    std::memcpy(b.data(), &q, 8);
    bytes.insert(bytes.end(), b.begin(), b.end());
  }
  egm::RobotMessage m;
  REQUIRE(parse(bytes, m));
  CHECK((m.number == 7 && m.time == 28 && m.joints == 6 && !m.has_force && !m.has_planned));
  CHECK(m.feedback == std::array<double, 6>{0, -10, 20, 0, 30, 0});
  std::array<std::uint8_t, egm::longest> out{};
  REQUIRE(print(m, out) == bytes.size());
  CHECK(std::equal(bytes.begin(), bytes.end(), out.begin()));

  const egm::SensorMessage answer{.number = 300, .time = 1200, .joints = 6, .planned = {1, 2, 3, 4, 5, 6}};
  const auto size = print(answer, out);
  REQUIRE(size == 12 + 2 + 54);  // numbers of two bytes each
  egm::SensorMessage back;
  REQUIRE(parse({out.data(), size}, back));
  CHECK((back.number == 300 && back.time == 1200 && back.planned == answer.planned));
  CHECK(print(answer, {out.data(), size - 1}) == 0);
}

TEST_CASE("EGM: states, forces, packed numbers and unknown fields are read; seven joints are counted") {
  egm::RobotMessage m{
      .number = 1, .joints = 6, .feedback = {1, 2, 3, 4, 5, 6}, .planned = {6, 5, 4, 3, 2, 1}};
  m.has_planned = m.has_force = true;
  m.motors = egm::Motors::on, m.guided = egm::Guided::running, m.rapid = egm::Rapid::running;
  m.force = {10, 0, -5, 0.1, 0.2, 0.3};
  std::array<std::uint8_t, egm::longest> out{};
  const auto size = print(m, out);
  std::vector<std::uint8_t> bytes(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size));
  bytes.insert(bytes.end(), {0xa5, 6, 1, 2, 3, 4, 0xa0, 6, 0x80, 1});  // fields 100: four bytes, a number
  egm::RobotMessage back;
  REQUIRE(parse(bytes, back));
  CHECK((back.guided == egm::Guided::running && back.motors == egm::Motors::on && back.has_force));
  CHECK(back.force == m.force);
  CHECK(back.planned == m.planned);
  std::vector<std::uint8_t> packed{0x0a, 2, 8, 5, 0x12, 60, 0x0a, 58, 0x0a, 56};  // seven, packed
  packed.resize(packed.size() + 56);
  REQUIRE(parse(packed, back));
  CHECK(back.joints == 7);
  const double nan = std::nan("");
  std::memcpy(packed.data() + 10, &nan, 8);
  CHECK_FALSE(parse(packed, back));
}

TEST_CASE("EGM: cut, damaged and random bytes do no harm, and what is read is finite") {
  egm::RobotMessage m{.number = 1, .joints = 6};
  m.has_planned = m.has_force = true, m.guided = egm::Guided::running;
  std::array<std::uint8_t, egm::longest> out{};
  const auto size = print(m, out);
  const std::vector<std::uint8_t> good(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size));
  std::mt19937 rng(5);
  std::size_t read = 0;
  for (int k = 0; k < rounds(200'000); ++k) {
    const auto bytes = damaged(good, rng);
    egm::RobotMessage robot;
    egm::SensorMessage sensor;
    if (parse(bytes, robot)) {
      ++read;
      for (const double q : robot.feedback) REQUIRE(std::isfinite(q));
      for (const double f : robot.force) REQUIRE(std::isfinite(f));
    }
    if (parse(bytes, sensor))
      for (const double q : sensor.planned) REQUIRE(std::isfinite(q));
  }
  CHECK(read > rounds(1000u));
  for (std::size_t n = 0; n < size; ++n) {
    egm::RobotMessage robot;
    static_cast<void>(parse({good.data(), n}, robot));
  }
}

namespace fri = adapters::fri;

namespace {

fri::Monitoring full_monitoring() {
  fri::Monitoring m;
  m.header.number = 70'000, m.header.reflected = 300;
  m.axes = fri::joints;
  m.control = fri::Control::joint_impedance;
  for (std::size_t i = 0; i < fri::joints; ++i) m.measured[i] = 0.1 * static_cast<double>(i) - 0.3;
  m.measured_torque = {1, 2, 3, 4, 5, 6, 7};
  m.commanded = {7, 6, 5, 4, 3, 2, 1};
  m.external_torque = {-1, 0, 1, 0, -1, 0, 1};
  m.session = fri::Session::commanding, m.quality = fri::Quality::excellent;
  m.period = 5, m.multiplier = 2;
  m.interpolated = {0.5, 0.25, 0, 0, 0, 0, -0.5};
  m.overlay = fri::Overlay::torque;
  return m;
}
std::vector<std::uint8_t> bytes_of(const auto& message) {
  std::vector<std::uint8_t> out(fri::longest);
  out.resize(print(message, out));
  return out;
}

}  // namespace

TEST_CASE("FRI: a command byte by byte, and its sizes") {
  fri::Command c{.axes = fri::joints, .position = {1, 2, 3, 4, 5, 6, 7}, .torque = {}};
  c.header.number = 1, c.header.reflected = 5;
  auto bytes = bytes_of(c);
  const std::vector<std::uint8_t> header{0x0a, 8, 8, 0x81, 0x80, 0x0d, 0x10, 1, 0x18, 5};
  REQUIRE(bytes.size() == 77);  // seven joints beside the header
  CHECK(std::equal(header.begin(), header.end(), bytes.begin()));
  const std::vector<std::uint8_t> one{0x12, 65, 0x0a, 63, 9, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f};
  CHECK(std::equal(one.begin(), one.end(), bytes.begin() + 10));
  CHECK(print(c, {bytes.data(), bytes.size() - 1}) == 0);
  c.torque = {0, 0, 0, 0, 0, 0, -1};
  bytes = bytes_of(c);
  REQUIRE(bytes.size() == 77 + 65 + 1);  // 130 bytes have a length of two
  CHECK((bytes[10] == 0x12 && bytes[11] == 0x82 && bytes[12] == 1));
  fri::Command back;
  REQUIRE(parse(bytes, back));
  CHECK((back.header.number == 1 && back.header.reflected == 5 && back.axes == 7));
  CHECK((back.position == c.position && back.torque == c.torque));
  c.axes = 0;
  CHECK(bytes_of(c) == header);
}

TEST_CASE("FRI: a message of the controller comes back as it was, and others are told apart") {
  const fri::Monitoring m = full_monitoring();
  auto bytes = bytes_of(m);
  fri::Monitoring back;
  REQUIRE(parse(bytes, back));
  CHECK((back.header.number == 70'000 && back.header.reflected == 300 && back.axes == 7 && back.safety == 0));
  CHECK((back.control == m.control && back.session == m.session && back.quality == m.quality));
  CHECK((back.overlay == m.overlay && back.period == 5 && back.multiplier == 2));
  CHECK((back.measured == m.measured && back.measured_torque == m.measured_torque));
  CHECK((back.commanded == m.commanded && back.external_torque == m.external_torque));
  CHECK(back.interpolated == m.interpolated);
  // Fields that nobody knows, at the end and as bytes of four.
  bytes.insert(bytes.end(), {0x7a, 2, 8, 1, 0xa5, 6, 1, 2, 3, 4});
  CHECK(parse(bytes, back));
  fri::Command command;
  CHECK_FALSE(parse(bytes, command));  // another identifier
  auto other = m;
  other.header.id = fri::command_id;
  CHECK_FALSE(parse(bytes_of(other), back));
  other = m, other.measured[3] = std::nan("");
  CHECK_FALSE(parse(bytes_of(other), back));
  other = m, other.axes = 6;
  REQUIRE(parse(bytes_of(other), back));
  CHECK(back.axes == 6);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    fri::Monitoring cut;
    static_cast<void>(parse({bytes.data(), n}, cut));
  }
  for (std::size_t room = 0; room + 11 < bytes.size(); ++room) {
    std::vector<std::uint8_t> out(room);
    CHECK(print(m, out) == 0);
  }
}

TEST_CASE("FRI: damaged messages do no harm, and what is read is finite") {
  const auto good = bytes_of(full_monitoring());
  fri::Command c{.axes = fri::joints, .position = {1, 2, 3, 4, 5, 6, 7}, .torque = fri::SevenJoints{}};
  const auto answer = bytes_of(c);
  std::mt19937 rng(17);
  const auto all_finite = [](const fri::SevenJoints& x) {
    return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  };
  std::size_t read = 0;
  for (int k = 0; k < rounds(200'000); ++k) {
    const auto bytes = damaged(k % 2 == 0 ? good : answer, rng);
    fri::Monitoring m;
    if (parse(bytes, m)) {
      ++read;
      REQUIRE(all_finite(m.measured));
      REQUIRE(all_finite(m.external_torque.value_or(fri::SevenJoints{})));
      REQUIRE(all_finite(m.commanded.value_or(fri::SevenJoints{})));
      REQUIRE(all_finite(m.interpolated.value_or(fri::SevenJoints{})));
      REQUIRE((m.session <= fri::Session::commanding && m.quality <= fri::Quality::excellent));
      REQUIRE(m.multiplier >= 1);
    }
    fri::Command command;
    if (parse(bytes, command)) {
      ++read;
      REQUIRE(all_finite(command.position));
      REQUIRE(all_finite(command.torque.value_or(fri::SevenJoints{})));
    }
  }
  CHECK(read > rounds(1000u));
}
