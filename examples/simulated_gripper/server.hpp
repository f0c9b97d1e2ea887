// Serves a simulated gripper's bytes at a port, from a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "examples/simulated_gripper/device.hpp"

namespace simulated_gripper {

enum class Kind { robotiq, onrobot, lacquey };

/// What a server does wrong, for tests; may be changed while it runs.
struct Misbehaviour {
  std::atomic<bool> silent{false};         ///< it hears and does not answer
  std::atomic<bool> byte_by_byte{false};   ///< each byte in a packet of its own
  std::atomic<bool> garbage{false};        ///< bytes that mean nothing instead of answers
  std::atomic<bool> twice{false};          ///< each answer two times
  std::atomic<bool> hang_up{false};        ///< closes instead of answering
  std::atomic<bool> cut_short{false};      ///< half of each answer
  std::atomic<bool> other_version{false};  ///< answers of another version of the protocol
  std::atomic<bool> line_end_after_ack{
      false};                   ///< Robotiq: "ack" and a line end, where the device sends none
  std::atomic<double> lose{0};  ///< this share of requests is not heard: no effect, no answer
  std::atomic<int> late_ms{0};  ///< each answer after so long
};

struct ServerConfig {
  Kind kind = Kind::robotiq;
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any; for `lacquey` that of the computer it connects to
  double speed = 1;        ///< times real time
  bool active = false;     ///< a Robotiq that has been activated before
  Object object{};
};

/// Runs until it is destroyed. Throws what Boost.Asio throws where the port cannot be bound or reached.
class Server {
 public:
  explicit Server(const ServerConfig& config);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  Misbehaviour& misbehave() { return misbehaviour_; }
  /// Between the fingers from now on.
  void put(const Object& object);
  /// A fault of the device: FLT of a Robotiq, safety bits of an OnRobot.
  void fault(int code);
  /// How far the fingertips of an OnRobot reach inward, each, from now on [0.1 mm].
  void fingertips(std::int16_t offset);
  struct Seen {
    double opening = 0, force = 0;
    bool moving = false;
  };
  [[nodiscard]] Seen seen();

 private:
  struct Network;
  [[nodiscard]] double now() const;
  /// The answers to what is whole in `bytes`, which are taken from it; false: close.
  bool answer(std::string& bytes, std::string& out);

  ServerConfig config_;
  std::mutex mutex_;
  RobotiqDevice robotiq_;
  OnRobotDevice onrobot_;
  LacqueyDevice lacquey_;
  Misbehaviour misbehaviour_;
  std::unique_ptr<Network> network_;
};

}  // namespace simulated_gripper
