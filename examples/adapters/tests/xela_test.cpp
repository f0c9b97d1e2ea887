// XELA's server: its texts, read whatever they hold, a client of it, and forces from its counts.
//
// Promise: what a XELA server says is read, and whatever else it says neither ends nor stalls its client
// Tried: 100 000 damaged texts; 300 connections that go on with random bytes after the handshake, silence,
// other protocols, texts of more than 1 MB, gaps and repetitions. Also: a server in Python,
// `examples/skin_bridge/tests/xela_peer.py`

#include "examples/adapters/skin/xela.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "examples/adapters/skin/front_end.hpp"
#include "examples/adapters/tests/xela_server.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/by_day.hpp"

using namespace adapters::skin;
using namespace std::chrono_literals;
using skinctl::testing::rounds, skinctl::testing::seeded;
using xela_server::message;
using xela_server::Server;
using xela_server::tcp;
using xela_server::WebSocket;

namespace {

unsigned plain(int taxel, int axis) {
  return unsigned(0x8000 + 16 * taxel + axis);
}
adapters::can::Deadline in(std::chrono::milliseconds t) {
  return std::chrono::steady_clock::now() + t;
}
/// A server that tells these texts and then waits until the client has gone.
auto telling(std::vector<std::string> texts) {
  return [texts = std::move(texts)](tcp::socket socket) {
    WebSocket web(std::move(socket));
    web.accept();
    web.text(true);
    for (const auto& text : texts) web.write(boost::asio::buffer(text));
    boost::beast::flat_buffer nothing;
    web.read(nothing);
  };
}

}  // namespace

TEST_CASE("XELA: a message is read as the maker's manual shows it") {
  XelaMessage m;
  REQUIRE(parse_xela(message(786, 1619157045.6195483, 16, plain), m) == XelaText::message);
  CHECK(m.number == 786);
  CHECK(m.time == doctest::Approx(1619157045.6195483).epsilon(1e-15));
  REQUIRE(m.modules.size() == 1);
  CHECK(m.modules[0].sensor == 1);
  REQUIRE(m.modules[0].counts.size() == 16);
  CHECK(m.modules[0].counts[15] == std::array<std::uint16_t, 3>{0x80F0, 0x80F1, 0x80F2});
  CHECK(m.modules[0].forces.empty());
  CHECK(m.refused == 0);
  CHECK(parse_xela(R"({"message": "Welcome"})", m) == XelaText::welcome);

  REQUIRE(parse_xela(message(1, 0, 1, plain, R"("calibrated": [0.5, -0.25, 2])"), m) == XelaText::message);
  CHECK(m.modules[0].forces == std::vector<std::array<float, 3>>{{0.5f, -0.25f, 2}});
  CHECK(m.time == 0);
  REQUIRE(parse_xela(
              R"({"message": 2, "12": {"taxels": 1, "integer": [1, 2, 65535]},
      "3": {"taxels": 1, "data": "a,B,c"}, "temp": [1]})",
              m) == XelaText::message);
  REQUIRE(m.modules.size() == 2);
  CHECK(m.modules[0].sensor == 3);
  CHECK(m.modules[0].counts[0] == std::array<std::uint16_t, 3>{10, 11, 12});
  CHECK(m.modules[1].counts[0] == std::array<std::uint16_t, 3>{1, 2, 65535});
}

