// Lacquey Fetch grippers: as TUM drives them, through a thread of the UR's program, and as UC3M does, by CAN.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>

#include "examples/adapters/can/link.hpp"
#include "examples/adapters/gripper/binary.hpp"
#include "examples/adapters/socket.hpp"

namespace adapters::gripper {

/// What a Lacquey on a UR is told, big-endian int32 each.
enum class LacqueyWord : std::int32_t { activate = 20, free = 21, open = 22, close = 23 };
[[nodiscard]] constexpr std::array<std::uint8_t, 8> lacquey_words(bool closed) noexcept {
  const auto second = static_cast<std::uint8_t>(closed ? LacqueyWord::close : LacqueyWord::open);
  return {0, 0, 0, static_cast<std::uint8_t>(LacqueyWord::activate), 0, 0, 0, second};
}

/// Waits for the program on the robot, which connects to `port`, and passes the words on. A `GripperLine`.
class LacqueyServer {
 public:
  /// Throws `ConnectionError` where the port cannot be bound. Port 0: any.
  explicit LacqueyServer(const std::string& address = "127.0.0.1", std::uint16_t port = 50003)
      : acceptor_(listen(io_, address, port)) {}
  /// Throws `ConnectionError` if nobody connects in time; only `from` is let in, if that is an address.
  void accept(Timeout timeout, const boost::asio::ip::address& from = {}) {
    stream_.accept(acceptor_, from, "the gripper's program on the robot", timeout);
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

  bool set(bool closed) noexcept {
    const bool sent = stream_.write(lacquey_words(closed), Timeout(20));
    if (!sent) stream_.close();
    return sent;
  }
  /// Looks whether the program has hung up.
  [[nodiscard]] bool good() noexcept {
    std::array<std::uint8_t, 64> ignored;
    std::size_t n = 0;
    if (stream_.is_open() && stream_.read_some(ignored, n, Timeout(0)) == Read::closed) stream_.close();
    return stream_.is_open();
  }
  [[nodiscard]] std::optional<bool> read() const noexcept { return std::nullopt; }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  Stream stream_;
};

/// Which arm of the robot carries it, on CAN.
enum class LacqueySide : std::uint8_t { left = 64, right = 65 };

/// The frame that closes (100 %) or opens (-100 %) it: a little-endian float.
[[nodiscard]] inline can::Frame lacquey_frame(LacqueySide side, bool closed) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(closed ? 100.0f : -100.0f);
  can::Frame out;
  out.id = static_cast<std::uint16_t>(side);
  out.size = 4;
  for (std::size_t k = 0; k < 4; ++k) out.data[k] = static_cast<std::uint8_t>(bits >> (8 * k));
  return out;
}

/// A `GripperLine` over a CAN bus.
template <can::CanLink Link>
class LacqueyCan {
 public:
  LacqueyCan(Link& link, LacqueySide side) : link_(link), side_(side) {}
  bool set(bool closed) noexcept { return good_ = link_.write(lacquey_frame(side_, closed), Timeout(5)); }
  [[nodiscard]] bool good() noexcept { return good_; }
  [[nodiscard]] std::optional<bool> read() const noexcept { return std::nullopt; }

 private:
  Link& link_;
  LacqueySide side_;
  bool good_ = true;
};

}  // namespace adapters::gripper
