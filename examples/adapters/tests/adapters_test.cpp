// The adapters' parsers, byte by byte.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/socket.hpp"
#include "examples/adapters/ur5/driver.hpp"
#include "tests/support/comma_locale.hpp"
#include "tests/support/robot_table.hpp"

using namespace adapters;

namespace {

using namespace std::chrono_literals;

/// Hands bytes to a framer in pieces and gives the packages.
std::vector<std::pair<int, std::vector<std::uint8_t>>> cut(ur5::Framer& framer,
                                                           const std::vector<std::uint8_t>& bytes,
                                                           std::size_t piece) {
  std::vector<std::pair<int, std::vector<std::uint8_t>>> out;
  for (std::size_t at = 0; at < bytes.size() && !framer.broken();) {
    const auto room = framer.room();
    const std::size_t n = std::min({piece, bytes.size() - at, room.size()});
    std::memcpy(room.data(), bytes.data() + at, n);
    framer.received(n);
    at += n;
    while (const auto p = framer.next()) out.push_back({p->type, {p->payload.begin(), p->payload.end()}});
  }
  return out;
}

/// A datagram of version 1.
const std::vector<std::uint8_t> example = {
    0x53, 0x4b, 0x49, 0x4e, 0x01, 0x00, 0x01, 0x00, 0x2a, 0x00, 0x00, 0x00, 0x00, 0xca, 0x9a, 0x3b,
    0x00, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0xc1, 0x5d, 0x3b, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3f,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1d, 0x41, 0x00, 0x00, 0xf4, 0x41};

}  // namespace

TEST_CASE("RTDE: packages come out of the stream however it is cut") {
  std::vector<std::uint8_t> stream;
  for (int k = 0; k < 50; ++k) {
    ur5::PackageWriter w(static_cast<std::uint8_t>(k));
    for (int i = 0; i < k; ++i) w.u8(static_cast<std::uint8_t>(i));
    const auto& bytes = w.finish();
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  for (const std::size_t piece : {std::size_t(1), std::size_t(7), std::size_t(4096)}) {
    ur5::Framer framer;
    const auto packages = cut(framer, stream, piece);
    REQUIRE(packages.size() == 50);
    for (int k = 0; k < 50; ++k) {
      CHECK(packages[static_cast<std::size_t>(k)].first == k);
      CHECK(packages[static_cast<std::size_t>(k)].second.size() == static_cast<std::size_t>(k));
    }
  }
}

TEST_CASE("RTDE: an impossible size breaks the stream; random bytes never do worse") {
  ur5::Framer framer;
  cut(framer, {0x00, 0x02, 0x55}, 3);
  CHECK(framer.broken());
  oracle::Random random(1);
  for (int run = 0; run < 2000; ++run) {
    ur5::Framer any;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(random.index(3000)));
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random.bits());
    if (run % 2 == 0 && bytes.size() > 2)
      bytes[0] = 0, bytes[1] = static_cast<std::uint8_t>(3 + random.index(200));
    for (const auto& [type, payload] : cut(any, bytes, 64)) {
      ur5::Report report;
      CHECK(report.decode(payload) == (payload.size() == ur5::Report::bytes));
      ur5::PayloadReader in(payload);
      in.u32(), in.f64(), in.text(5);
      CHECK(in.ok() == (payload.size() >= 17));
    }
  }
}

TEST_CASE("reverse socket: the message is eight big-endian integers, in millionths") {
  const auto bytes = ur5::message(100, {1, -1.5, 0, 0.0000005, 1e9, std::nan("")}, 1);
  const auto at = [&](std::size_t k) {
    return static_cast<std::int32_t>((std::uint32_t(bytes[4 * k]) << 24) |
                                     (std::uint32_t(bytes[4 * k + 1]) << 16) |
                                     (std::uint32_t(bytes[4 * k + 2]) << 8) | bytes[4 * k + 3]);
  };
  CHECK(at(0) == 100);
  CHECK(at(1) == 1'000'000);
  CHECK(at(2) == -1'500'000);
  CHECK(at(4) == 1);  // half a millionth, rounded
  CHECK(at(5) == 0);  // beyond what an integer holds
  CHECK(at(6) == 0);
  CHECK(at(7) == 1);
}

