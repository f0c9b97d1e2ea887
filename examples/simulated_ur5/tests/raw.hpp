// Raw sockets and bytes for the tests: written from the protocols, sharing no code with the simulator.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace raw {

using Bytes = std::vector<std::uint8_t>;

inline Bytes bytes(std::string_view text) {
  return Bytes(text.begin(), text.end());
}

inline void put(Bytes& out, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
inline void put_double(Bytes& out, double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, 8);
  put(out, bits, 8);
}
inline std::uint64_t take(const Bytes& in, std::size_t at, std::size_t size) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < size; ++i) v = v << 8 | in.at(at + i);
  return v;
}
inline double take_double(const Bytes& in, std::size_t at) {
  const std::uint64_t bits = take(in, at, 8);
  double v = 0;
  std::memcpy(&v, &bits, 8);
  return v;
}

/// A TCP client or an accepted connection; every read ends after `timeout` seconds.
class Tcp {
 public:
  explicit Tcp(int fd) : fd_(fd) {}
  explicit Tcp(std::uint16_t port, int receive_buffer = 0) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("cannot connect to port " + std::to_string(port));
    const int on = 1;
    ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  Tcp(Tcp&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  Tcp& operator=(Tcp&&) = delete;
  ~Tcp() { close(); }

  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  bool send(const Bytes& b) const {
    std::size_t at = 0;
    while (at < b.size()) {
      const auto n = ::send(fd_, b.data() + at, b.size() - at, MSG_NOSIGNAL);
      if (n <= 0) return false;
      at += static_cast<std::size_t>(n);
    }
    return true;
  }
  bool send(std::string_view text) const { return send(bytes(text)); }

  /// At most `most` bytes; empty at the end of the stream or after the timeout (then `timed_out`).
  Bytes receive(std::size_t most, double timeout = 5) {
    timed_out = false;
    pollfd p{fd_, POLLIN, 0};
    if (::poll(&p, 1, static_cast<int>(timeout * 1000)) <= 0) {
      timed_out = true;
      return {};
    }
    Bytes b(most);
    const auto n = ::recv(fd_, b.data(), most, 0);
    b.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return b;
  }
  /// Exactly `size` bytes, or throws.
  Bytes exactly(std::size_t size, double timeout = 5) {
    Bytes all;
    while (all.size() < size) {
      const Bytes part = receive(size - all.size(), timeout);
      if (part.empty()) throw std::runtime_error(timed_out ? "nothing came" : "the peer closed");
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  }
  std::string line(double timeout = 5) {
    std::string text;
    for (;;) {
      const char c = static_cast<char>(exactly(1, timeout)[0]);
      if (c == '\n') return text;
      text.push_back(c);
    }
  }
  /// True if the peer closes within the timeout, whatever it sends before.
  bool closes(double timeout = 5) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
    while (std::chrono::steady_clock::now() < until) {
      const Bytes b = receive(4096, 0.1);
      if (b.empty() && !timed_out) return true;
    }
    return false;
  }

  bool timed_out = false;

 private:
  int fd_;
};

/// A TCP server on an ephemeral port of loopback.
class Listener {
 public:
  Listener() : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 || ::listen(fd_, 4) != 0)
      throw std::runtime_error("cannot listen");
    socklen_t size = sizeof at;
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&at), &size);
    port = ntohs(at.sin_port);
  }
  ~Listener() { ::close(fd_); }
  Tcp accept(double timeout = 5) const {
    pollfd p{fd_, POLLIN, 0};
    if (::poll(&p, 1, static_cast<int>(timeout * 1000)) <= 0) throw std::runtime_error("nobody connected");
    const int fd = ::accept(fd_, nullptr, nullptr);
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return Tcp(fd);
  }
  std::uint16_t port = 0;

 private:
  int fd_;
};

/// A UDP receiver on an ephemeral port of loopback.
class Udp {
 public:
  Udp() : fd_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
      throw std::runtime_error("cannot bind");
    socklen_t size = sizeof at;
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&at), &size);
    port = ntohs(at.sin_port);
  }
  ~Udp() { ::close(fd_); }
  std::optional<Bytes> receive(double timeout) const {
    pollfd p{fd_, POLLIN, 0};
    if (::poll(&p, 1, static_cast<int>(timeout * 1000)) <= 0) return std::nullopt;
    Bytes b(4096);
    const auto n = ::recv(fd_, b.data(), b.size(), 0);
    b.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return b;
  }
  std::uint16_t port = 0;

 private:
  int fd_;
};

// ---- RTDE by hand
// -------------------------------------------------------------------------------------------------

