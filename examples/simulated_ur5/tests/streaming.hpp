// A controller under a program that is commanded over a socket, without a network.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <utility>

#include "examples/simulated_ur5/controller.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

namespace simulated_ur5 {

struct Streaming {
  explicit Streaming(ControllerConfig config, const std::string& program = raw::stream_program(50001))
      : c(std::move(config)) {
    REQUIRE(c.run(program).empty());
    c.step();
    socket = c.sockets().find("reverse_socket");
    REQUIRE(socket);
    socket->state = urscript::Socket::State::open;
  }
  void say(std::int32_t timeout, const Joints& v, std::int32_t mode) {
    const raw::Bytes bytes = raw::reverse_message(timeout, v, mode);
    socket->received.insert(socket->received.end(), bytes.begin(), bytes.end());
  }
  void send(std::int32_t timeout, const Joints& v, std::int32_t mode) {
    say(timeout, v, mode);
    c.step();
  }
  void steps(int n) {
    for (int i = 0; i < n; ++i) c.step();
  }
  Controller c;
  std::shared_ptr<urscript::Socket> socket;
};

}  // namespace simulated_ur5
