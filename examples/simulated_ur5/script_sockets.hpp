// Serves the sockets of interpreted programs: opens connections, brings what comes, sends what waits.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "examples/simulated_ur5/connection.hpp"
#include "examples/simulated_ur5/urscript/sockets.hpp"

namespace simulated_ur5 {

class ScriptSockets {
 public:
  /// @param reach_out  also to other machines.
  /// @param heard  called when something came, opened or closed.
  ScriptSockets(boost::asio::io_context& io, bool reach_out, std::function<void()> heard,
                std::function<void(const std::string&)> log)
      : io_(io), reach_out_(reach_out), heard_(std::move(heard)), log_(std::move(log)) {}

  /// Does what the program wants of its sockets; drops the connections of those that it closed.
  void follow(const urscript::Sockets& sockets);
  void close();

 private:
  using Socket = std::shared_ptr<urscript::Socket>;
  void open(const Socket& socket);
  void adopt(const Socket& socket, boost::asio::ip::tcp::socket connected);

  boost::asio::io_context& io_;
  bool reach_out_;
  std::function<void()> heard_;
  std::function<void(const std::string&)> log_;
  struct Served {
    Socket socket;
    std::shared_ptr<Connection> connection;  ///< null: not open yet
  };
  std::map<std::uint64_t, Served> served_;
};

}  // namespace simulated_ur5