TEST_CASE("XELA: a module that contradicts itself is left out, and the others stay") {
  for (const char* module : {R"({"taxels": 2, "data": "1,2,3"})",
                             R"({"taxels": 1, "data": "1,2,3,4"})",
                             R"({"taxels": 1, "data": "1,2,"})",
                             R"({"taxels": 1, "data": "1,2,12345"})",
                             R"({"taxels": 1, "data": "1,2,-3"})",
                             R"({"taxels": 1, "data": "1,,3"})",
                             R"({"taxels": 1, "data": "1,2,3,"})",
                             R"({"taxels": 1, "data": "g,2,3"})",
                             R"({"taxels": 1, "data": ""})",
                             R"({"taxels": 1, "data": [1,2,3]})",
                             R"({"taxels": 1})",
                             R"({"taxels": 0, "data": ""})",
                             R"({"taxels": 1025, "data": "1"})",
                             R"({"taxels": 1e300, "data": "1"})",
                             R"({"taxels": 1, "integer": [1, 2, 65536]})",
                             R"({"taxels": 1, "integer": [1, 2, 3.5]})",
                             R"({"taxels": 1, "integer": [1, 2, -1]})",
                             R"({"taxels": 1, "data": "1,2,3", "calibrated": [1, 2]})",
                             R"({"taxels": 1, "data": "1,2,3", "calibrated": [1, 2, "3"]})",
                             R"({"taxels": 1, "data": "1,2,3", "calibrated": [1, 2, 1e30]})",
                             "3",
                             "[]"}) {
    XelaMessage m;
    CAPTURE(module);
    REQUIRE(parse_xela(
                std::string(R"({"message": 1, "1": )") + module + R"(, "2": {"taxels": 1, "data": "1,2,3"}})",
                m) == XelaText::message);
    CHECK(m.refused == 1);
    REQUIRE(m.modules.size() == 1);
    CHECK(m.modules[0].sensor == 2);
  }
  for (const char* text :
       {"", "{}", "[]", "7", "{\"message\": 1", R"({"message": "Hello"})", R"({"message": -1})",
        R"({"message": 1.5})", R"({"message": 18446744073709551615})", R"({"message": null})"}) {
    XelaMessage m;
    CAPTURE(text);
    CHECK(parse_xela(text, m) == XelaText::nonsense);
  }
  XelaMessage m;
  REQUIRE(
      parse_xela(R"({"message": 1, "0": {"taxels": 1, "data": "1,2,3"}, "65": {"taxels": 1, "data": "1,2,3"},
      "01": {"taxels": 1, "data": "1,2,3"}})",
                 m) == XelaText::message);
  CHECK(m.modules.empty());
  CHECK(m.refused == 3);
  CHECK(parse_xela(std::string(rounds(1u << 20), '['), m) ==
        XelaText::nonsense);  // deep, and within the size
}