TEST_CASE("program: names the address and port it was given, and stops by itself") {
  const auto text = ur5::program({.address = "10.0.0.7", .port = 50001, .rate = 125});
  {
    const skinctl::testing::CommaLocale comma;
    CHECK(ur5::program({.address = "10.0.0.7", .port = 50001, .rate = 125}) == text);
  }
  CHECK(text.find("socket_open(\"10.0.0.7\", 50001, \"reverse_socket\")") != std::string::npos);
  CHECK(text.find("steptime = 0.008") != std::string::npos);
  CHECK(text.find("stopj(4.0)") != std::string::npos);
  CHECK(text.rfind("end\n") == text.size() - 4);
}

TEST_CASE("driver: settings that cannot work are refused") {
  ur5::DriverConfig config;
  config.interface = skinctl::Interface::torque;
  CHECK_THROWS_WITH(ur5::Driver{config}, doctest::Contains("500 1/s"));
  config = {};
  config.rate = 0;
  CHECK_THROWS(ur5::Driver(config));
}

TEST_CASE("skin datagram: version 1 is read as documented") {
  skin::Datagram d;
  REQUIRE(skin::parse(example, d));
  CHECK(d.sequence == 42);
  CHECK(d.sent == 1s);
  REQUIRE(d.count() == 1);
  REQUIRE(d.is<skinctl::Hexagon>());
  const auto s = d.sample<skinctl::Hexagon>(0);
  CHECK(s.cell == 7);
  CHECK(s.time == 996ms);
  CHECK(s.force == std::array<float, 3>{0.125f, 0.25f, 0.125f});
  CHECK(s.proximity == 0.5f);
  CHECK(s.acceleration[2] == 9.8125f);
  CHECK(s.temperature == 30.5f);
  CHECK(skin::plausible(s, d, 100ms));
  auto late = s;
  late.time = d.sent + 1ns;
  CHECK_FALSE(skin::plausible(late, d, 100ms));
  late.time = d.sent - 100ms - 1ns;
  CHECK_FALSE(skin::plausible(late, d, 100ms));
}

TEST_CASE("skin datagram: any other length, magic, version or count is refused; random bytes are harmless") {
  skin::Datagram d;
  for (std::size_t n = 0; n < example.size(); ++n) CHECK_FALSE(skin::parse(std::span(example).first(n), d));
  for (const std::size_t at :
       {std::size_t(0), std::size_t(3), std::size_t(4), std::size_t(5), std::size_t(6), std::size_t(7)}) {
    auto bad = example;
    bad[at] ^= 0x40;
    CHECK_FALSE(skin::parse(bad, d));
  }
  oracle::Random random(2);
  for (int run = 0; run < 20000; ++run) {
    auto bytes = example;
    for (int k = 0; k < 4; ++k)
      bytes[static_cast<std::size_t>(random.index(static_cast<int>(bytes.size())))] =
          static_cast<std::uint8_t>(random.bits());
    if (!skin::parse(bytes, d)) continue;
    REQUIRE(d.is<skinctl::Hexagon>());
    const auto s = d.sample<skinctl::Hexagon>(0);
    if (skin::plausible(s, d, 100ms)) {
      CHECK(s.force[0] >= 0);
      CHECK(s.force[0] <= 1);
      CHECK(s.time <= d.sent);
    }
  }
}

