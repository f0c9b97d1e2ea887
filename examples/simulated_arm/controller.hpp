// A simulated controller that is the clock: it sends a state each cycle, and judges the answers.
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>

#include "examples/simulated_arm/arm.hpp"

namespace simulated_arm {

/// A maker's protocol and its limits, for an arm of the type `A`.
template <class A>
class FaceOf {
 public:
  virtual ~FaceOf() = default;
  [[nodiscard]] virtual double period() const = 0;  ///< [s]
  /// A datagram from outside; the bytes of an answer to it in `out`, 0: none.
  virtual std::size_t hear(std::span<const std::uint8_t> bytes, A& arm, std::span<std::uint8_t> out) = 0;
  /// What comes by other ways than datagrams: a connection may say where to send them, by another `socket`.
  virtual void attend(A&, adapters::UdpSocket&) {}
  /// Where it waits, if not at the socket.
  [[nodiscard]] virtual std::uint16_t port(const adapters::UdpSocket& socket) const { return socket.port(); }
  /// The end of a cycle: judges its answer and moves the arm.
  virtual void cycle(A& arm) = 0;
  /// The datagram of the next cycle; 0: nobody is told.
  virtual std::size_t state(const A& arm, std::span<std::uint8_t> out) = 0;
  /// Whether this cycle's answer is there, or none is waited for.
  [[nodiscard]] virtual bool answered() const = 0;
  virtual void emergency_stop(A& arm) = 0;
  virtual void restart() = 0;  ///< numbers begin anew

  /// Why it takes no more motion; empty: it does.
  std::string ended;
  std::uint64_t late = 0;     ///< cycles without an answer in time
  std::uint64_t answers = 0;  ///< that counted

 protected:
  void end(A& arm, std::string why) {
    if (ended.empty()) ended = std::move(why);
    arm.halt();
  }
};

using Face = FaceOf<Arm>;

/// How a controller stands, whatever its joints.
struct Standing {
  double time = 0;  ///< of the robot [s]
  std::string ended;
  std::uint64_t late = 0, answers = 0, states = 0;
  double moved_at = 0;  ///< last time at which a joint was faster than 1 mrad/s [s]
};
template <std::size_t N>
struct SnapshotOf : Standing {
  std::array<double, N> q{}, dq{}, told{};
};
using Snapshot = SnapshotOf<6>;

/// Runs a face with its own clock in a thread.
template <class A>
class ControllerOf {
 public:
  ControllerOf(std::unique_ptr<FaceOf<A>> face, adapters::UdpSocket socket, const Config& config, A arm);
  ~ControllerOf() { stop(); }
  ControllerOf(const ControllerOf&) = delete;
  ControllerOf& operator=(const ControllerOf&) = delete;
  [[nodiscard]] SnapshotOf<A::joints> snapshot() const;
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t longest = 4096;  // datagram [bytes]
  void run();
  void listen(Clock::time_point until);
  void hear(const Bytes& bytes);
  void tell(Bytes bytes);
  bool happens(double share) {
    return share > 0 && arm_.time() >= config_.faults.from && chance_(random_) < share;
  }

  std::unique_ptr<FaceOf<A>> face_;
  adapters::UdpSocket socket_;
  Config config_;
  A arm_;
  std::uint16_t port_;
  std::minstd_rand random_{7};
  std::uniform_real_distribution<double> chance_{0, 1};
  struct Waiting {
    double at;
    Bytes bytes;
  };
  std::deque<Waiting> waiting_;  ///< answers that are late
  Bytes held_;                   ///< a state that another one overtakes
  std::uint64_t states_ = 0;
  double moved_at_ = 0;
  bool restarted_ = false;
  mutable std::mutex mutex_;
  SnapshotOf<A::joints> snapshot_;
  std::atomic<bool> stop_{false};
  std::thread thread_;  // last: it uses the others
};

class Controller : public ControllerOf<Arm> {
 public:
  Controller(std::unique_ptr<Face> face, adapters::UdpSocket socket, const Config& config)
      : ControllerOf(std::move(face), std::move(socket), config, Arm(config)) {}
};

}  // namespace simulated_arm
