#include "examples/adapters/can/link.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "examples/adapters/serial.hpp"

namespace adapters::can {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& what) {
  throw ConnectionError(what + ": " + std::strerror(errno));
}

void set_non_blocking(int fd) noexcept {
  const int flags = ::fcntl(fd, F_GETFL, 0);
  if (flags >= 0) static_cast<void>(::fcntl(fd, F_SETFL, flags | O_NONBLOCK));
}

/// The value of a hexadecimal digit, or 16.
unsigned digit(char c) noexcept {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A') + 10;
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a') + 10;
  return 16;
}

}  // namespace

void Descriptor::close() noexcept {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

bool wait_for(int fd, short events, Deadline deadline) noexcept {
  for (;;) {
    const auto left = std::max(Clock::duration(0), deadline - Clock::now());
    const auto s = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec time{s.count(), std::chrono::nanoseconds(left - s).count()};
    pollfd entry{fd, events, 0};
    const int n = ::ppoll(&entry, 1, &time, nullptr);
    if (n > 0) return true;
    if (n == 0 || errno != EINTR) return false;
    if (Clock::now() >= deadline) return false;
  }
}

FrameSocket FrameSocket::open(const std::string& interface) {
  Descriptor fd(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
  if (fd.get() < 0) fail("this kernel has no CAN sockets (use an slcan adapter's tty instead)");
  ifreq request{};
  if (interface.empty() || interface.size() >= sizeof request.ifr_name) {
    errno = ENODEV;
    fail("CAN interface '" + interface + "'");
  }
  std::memcpy(request.ifr_name, interface.c_str(), interface.size() + 1);
  if (::ioctl(fd.get(), SIOCGIFINDEX, &request) < 0) fail("CAN interface '" + interface + "'");
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0)
    fail("CAN interface '" + interface + "'");
  set_non_blocking(fd.get());
  return FrameSocket(std::move(fd));
}

std::array<FrameSocket, 2> FrameSocket::pair() {
  int fds[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, fds) < 0) fail("socketpair");
  set_non_blocking(fds[0]);
  set_non_blocking(fds[1]);
  return {FrameSocket(Descriptor(fds[0])), FrameSocket(Descriptor(fds[1]))};
}

Read FrameSocket::read(Frame& frame, Deadline deadline) noexcept {
  for (;;) {
    can_frame raw{};
    const auto n = ::recv(fd_.get(), &raw, sizeof raw, 0);
    if (n == 0) return Read::closed;
    if (n < 0) {
      // A pair's other end that was closed with frames unread says so once; what it has sent is still there.
      if (errno == EINTR || errno == ECONNRESET) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK) return Read::closed;
      if (!wait_for(fd_.get(), POLLIN, deadline)) return Read::nothing;
      continue;
    }
    const bool other = (raw.can_id & (CAN_EFF_FLAG | CAN_ERR_FLAG)) != 0;
    if (n != sizeof raw || other || raw.can_dlc > 8) {
      if (Clock::now() >= deadline) return Read::nothing;
      continue;
    }
    frame.id = static_cast<std::uint16_t>(raw.can_id & CAN_SFF_MASK);
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.size = frame.remote ? std::uint8_t(0) : raw.can_dlc;
    frame.data = {};
    std::memcpy(frame.data.data(), raw.data, frame.size);
    return Read::some;
  }
}

bool FrameSocket::write(const Frame& frame, Timeout timeout) noexcept {
  can_frame raw{};
  raw.can_id = static_cast<canid_t>(frame.id & CAN_SFF_MASK) | (frame.remote ? CAN_RTR_FLAG : 0u);
  raw.can_dlc = std::min<std::uint8_t>(frame.size, 8);
  std::memcpy(raw.data, frame.data.data(), raw.can_dlc);
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    const auto n = ::send(fd_.get(), &raw, sizeof raw, MSG_NOSIGNAL);
    if (n == sizeof raw) return true;
    if (n >= 0) return false;
    if (errno == EINTR) continue;
    // A full queue of the interface is ENOBUFS, and poll does not wait for it.
    const bool full = errno == ENOBUFS;
    if (!full && errno != EAGAIN && errno != EWOULDBLOCK) return false;
    if (Clock::now() >= deadline) return false;
    if (full) {
      ::usleep(100);
    } else if (!wait_for(fd_.get(), POLLOUT, deadline)) {
      return false;
    }
  }
}