TEST_CASE("XELA: damaged texts: what is read is a message whose parts agree") {
  auto random = seeded(1);
  const auto below = [&](std::size_t n) { return std::size_t(random() % n); };
  const std::string whole =
      message(5, 1e9, 4, plain, R"("calibrated": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12])");
  std::size_t messages = 0, modules = 0;
  for (int k = 0; k < rounds(100'000); ++k) {
    std::string text = whole;
    for (std::size_t hits = 1 + below(4); hits > 0 && !text.empty(); --hits) {
      const std::size_t at = below(text.size());
      const std::size_t kind = below(5);
      if (kind == 0) text[at] = static_cast<char>(random());
      if (kind == 1) text.erase(at, 1 + below(8));
      if (kind == 2) text.insert(at, 1, "{}[]\",:0e-.x"[below(12)]);
      if (kind == 3) text.insert(at, text.substr(below(text.size()), below(40)));
      if (kind == 4) text.resize(at);
    }
    XelaMessage m;
    if (parse_xela(text, m) != XelaText::message) continue;
    ++messages;
    REQUIRE(m.number >= 0);
    for (std::size_t i = 0; i < m.modules.size(); ++i) {
      const auto& module = m.modules[i];
      ++modules;
      REQUIRE(module.sensor >= 1);
      REQUIRE(module.sensor <= 64);
      REQUIRE((i == 0 || module.sensor > m.modules[i - 1].sensor));
      REQUIRE(module.counts.size() >= 1);
      REQUIRE(module.counts.size() <= 1024);
      REQUIRE((module.forces.empty() || module.forces.size() == module.counts.size()));
      for (const auto& f : module.forces)
        for (const float x : f) REQUIRE(std::isfinite(x));
    }
  }
  MESSAGE(messages, " were messages still, with ", modules, " modules");
  CHECK(messages > rounds(1000u));
  CHECK(messages > modules);
}

TEST_CASE("XELA: a client hears a server's messages, counts what is missing, and sees its end") {
  std::vector<std::string> texts{R"({"message": "Welcome"})"};
  for (const int number : {0, 1, 2, 5, 5, 4, 6}) texts.push_back(message(number, 1e9 + number, 16, plain));
  texts.push_back("nonsense");
  texts.push_back(message(7, 1e9, 2, plain, R"("calibrated": [1])"));
  texts.push_back(message(8, 1e9, 2, plain, R"("calibrated": [0, 0, 1, 0, 0, 2])"));
  auto server = std::make_unique<Server>([texts](tcp::socket socket) {
    WebSocket web(std::move(socket));
    web.accept();
    for (const auto& text : texts) web.text(true), web.write(boost::asio::buffer(text));
    web.binary(true);
    web.write(boost::asio::buffer(texts[1]));
    std::this_thread::sleep_for(50ms);
    web.close({});
  });
  XelaClient client("127.0.0.1", server->port());
  XelaSamples<XelaCounts> counts;
  XelaSamples<XelaForces> forces;
  std::vector<std::int64_t> numbers;
  std::size_t pressed = 0;
  while (const XelaMessage* m = client.next(in(5s))) {
    numbers.push_back(m->number);
    for (const auto& s : counts.of(*m, 5ms)) {
      CHECK(s.cell < 16);
      CHECK(s.readings[2] == float(0x8000 + 16 * s.cell + 2));
      CHECK(s.measured == 1);
      CHECK(skinctl::check(s) == skinctl::Status{});
    }
    pressed += forces.of(*m, 5ms).size();
  }
  CHECK(numbers == std::vector<std::int64_t>{0, 1, 2, 5, 6, 7, 8});
  CHECK(client.closed());
  const auto& c = client.counts();
  CHECK(c.messages == 7);
  CHECK(c.lost == 2);
  CHECK(c.late == 2);
  CHECK(c.nonsense == 2);
  CHECK(c.refused == 1);
  CHECK(pressed == 2);
  CHECK(xela_cell(2, 3) == 1027);
}

TEST_CASE("XELA: silence, other protocols and a nobody are named within the time given") {
  Server silent([](tcp::socket socket) {
    std::array<char, 4096> asked;
    while (socket.read_some(boost::asio::buffer(asked)) > 0) {
    }
  });
  CHECK_THROWS_WITH_AS(XelaClient("127.0.0.1", silent.port(), 100ms),
                       doctest::Contains("WebSocket: no answer"), adapters::ConnectionError);
  for (const char* answer :
       {"SSH-2.0-OpenSSH_9.2\r\n\r\n", "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nno", ""}) {
    Server other([answer](tcp::socket socket) {
      std::array<char, 4096> asked;
      socket.read_some(boost::asio::buffer(asked));
      boost::asio::write(socket, boost::asio::buffer(answer, std::strlen(answer)));
    });
    CHECK_THROWS_WITH_AS(XelaClient("127.0.0.1", other.port()), doctest::Contains("WebSocket: "),
                         adapters::ConnectionError);
  }
  std::uint16_t free = 0;
  {
    Server gone([](tcp::socket) {});
    free = gone.port();
  }
  CHECK_THROWS_WITH_AS(XelaClient("127.0.0.1", free), doctest::Contains("connect: "),
                       adapters::ConnectionError);
  Server quiet(telling({R"({"message": "Welcome"})"}));
  XelaClient client("127.0.0.1", quiet.port());
  const auto start = std::chrono::steady_clock::now();
  CHECK(client.next(in(50ms)) == nullptr);
  CHECK(std::chrono::steady_clock::now() - start >= 50ms);
  CHECK_FALSE(client.closed());
  CHECK(client.next(in(-5ms)) == nullptr);
}

TEST_CASE("XELA: random bytes after the handshake, and a text without end, close the connection") {
  auto random = seeded(2);
  int closed = 0;
  for (int k = 0; k < rounds(300); ++k) {
    std::string bytes(1 + random() % 400, ' ');
    for (char& b : bytes) b = static_cast<char>(random());
    if (k % 3 == 0) bytes[0] = '\x81', bytes[1 % bytes.size()] = static_cast<char>(random() % 126);  // a text
    Server server([bytes](tcp::socket socket) {
      WebSocket web(std::move(socket));
      web.accept();
      boost::asio::write(web.next_layer(), boost::asio::buffer(bytes));
      web.next_layer().shutdown(tcp::socket::shutdown_send);
      boost::beast::flat_buffer nothing;
      web.read(nothing);
    });
    XelaClient client("127.0.0.1", server.port());
    while (!client.closed() && client.next(in(5s)) != nullptr) {
    }
    closed += client.closed() ? 1 : 0;
  }
  CHECK(closed == rounds(300));
  Server server(telling({"{\"message\": 1, \"x\": \"" + std::string(2 << 20, 'x') + "\"}"}));
  XelaClient client("127.0.0.1", server.port());
  CHECK(client.next(in(5s)) == nullptr);
  CHECK(client.closed());
}

TEST_CASE("XELA: counts become forces by a front end a taxel, and forces as told need a rest only") {
  using namespace skinctl;
  // Two taxels that each read a little of what presses the other.
  skinctl::testing::Seeded random(3);
  const auto sample = [&](std::uint32_t taxel, const std::array<double, 3>& f) {
    SensorSample<XelaCounts> s{.time = 5ms, .cell = taxel, .readings = {}};
    const std::array<double, 3> count{32600 + 900 * f[1] + 40 * f[0], 31900 - 850 * f[2], 34000 + 600 * f[0]};
    for (std::size_t r = 0; r < 3; ++r) s.readings[r] = float(std::round(count[r] + 2 * random()));
    return s;
  };
  FrontEnd<XelaCounts> front;
  for (int k = 0; k < 20; ++k) front.rest(sample(0, {}));
  for (int k = 0; k < 100; ++k) {
    const double f = random.between(0, 3);
    const std::array<double, 3> force{f, random.between(-0.4, 0.4) * f, random.between(-0.4, 0.4) * f};
    front.press(sample(0, force), force);
  }
  const auto found = front.find();
  for (const double e : found.error) CHECK(e < 0.02);
  using One = Skin<ur5::Model, double, Patch<2, 1, XelaCounts>>;
  ChannelSettings<XelaCounts> fine;  // the default gate of 0.2 N is for harder pushes
  fine.gate[0] = EventGate<>::dead_band(0.02);
  const auto skin = calibrated(
      One(Patch<2, 1, XelaCounts>({{0, Transform<Link<2>, Cell>::translation_xyz(0.1, 0, 0.2)}}), fine),
      {found.calibration});
  const auto pushed = [&](const std::array<double, 3>& force) {
    auto memory = skin.start(0ns);
    One::Wrenches mean;
    const auto s = sample(0, force);
    CHECK(skin.receive(memory, std::span(&s, 1), 0ns, 10ms, 1, &mean) == Status{});
    return skin.wrenches(memory);
  };
  const auto w = pushed({2, 0.5, -0.3});
  CHECK(w.data[0][2] == doctest::Approx(-2).epsilon(0.02));
  CHECK(w.data[0][0] == doctest::Approx(0.5).epsilon(0.05));
  CHECK(w.data[0][1] == doctest::Approx(-0.3).epsilon(0.05));
  CHECK(std::abs(pushed({0, 0, 0}).data[0][2]) < 0.02);

  FrontEnd<XelaForces> told;
  for (int k = 0; k < 10; ++k)
    told.rest(
        {.time = 5ms, .cell = 0, .readings = {0.125f, -0.25f, 0.5f}});  // where the server's zero has drifted
  const auto c = told.at_rest(ChannelCalibration<XelaForces>::identity());
  CHECK(c.amounts(std::array{0.125f, -0.25f, 2.5f}.data()) == std::array{2.0f, 0.0f, 0.0f});
}
