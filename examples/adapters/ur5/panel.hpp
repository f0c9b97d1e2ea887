// The robot's panel from afar: power, brakes and unlocking, by the dashboard server or by the REST interface
// of PolyScope X.
#pragma once

#include <string>

#include "examples/adapters/socket.hpp"

namespace adapters::ur5 {

/// A line in, a line out.
class Dashboard {
 public:
  /// Throws `ConnectionError`, as do all of these.
  void connect(const std::string& host, std::uint16_t port, Timeout timeout);
  /// The answer to one command, without its line end. An answer of more than 4 kB is refused.
  std::string ask(const std::string& command);
  void close() noexcept { stream_.close(); }

 private:
  std::string line(const std::string& what);
  Stream stream_;
  Timeout timeout_{};
  std::string rest_;
};

/// `PUT .../robotstate/v1/state {"action": ACTION}` and `GET .../robotmode`: an HTTP exchange on a connection
/// of its own. Answers of more than 64 kB, redirections and anything but 2xx are `ConnectionError`s with the
/// answer's text.
class Rest {
 public:
  Rest(std::string host, std::uint16_t port, Timeout timeout);
  /// POWER_ON, BRAKE_RELEASE, POWER_OFF, UNLOCK_PROTECTIVE_STOP, RESTART_SAFETY.
  void act(const std::string& action);
  /// `what`: "robotmode" or "safetymode" (PolyScope 10.12 and later). The word, such as RUNNING.
  std::string get(const std::string& what);

 private:
  std::string exchange(bool put, const std::string& target, const std::string& body);
  std::string host_;
  std::uint16_t port_;
  Timeout timeout_;
};

/// The "mode" in an answer of the REST interface; empty if there is none.
[[nodiscard]] std::string mode_in(const std::string& json);

}  // namespace adapters::ur5