std::size_t SlcanCodec::write(const Frame& f, std::span<char, 32> to) noexcept {
  constexpr char hex[] = "0123456789ABCDEF";
  const std::size_t size = f.size < 8 ? f.size : 8;
  std::size_t n = 0;
  to[n++] = f.remote ? 'r' : 't';
  for (int shift = 8; shift >= 0; shift -= 4) to[n++] = hex[(f.id >> shift) & 0xf];
  to[n++] = hex[size];
  for (std::size_t i = 0; !f.remote && i < size; ++i) {
    to[n++] = hex[f.data[i] >> 4];
    to[n++] = hex[f.data[i] & 0xf];
  }
  to[n++] = '\r';
  return n;
}

std::optional<Frame> SlcanCodec::take(char c) noexcept {
  if (c == '\r' || c == '\a' || c == '\n') {
    std::optional<Frame> out;
    if (too_long_) {
      ++nonsense_;
    } else if (size_ > 0 && (line_[0] == 't' || line_[0] == 'r')) {
      out = line();
      if (!out) ++nonsense_;
    }
    size_ = 0;
    too_long_ = false;
    return out;
  }
  if (size_ < line_.size()) {
    line_[size_++] = c;
  } else {
    too_long_ = true;
  }
  return std::nullopt;
}

std::optional<Frame> SlcanCodec::line() noexcept {
  if (size_ < 5) return std::nullopt;
  Frame f;
  f.remote = line_[0] == 'r';
  unsigned id = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    const unsigned d = digit(line_[i]);
    if (d > 15) return std::nullopt;
    id = id * 16 + d;
  }
  const unsigned size = digit(line_[4]);
  if (id > 0x7ff || size > 8) return std::nullopt;
  f.id = static_cast<std::uint16_t>(id);
  if (f.remote) return f;
  f.size = static_cast<std::uint8_t>(size);
  const std::size_t end = 5 + 2 * std::size_t(size);
  if (size_ != end && size_ != end + 4) return std::nullopt;  // adapters may add a time stamp of four digits
  for (std::size_t i = 0; i < size; ++i) {
    const unsigned high = digit(line_[5 + 2 * i]), low = digit(line_[6 + 2 * i]);
    if (high > 15 || low > 15) return std::nullopt;
    f.data[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  return f;
}

SlcanLink SlcanLink::open(const std::string& device) {
  SlcanLink link(open_serial(device, 1'000'000));
  // Closed first: an adapter that was left open refuses to change its speed.
  constexpr std::string_view set_up = "\rC\rS8\rO\r";
  if (!link.write_all({set_up.data(), set_up.size()}, Timeout(500)))
    throw ConnectionError("the slcan adapter at '" + device + "' takes no characters");
  link.opened_ = true;
  return link;
}

Read SlcanLink::read(Frame& frame, Deadline deadline) noexcept {
  for (bool looked = false;; looked = true) {
    while (at_ < end_) {
      if (const auto whole = codec_.take(buffer_[at_++])) {
        frame = *whole;
        return Read::some;
      }
    }
    if (looked && Clock::now() >= deadline) return Read::nothing;  // whatever it floods us with
    at_ = 0;
    const Read read =
        read_some(fd_, {reinterpret_cast<std::uint8_t*>(buffer_.data()), buffer_.size()}, end_, deadline);
    if (read != Read::some) return read;
  }
}

bool SlcanLink::write_all(std::span<const char> text, Timeout timeout) noexcept {
  const auto deadline = Clock::now() + timeout;
  while (!text.empty()) {
    const auto n = ::write(fd_.get(), text.data(), text.size());
    if (n > 0) {
      text = text.subspan(static_cast<std::size_t>(n));
    } else if (n < 0 && errno == EINTR) {
      if (Clock::now() >= deadline) return false;
    } else if (n == 0 || errno == EAGAIN || errno == EWOULDBLOCK) {
      if (Clock::now() >= deadline || !wait_for(fd_.get(), POLLOUT, deadline)) return false;
    } else {
      return false;
    }
  }
  return true;
}

bool SlcanLink::write(const Frame& frame, Timeout timeout) noexcept {
  std::array<char, 32> text{};
  const std::size_t n = SlcanCodec::write(frame, text);
  return write_all({text.data(), n}, timeout);
}

void SlcanLink::close() noexcept {
  if (opened_) static_cast<void>(write_all({"C\r", 2}, Timeout(50)));
  opened_ = false;
  fd_.close();
}

}  // namespace adapters::can
