// A simulated server of XELA's for tests: whoever connects is told texts over a WebSocket, or bytes that are
// none.
#pragma once

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>
#include <thread>

namespace xela_server {

namespace asio = boost::asio;
using asio::ip::tcp;
using WebSocket = boost::beast::websocket::stream<tcp::socket>;

/// Serves one client: `talk` gets its TCP connection, and ends by an exception where the client has gone.
class Server {
 public:
  explicit Server(std::function<void(tcp::socket)> talk)
      : acceptor_(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0)),
        thread_([this, talk = std::move(talk)] {
          try {
            talk(acceptor_.accept());
          } catch (const std::exception&) {
          }
        }) {}
  ~Server() {
    if (!thread_.joinable()) return;
    boost::system::error_code none;  // one that nobody has asked yet
    tcp::socket(io_).connect(acceptor_.local_endpoint(none), none);
    thread_.join();
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

 private:
  asio::io_context io_;
  tcp::acceptor acceptor_;
  std::thread thread_;
};

/// What a server says of one module of `taxels` taxels, whose numbers are `count(taxel, axis)`.
template <class F>
std::string message(int number, double time, int taxels, F&& count,
                    const std::string& more = "\"calibrated\": null") {
  std::string data;
  for (int k = 0; k < taxels; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      char digits[8];
      std::snprintf(digits, sizeof digits, "%s%04X", data.empty() ? "" : ",", unsigned(count(k, axis)));
      data += digits;
    }
  char head[160];
  std::snprintf(head, sizeof head,
                R"({"message": %d, "time": %.7f, "sensors": 1, "1": {"taxels": %d, "sensor": "1", )", number,
                time, taxels);
  return head + (R"("model": "XR1944", "data": ")" + data) + "\", " + more + "}}";
}

}  // namespace xela_server
