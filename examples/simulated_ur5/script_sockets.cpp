#include "examples/simulated_ur5/script_sockets.hpp"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/steady_timer.hpp>

namespace simulated_ur5 {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
constexpr auto patience = std::chrono::seconds(2);

}  // namespace

void ScriptSockets::follow(const urscript::Sockets& sockets) {
  const auto wanted = [&](std::uint64_t number) {
    const auto& all = sockets.all();
    return std::any_of(all.begin(), all.end(), [&](const auto& s) { return s->number == number; });
  };
  for (auto i = served_.begin(); i != served_.end();) {
    if (wanted(i->first)) {
      ++i;
      continue;
    }
    if (const auto connection = i->second.connection) {
      // What the program sent last still goes out.
      connection->on_closed = nullptr;
      connection->send(i->second.socket->to_send);
      connection->close_when_sent();
    }
    i = served_.erase(i);
  }
  for (const auto& socket : sockets.all()) {
    const auto [at, fresh] = served_.try_emplace(socket->number, Served{socket, nullptr});
    if (fresh) open(socket);
    if (at->second.connection && !socket->to_send.empty()) {
      at->second.connection->send(socket->to_send);
      socket->to_send.clear();
    }
  }
}

void ScriptSockets::close() {
  for (auto& [number, served] : served_)
    if (served.connection) {
      served.connection->on_closed = nullptr;
      served.connection->close("the controller shut down");
    }
  served_.clear();
}

void ScriptSockets::open(const Socket& socket) {
  boost::system::error_code error;
  const auto address =
      asio::ip::make_address(socket->host == "localhost" ? "127.0.0.1" : socket->host, error);
  if (error || (!address.is_loopback() && !reach_out_)) {
    log_("the program wants to reach '" + socket->host.substr(0, 64) + "', which is " +
         (error ? "no numeric address" : "not this machine; see --reach-out"));
    socket->state = urscript::Socket::State::failed;
    return;
  }
  auto connecting = std::make_shared<tcp::socket>(io_);
  auto timer = std::make_shared<asio::steady_timer>(io_, patience);
  timer->async_wait([connecting](const boost::system::error_code& stopped) {
    boost::system::error_code ignored;
    if (!stopped) connecting->close(ignored);
  });
  connecting->async_connect({address, socket->port},
                            [this, socket, connecting, timer](const boost::system::error_code& failed) {
                              timer->cancel();
                              if (served_.count(socket->number) == 0) return;
                              if (failed || !connecting->is_open())
                                socket->state = urscript::Socket::State::failed;
                              else
                                adopt(socket, std::move(*connecting));
                              heard_();
                            });
}

void ScriptSockets::adopt(const Socket& socket, tcp::socket connected) {
  auto connection = std::make_shared<Connection>(std::move(connected), urscript::Sockets::longest_queue);
  connection->on_bytes = [this, socket](std::span<const std::uint8_t> bytes) {
    if (socket->received.size() + bytes.size() > urscript::Sockets::longest_queue) return false;
    socket->received.insert(socket->received.end(), bytes.begin(), bytes.end());
    heard_();
    return true;
  };
  connection->on_closed = [this, socket](const char* why) {
    log_(socket->name + ": " + why);
    socket->peer_gone = true;
    heard_();
  };
  socket->state = urscript::Socket::State::open;
  served_[socket->number].connection = connection;
  connection->start();
}

}  // namespace simulated_ur5
