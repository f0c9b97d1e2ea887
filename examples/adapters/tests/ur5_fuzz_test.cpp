// What a peer that is no robot may say: RTDE, dashboard and REST answers, by chance and by mutation.
//
// Promise: answers of RTDE, dashboard and REST, however damaged, are an error or are read
// Tried: 900 connections, 20 000 texts

#include <doctest/doctest.h>

#include <thread>

#include "examples/adapters/ur5/panel.hpp"
#include "examples/adapters/ur5/rtde_client.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/robot_table.hpp"

using namespace adapters;
using namespace adapters::ur5;

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr int cases = skinctl::testing::sanitized ? 60 : 300;

/// Sends `bytes` to one client, in pieces, and hangs up, or stays until the client does.
void serve(boost::asio::ip::tcp::acceptor& acceptor, const Bytes& bytes, std::size_t piece, bool stays) {
  Stream client;
  try {
    client.accept(acceptor, {}, "a client", Timeout(2000));
  } catch (const ConnectionError&) {
    return;
  }
  for (std::size_t at = 0; at < bytes.size(); at += piece)
    if (!client.write(std::span(bytes).subspan(at, std::min(piece, bytes.size() - at)), Timeout(100))) return;
  // Who hangs up before the client has asked may take its own answers back.
  std::array<std::uint8_t, 256> asked{};
  std::size_t n = 0;
  while (stays && client.read_some(asked, n, Timeout(500)) == Read::some) {
  }
}

Bytes text(const std::string& s) {
  return Bytes(s.begin(), s.end());
}
/// Some bytes changed, some missing, some twice.
Bytes mutated(Bytes b, oracle::Random& random) {
  for (int k = random.index(6); k > 0 && !b.empty(); --k) {
    const auto at = static_cast<std::size_t>(random.index(static_cast<int>(b.size())));
    const int what = random.index(3);
    if (what == 0) b[at] = static_cast<std::uint8_t>(random.bits());
    if (what == 1) b.resize(at);
    if (what == 2) b.insert(b.end(), b.begin() + static_cast<std::ptrdiff_t>(at), b.end());
  }
  return b;
}
template <class Client>
int attacked(const Bytes& good, unsigned seed, Client&& client) {
  oracle::Random random(seed);
  boost::asio::io_context io;
  auto acceptor = listen(io, "127.0.0.1", 0);
  const auto port = acceptor.local_endpoint().port();
  int survived = 0;
  for (int k = 0; k < cases; ++k) {
    Bytes bytes = mutated(good, random);
    if (k % 5 == 4) {
      bytes.resize(static_cast<std::size_t>(random.index(400)));
      for (auto& b : bytes) b = static_cast<std::uint8_t>(random.bits());
    }
    if (k % 10 == 0) bytes = good;
    std::thread server(
        [&] { serve(acceptor, bytes, static_cast<std::size_t>(1 + random.index(40)), k % 10 == 0); });
    try {
      client(port);
      ++survived;
    } catch (const ConnectionError&) {
    }
    server.join();
  }
  return survived;
}

}  // namespace

TEST_CASE("RTDE client: answers by chance end in an error or a connection, within their time") {
  Bytes good;
  const auto add = [&](PackageWriter w) {
    const auto& b = w.finish();
    good.insert(good.end(), b.begin(), b.end());
  };
  PackageWriter version(package::version);
  version.u8(1);
  add(version);
  PackageWriter hello(package::message);
  hello.u8(5), hello.text("hello"), hello.u8(3), hello.text("rob"), hello.u8(1);
  add(hello);
  PackageWriter controller(package::controller);
  for (const std::uint32_t n : {5u, 23u, 0u, 1u}) controller.u32(n);
  add(controller);
  PackageWriter outputs(package::outputs);
  outputs.u8(1), outputs.text(Report::types);
  add(outputs);
  const auto begin = std::chrono::steady_clock::now();
  const int survived = attacked(good, 3, [](std::uint16_t port) {
    RtdeClient client;
    client.connect("127.0.0.1", port, Timeout(150));
    static_cast<void>(client.outputs(125, Report::recipe, Report::types));
    for (const char c : client.said()) CHECK((c >= ' ' && c <= '~'));
  });
  CHECK(survived > 0);
  CHECK(survived < cases);
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(200 * cases));
}

TEST_CASE("dashboard: any answer is a line or an error") {
  CHECK(attacked(text("Connected: Universal Robots Dashboard Server\nPowering on\n"), 4,
                 [](std::uint16_t port) {
                   Dashboard dashboard;
                   dashboard.connect("127.0.0.1", port, Timeout(150));
                   const auto answer = dashboard.ask("power on");
                   CHECK(answer.find('\n') == std::string::npos);
                   CHECK(answer.size() < 5000);
                 }) > 0);
}

TEST_CASE("REST: any answer is a word of capitals or an error") {
  const std::string body = R"({"mode": "RUNNING"})";
  CHECK(
      attacked(text("HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body),
               5, [](std::uint16_t port) {
                 const auto word = Rest("127.0.0.1", port, Timeout(60)).get("robotmode");
                 CHECK(!word.empty());
                 for (const char c : word) CHECK(((c >= 'A' && c <= 'Z') || c == '_'));
               }) > 0);
  oracle::Random random(6);
  for (int k = 0; k < 20000; ++k) {
    std::string json = R"({"a": 1, "mode" : "POWER_OFF", "b": "mode"})";
    for (int m = 0; m < 3; ++m)
      json[static_cast<std::size_t>(random.index(static_cast<int>(json.size())))] =
          static_cast<char>(random.bits());
    for (const char c : mode_in(json)) CHECK(((c >= 'A' && c <= 'Z') || c == '_'));
  }
  CHECK(mode_in(R"({"mode": "POWER_OFF"})") == "POWER_OFF");
  CHECK(mode_in(R"({"mode": 7})").empty());
  CHECK(mode_in(R"({"mode": ")" + std::string(1000, 'A') + "\"}").empty());
}