inline Bytes package(char type, const Bytes& payload = {}) {
  Bytes out;
  put(out, payload.size() + 3, 2);
  out.push_back(static_cast<std::uint8_t>(type));
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}
inline Bytes version_request(std::uint16_t version) {
  Bytes payload;
  put(payload, version, 2);
  return package('V', payload);
}
inline Bytes outputs_request(double frequency, std::string_view names) {
  Bytes payload;
  put_double(payload, frequency);
  for (char c : names) payload.push_back(static_cast<std::uint8_t>(c));
  return package('O', payload);
}

struct Package {
  char type = 0;
  Bytes payload;
  std::string text(std::size_t from = 0) const {
    return std::string(payload.begin() + static_cast<std::ptrdiff_t>(from), payload.end());
  }
};

inline Package read_package(Tcp& tcp, double timeout = 5) {
  const Bytes header = tcp.exactly(3, timeout);
  const std::size_t size = take(header, 0, 2);
  if (size < 3) throw std::runtime_error("package size below 3");
  return {static_cast<char>(header[2]), tcp.exactly(size - 3, timeout)};
}
/// The next package of a type; others (data, texts) are passed over.
inline Package read_until(Tcp& tcp, char type, double timeout = 5) {
  for (int i = 0; i < 100000; ++i) {
    Package p = read_package(tcp, timeout);
    if (p.type == type) return p;
  }
  throw std::runtime_error("the package did not come");
}

/// An RTDE client that has negotiated version 2 and set its outputs.
inline Tcp rtde_client(std::uint16_t port, double frequency, std::string_view outputs) {
  Tcp tcp(port);
  tcp.send(version_request(2));
  if (read_until(tcp, 'V').payload != Bytes{1}) throw std::runtime_error("version 2 refused");
  tcp.send(outputs_request(frequency, outputs));
  if (read_until(tcp, 'O').payload.at(0) == 0) throw std::runtime_error("outputs refused");
  return tcp;
}
inline void start(Tcp& tcp) {
  tcp.send(package('S'));
  if (read_until(tcp, 'S').payload != Bytes{1}) throw std::runtime_error("start refused");
}

// ---- the reverse socket by hand
// -------------------------------------------------------------------------------------

inline Bytes reverse_message(std::int32_t timeout_ms, const std::array<double, 6>& values,
                             std::int32_t mode) {
  Bytes out;
  put(out, static_cast<std::uint32_t>(timeout_ms), 4);
  for (double v : values) {
    const double scaled = v * 1e6;
    const auto whole = static_cast<std::int32_t>(scaled + (scaled < 0 ? -0.5 : 0.5));
    put(out, static_cast<std::uint32_t>(whole), 4);
  }
  put(out, static_cast<std::uint32_t>(mode), 4);
  return out;
}

/// A program such as a PC uploads: connects back, reads 8 integers, servos or speeds.
inline std::string stream_program(std::uint16_t port) {
  return "def stream():\n"
         "  # comment with an end and a socket_open(\"10.0.0.1\", 1, \"reverse_socket\")\n"
         "  steptime = get_steptime()\n"
         "  MULT = 1000000\n"
         "  global cmd = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n"
         "  global mode = 0\n"
         "  thread servo_thread():\n"
         "    while mode == 1:\n"
         "      servoj(cmd, t=steptime, lookahead_time=0.03, gain=2000)\n"
         "    end\n"
         "    stopj(4.0)\n"
         "  end\n"
         "  thread speed_thread():\n"
         "    while mode == 2:\n"
         "      speedj(cmd, 40.0, steptime)\n"
         "    end\n"
         "    stopj(4.0)\n"
         "  end\n"
         "  if not socket_open(\"127.0.0.1\", " +
         std::to_string(port) +
         ", \"reverse_socket\"):\n"
         "    halt\n"
         "  end\n"
         "  timeout = 0.0\n"
         "  motion = 0\n"
         "  moving = False\n"
         "  while mode != -2:\n"
         "    params = socket_read_binary_integer(1+6+1, \"reverse_socket\", timeout)\n"
         "    if params[0] == 0:\n"
         "      mode = -2\n"
         "    else:\n"
         "      timeout = params[1] / 1000.0\n"
         "      cmd = [params[2]/MULT, params[3]/MULT, params[4]/MULT, params[5]/MULT, params[6]/MULT, "
         "params[7]/MULT]\n"
         "      if params[8] != mode:\n"
         "        mode = params[8]\n"
         "        if moving:\n"
         "          join motion\n"
         "        end\n"
         "        moving = mode == 1 or mode == 2\n"
         "        if mode == 1:\n"
         "          motion = run servo_thread()\n"
         "        elif mode == 2:\n"
         "          motion = run speed_thread()\n"
         "        end\n"
         "      end\n"
         "    end\n"
         "  end\n"
         "  stopj(4.0)\n"
         "  socket_close(\"reverse_socket\")\n"
         "end\n";
}

}  // namespace raw
