// Two ways to a CAN bus: sockets that carry `struct can_frame`, and adapters at a serial line (slcan).
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "examples/adapters/can/frame.hpp"
#include "examples/adapters/socket.hpp"

namespace adapters::can {

using Deadline = std::chrono::steady_clock::time_point;

/// An owned file descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) noexcept : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    if (this != &other) {
      close();
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~Descriptor() { close(); }
  [[nodiscard]] int get() const noexcept { return fd_; }
  void close() noexcept;

 private:
  int fd_ = -1;
};

/// Waits until `fd` is ready for `events` (of poll); false when the time is over. It looks at least once.
bool wait_for(int fd, short events, Deadline deadline) noexcept;

/// A CAN link: `read` gives the next frame and waits for it at most until `deadline`, `write` sends one
/// within `timeout`. Both are bounded and do not throw.
template <class L>
concept CanLink = requires(L& link, Frame& frame, const Frame& sent, Deadline deadline, Timeout timeout) {
  { link.read(frame, deadline) } noexcept -> std::same_as<Read>;
  { link.write(sent, timeout) } noexcept -> std::same_as<bool>;
  { link.close() } noexcept;
};

/// A socket that carries `struct can_frame`: SocketCAN, or one end of a pair for tests.
class FrameSocket {
 public:
  /// An interface of the kernel, such as `can0` or `vcan0`, which is up. Throws `ConnectionError`.
  [[nodiscard]] static FrameSocket open(const std::string& interface);
  /// One end of a `socketpair` of datagrams.
  [[nodiscard]] static FrameSocket of(Descriptor fd) noexcept { return FrameSocket(std::move(fd)); }
  /// Both ends of a new pair. Throws `ConnectionError`.
  [[nodiscard]] static std::array<FrameSocket, 2> pair();

  Read read(Frame& frame, Deadline deadline) noexcept;
  bool write(const Frame& frame, Timeout timeout) noexcept;
  void close() noexcept { fd_.close(); }
  [[nodiscard]] int handle() const noexcept { return fd_.get(); }

 private:
  explicit FrameSocket(Descriptor fd) noexcept : fd_(std::move(fd)) {}
  Descriptor fd_;
};

/// Frames as slcan writes them: `tIIIL..` data, `rIIIL` remote requests, a carriage return behind each.
class SlcanCodec {
 public:
  /// The characters of `frame`, with the carriage return.
  static std::size_t write(const Frame& frame, std::span<char, 32> to) noexcept;
  /// Takes characters one by one; the frame that this one completes. Lines of other kinds (extended frames,
  /// answers, nonsense) give nothing; `nonsense()` counts those that ought to be a frame and are none.
  std::optional<Frame> take(char c) noexcept;
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return nonsense_; }

 private:
  std::optional<Frame> line() noexcept;
  std::array<char, 32> line_{};
  std::size_t size_ = 0;
  bool too_long_ = false;
  std::uint64_t nonsense_ = 0;
};

/// A slcan adapter at a serial line, or at a pseudo-terminal.
class SlcanLink {
 public:
  /// Opens the line, sets the bus to 1 Mbit/s and opens the channel. Throws `ConnectionError`.
  [[nodiscard]] static SlcanLink open(const std::string& device);
  /// The adapter's end of a line (a simulation's): nothing is set up.
  [[nodiscard]] static SlcanLink of(Descriptor fd) noexcept { return SlcanLink(std::move(fd)); }
  SlcanLink(SlcanLink&&) = default;
  SlcanLink& operator=(SlcanLink&&) = default;

  Read read(Frame& frame, Deadline deadline) noexcept;
  bool write(const Frame& frame, Timeout timeout) noexcept;
  void close() noexcept;
  [[nodiscard]] int handle() const noexcept { return fd_.get(); }
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return codec_.nonsense(); }

 private:
  explicit SlcanLink(Descriptor fd) noexcept : fd_(std::move(fd)) {}
  bool write_all(std::span<const char> text, Timeout timeout) noexcept;
  Descriptor fd_;
  SlcanCodec codec_;
  std::array<char, 256> buffer_{};
  std::size_t at_ = 0, end_ = 0;
  bool opened_ = false;  ///< by us: to be closed by us
};

}  // namespace adapters::can
