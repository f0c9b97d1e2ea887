// What can happen between a robot and its program: a wire that delays, loses, repeats and garbles what passes
// through it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace simulated_ur5 {

using Bytes = std::vector<std::uint8_t>;

/// Where the fields of an RTDE data package are, as the wire has overheard them: byte offsets in the whole
/// package.
class RtdeLayout {
 public:
  /// Reads a client's request for outputs, and the robot's answer to it.
  void asked(const Bytes& package);
  void answered(const Bytes& package);
  [[nodiscard]] bool has(const std::string& name) const { return offset_.contains(name); }
  [[nodiscard]] double number(const Bytes& package, const std::string& name, std::size_t element = 0) const;
  void set(Bytes& package, const std::string& name, std::size_t element, double value) const;
  /// Size of a data package; 0: not known yet.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::string names_;
  std::map<std::string, std::size_t> offset_;
  std::size_t size_ = 0;
};

/// What leaves the wire instead of one package of the robot: nothing, one, or several.
using Change = std::function<std::vector<Bytes>(Bytes package, const RtdeLayout& layout)>;

/// Changes of RTDE data packages; other packages pass.
namespace change {
Change not_a_number(std::size_t joint);
Change frozen_clock();
Change clock_back(double seconds);
Change clock_rate(double rate);
/// The reported position of a joint stays where it is, its velocity is 0.
Change stuck(std::size_t joint);
/// Positions and velocities come so many packages late; the stamps stay.
Change late(std::size_t packages);
Change repeated();
/// Every third package comes before the one in front of it.
Change reordered();
/// The tail is missing, and the size says so.
Change truncated(std::size_t missing);
Change garbled();
/// A share of the packages is lost.
Change lost(double share);
/// Nothing for so long [s], then all of it at once, as when TCP waits for what it has lost; later packages
/// pass. With `rest_after` first the oldest quarter, the rest so much later [s], as TCP begins anew slowly.
Change stalled(double duration, double rest_after = 0);
}  // namespace change

/// A TCP connection on loopback through which everything passes until it is told otherwise. Thread-safe.
class FaultyWire {
 public:
  enum class Cable : unsigned char {
    whole,
    cut,         ///< nothing passes in either direction, and nobody is told
    from_robot,  ///< only what the robot sends passes: half open
    to_robot,    ///< only what the program sends passes: half open
    reset,       ///< both ends are hung up on, at once
  };

  /// Listens on a free port (or `listen`), and connects each client on to `target`. `rtde`: cut into
  /// packages, which `set(Change)` wants.
  explicit FaultyWire(std::uint16_t target, bool rtde, std::uint16_t listen = 0);
  ~FaultyWire();
  FaultyWire(const FaultyWire&) = delete;
  FaultyWire& operator=(const FaultyWire&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  void set_target(std::uint16_t target) noexcept { target_ = target; }
  void set(Cable cable);
  /// To every package of the robot from now on; empty: none.
  void set(Change change);
  /// Bytes of the robot pass one by one, or in bursts, each after `pause_ms`.
  void set_pieces(std::size_t bytes, int pause_ms);
  /// What comes in from now on leaves so much later, in both directions.
  void set_delay(int milliseconds);
  /// Called on the wire's thread: when bytes have come in, and when they have been sent on.
  void set_observer(std::function<void(bool from_target, bool sent_on)> observer);

 private:
  struct Session;
  void run();
  void pass(Session& s, bool from_robot);
  void send(Session& s, bool from_robot, const Bytes& out);
  std::atomic<std::uint16_t> target_;
  std::uint16_t port_ = 0;
  bool rtde_;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace simulated_ur5
