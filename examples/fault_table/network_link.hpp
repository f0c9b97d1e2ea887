// Two network namespaces of this process, joined by a wire that loses, delays, repeats and reorders IP
// packets, so that TCP of the kernel itself retransmits. Nothing leaves the machine.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace fault_table {

/// What the wire does to the packets of each direction.
struct LinkFault {
  double loss = 0;       ///< share of packets that never arrive
  double duplicate = 0;  ///< share of packets that arrive twice
  double reorder = 0;    ///< share of packets that come `overtaken` later than they would
  double delay = 0;      ///< of each packet [s]
  double jitter = 0;     ///< largest delay on top, uniform; packets keep their order [s]
  bool down = false;     ///< nothing passes
  static constexpr double overtaken = 0.012;  ///< more than one cycle of 8 ms [s]
};

/// One packet, when it leaves the wire or is lost in it.
struct SeenPacket {
  double time = 0;       ///< since the link was made [s]
  bool to_robot = true;  ///< direction
  bool lost = false;     ///< in the wire
  bool tcp = false;
  std::uint16_t source = 0, destination = 0;  ///< ports
  std::uint32_t sequence = 0, length = 0;     ///< TCP's number, and bytes of payload
};

/// Namespaces live as long as the link and the sockets in them.
class NetworkLink {
 public:
  static constexpr const char* job_address = "10.77.0.1";
  static constexpr const char* robot_address = "10.77.0.2";

  /// Throws `std::runtime_error` where the system gives no namespaces or no /dev/net/tun.
  explicit NetworkLink(std::uint64_t seed);
  ~NetworkLink();
  NetworkLink(const NetworkLink&) = delete;
  NetworkLink& operator=(const NetworkLink&) = delete;

  /// Runs `f` on a thread whose sockets, and those of the threads that it starts, are at the job's end or the
  /// robot's.
  [[nodiscard]] std::thread at_job(std::function<void()> f);
  [[nodiscard]] std::thread at_robot(std::function<void()> f);

  /// From now on.
  void set(const LinkFault& fault);
  /// Called on the wire's thread with each packet that comes: true loses it. Before the first packet.
  void set_judge(std::function<bool(const SeenPacket&)> judge);
  /// Called on the wire's thread with each packet; before the first packet.
  void set_observer(std::function<void(const SeenPacket&)> observer);

 private:
  struct Wire;
  std::unique_ptr<Wire> wire_;
};

/// For users other than root: a user namespace, in which they may make the others. Only before the first
/// thread.
void become_root_of_own_namespace() noexcept;

}  // namespace fault_table
