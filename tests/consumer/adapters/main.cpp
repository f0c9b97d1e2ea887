// A user's program with the installed drivers of each kind: a UR that is not there is refused by name, an arm
// that is the clock is waited for, and a browser finds the live page.
#include <cstdio>
#include <cstring>
#include <string>

#include "examples/adapters/allegro/driver.hpp"
#include "examples/adapters/clocked_driver.hpp"
#include "examples/adapters/fri/fri.hpp"
#include "examples/adapters/gripper/robotiq.hpp"
#include "examples/adapters/live/live_view.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/xela.hpp"
#include "examples/adapters/ur5/driver.hpp"
#include "examples/live_page/page.hpp"

namespace {

/// A port of this computer at which nobody listens.
std::uint16_t closed_port() {
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor held(io, {boost::asio::ip::address_v4::loopback(), 0});
  return held.local_endpoint().port();
}

std::string get(std::uint16_t port, const std::string& path) {
  adapters::Stream browser;
  browser.connect("127.0.0.1", port, "the live page", adapters::Timeout(2000));
  const std::string asked = "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                            "\r\nConnection: close\r\n\r\n";
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(asked.data());
  if (!browser.write({bytes, asked.size()}, adapters::Timeout(2000))) return {};
  std::string all;
  std::uint8_t some[4096];
  std::size_t n = 0;
  while (browser.read_some(some, n, adapters::Timeout(2000)) == adapters::Read::some)
    all.append(reinterpret_cast<const char*>(some), n);
  return all;
}

}  // namespace

int main() {
  adapters::ur5::DriverConfig config;
  config.rtde_port = closed_port();
  adapters::ur5::Driver ur5(config);
  try {
    ur5.connect();
    return 1;
  } catch (const adapters::ConnectionError& e) {
    std::printf("%s\n", e.what());
    if (std::strstr(e.what(), std::to_string(config.rtde_port).c_str()) == nullptr) return 2;
  }
  adapters::fri::Options session;
  session.port = 0;
  const adapters::fri::Fri iiwa(session);
  std::printf("an iiwa is waited for %s\n", iiwa.place().c_str());

  adapters::live::ServerOptions options;
  live_page::put_page(options);
  adapters::live::FoxgloveServer server(std::move(options));
  server.start();
  const std::string page = get(server.port(), "/");
  std::printf("the live page: %zu bytes\n", page.size());
  return page.find("<html") == std::string::npos || get(server.port(), "/app.js").size() < 1000 ? 3 : 0;
}