TEST_CASE("skin receiver: one sender, in order, on the robot's clock") {
  namespace ip = boost::asio::ip;
  skin::Receiver receiver({.clock = {.gather = 0ns}, .real_time = false});
  boost::asio::io_context io;
  ip::udp::socket sender(io, ip::udp::v4()), stranger(io, ip::udp::v4());
  const ip::udp::endpoint to(ip::address_v4::loopback(), receiver.port());
  auto bytes = example;
  const auto send = [&](ip::udp::socket& from, std::uint8_t sequence) {
    bytes[8] = sequence;
    from.send_to(boost::asio::buffer(bytes), to);
  };
  using skinctl::Nanoseconds;
  const Nanoseconds now = 5s;
  send(sender, 1);
  const auto first = receiver.poll(now);
  REQUIRE(first.size() == 1);
  CHECK(first[0].time == now - 4ms);  // measured 4 ms before it was sent, sent just now
  send(sender, 1);                    // repeated
  send(sender, 5);                    // three lost
  send(stranger, 6);
  sender.send_to(boost::asio::buffer(std::string("nonsense")), to);
  CHECK(receiver.poll(now + 1ms).size() == 1);
  const auto& s = receiver.statistics();
  CHECK(s.late == 1);
  CHECK(s.lost == 3);
  CHECK(s.strangers == 1);
  CHECK(s.nonsense == 1);
  CHECK(receiver.silent_for(now + 11ms) == 10ms);
}

TEST_CASE("skin receiver: a clock that is 100 ppm fast or slow stays within 20 us for 300 s") {
  namespace ip = boost::asio::ip;
  for (const double ppm : {100.0, -100.0}) {
    CAPTURE(ppm);
    skin::Receiver receiver({.real_time = false});
    boost::asio::io_context io;
    ip::udp::socket sender(io, ip::udp::v4());
    const ip::udp::endpoint to(ip::address_v4::loopback(), receiver.port());
    auto bytes = example;
    double worst = 0;
    std::size_t heard = 0;
    for (std::uint32_t k = 1; k <= 6000; ++k) {  // every 50 ms
      const double true_time = 0.05 * k;
      const auto now = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * true_time));
      const auto sent = static_cast<std::int64_t>(1e9 * true_time * (1 + 1e-6 * ppm)) + 7'000'000'000;
      const std::int64_t measured = sent - 4'000'000;
      std::memcpy(&bytes[8], &k, 4);
      std::memcpy(&bytes[12], &sent, 8);
      std::memcpy(&bytes[24], &measured, 8);
      sender.send_to(boost::asio::buffer(bytes), to);
      for (const auto& sample : receiver.poll(now)) {
        ++heard;
        const double error = skinctl::seconds<double>(sample.time - now) + 0.004 / (1 + 1e-6 * ppm);
        if (true_time > 10) worst = std::max(worst, std::abs(error));
      }
    }
    MESSAGE(ppm, " ppm: worst error of a stamp ", 1e6 * worst, " us");
    CHECK(heard > 5900);
    CHECK(worst <= 20e-6);
  }
}

TEST_CASE("stream: nobody there is an error that says who; a peer that hangs up is noticed") {
  Stream stream;
  boost::asio::io_context io;
  auto acceptor = listen(io, "127.0.0.1", 0);
  const auto port = acceptor.local_endpoint().port();
  stream.connect("127.0.0.1", port, "a peer", Timeout(1000));
  Stream other;
  other.accept(acceptor, {}, "the program", Timeout(1000));
  std::array<std::uint8_t, 8> block{};
  std::size_t n = 0;
  CHECK(stream.read_some(block, n, Timeout(10)) == Read::nothing);
  CHECK(other.write(std::array<std::uint8_t, 3>{1, 2, 3}, Timeout(100)));
  CHECK(stream.read_some(block, n, Timeout(1000)) == Read::some);
  CHECK(n == 3);
  other.close();
  CHECK(stream.read_some(block, n, Timeout(1000)) == Read::closed);
  acceptor.close();
  CHECK_THROWS_WITH_AS(stream.connect("127.0.0.1", port, "a peer", Timeout(1000)),
                       doctest::Contains("a peer"), ConnectionError);
  auto quiet = listen(io, "127.0.0.1", 0);
  CHECK_THROWS_AS(other.accept(quiet, {}, "the program", Timeout(20)), ConnectionError);
}
