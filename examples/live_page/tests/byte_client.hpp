// A client of the live view's server, for tests: it knows HTTP and WebSocket frames by their documents only.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "examples/adapters/socket.hpp"

namespace live_page {

using adapters::Read;
using adapters::Stream;
using adapters::Timeout;
using nlohmann::json;
using namespace std::chrono_literals;

/// A client that knows HTTP and WebSocket frames by their documents (RFC 7230, 6455) only, byte by byte.
struct Client {
  Stream stream;
  std::vector<std::uint8_t> in;

  explicit Client(std::uint16_t port) { stream.connect("127.0.0.1", port, "server", 2000ms); }
  bool send(const std::string& text) {
    return stream.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, 2000ms);
  }
  bool more(Timeout wait) {
    std::uint8_t part[65536];
    std::size_t n = 0;
    const Read read = stream.read_some(part, n, wait);
    in.insert(in.end(), part, part + n);
    return read != Read::closed;
  }
  /// Head and, of a file, body of a reply.
  std::string reply(bool whole = false) {
    const auto late = std::chrono::steady_clock::now() + 10s;
    for (bool open = true; std::chrono::steady_clock::now() < late;) {
      const std::string text(in.begin(), in.end());
      const auto end = text.find("\r\n\r\n");
      if (end != std::string::npos && !whole) {
        in.erase(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(end + 4));
        return text.substr(0, end);
      }
      if (!open) return text;
      open = more(100ms);
    }
    return {};
  }
  static std::string get(const std::string& path, const std::string& host, const std::string& more = {}) {
    return "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + more + "\r\n";
  }
  static std::string upgrade(const std::string& protocol, const std::string& more = {}) {
    return "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
           "dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           (protocol.empty() ? "" : "Sec-WebSocket-Protocol: " + protocol + "\r\n") + more;
  }
  /// A masked frame, as clients send them.
  bool frame(int op, const std::string& payload) {
    std::string out{static_cast<char>(0x80 | op)};
    if (payload.size() < 126) {
      out += static_cast<char>(0x80 | payload.size());
    } else {
      out += static_cast<char>(0x80 | 126);
      out += static_cast<char>(payload.size() >> 8);
      out += static_cast<char>(payload.size() & 0xff);
    }
    const char mask[4] = {1, 2, 3, 4};
    out.append(mask, 4);
    for (std::size_t i = 0; i < payload.size(); ++i) out += static_cast<char>(payload[i] ^ mask[i % 4]);
    return send(out);
  }
  bool say(const json& text) { return frame(1, text.dump()); }
  struct Frame {
    int op = 0;
    std::string payload;
  };
  std::optional<Frame> next(Timeout wait = 10s) {
    const auto late = std::chrono::steady_clock::now() + wait;
    for (;;) {
      if (in.size() >= 2) {
        const std::size_t code = in[1] & 0x7f;
        std::size_t length = code, head = 2;
        if (code == 126 && in.size() >= 4) length = std::size_t(in[2]) << 8 | in[3], head = 4;
        if (code == 127 && in.size() >= 10) {
          length = 0, head = 10;
          for (std::size_t i = 2; i < 10; ++i) length = length << 8 | in[i];
        }
        if (code < 126 || head > 2)
          if (in.size() >= head + length) {
            Frame f{in[0] & 0x0f, std::string(in.begin() + std::ptrdiff_t(head),
                                              in.begin() + std::ptrdiff_t(head + length))};
            in.erase(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(head + length));
            return f;
          }
      }
      if (std::chrono::steady_clock::now() > late || !more(50ms)) return {};
    }
  }
  /// The next text with this op; binary ones before it are kept in `data`.
  json text(const std::string& op) {
    for (;;) {
      const auto f = next();
      if (!f) return {};
      if (f->op == 2) data.push_back(f->payload);
      if (f->op != 1) continue;
      const json m = json::parse(f->payload);
      if (m["op"] == op) return m;
    }
  }
  std::string binary() {
    if (!data.empty()) {
      const std::string first = data.front();
      data.erase(data.begin());
      return first;
    }
    for (;;) {
      const auto f = next();
      if (!f) return {};
      if (f->op == 2) return f->payload;
    }
  }
  std::vector<std::string> data;
};

/// The call number `call` of a service without arguments.
inline std::string call_of(std::uint32_t service, std::uint32_t call, const std::string& encoding = "cdr") {
  std::string out(13, '\0');
  out[0] = 2;
  const auto length = static_cast<std::uint32_t>(encoding.size());
  std::memcpy(out.data() + 1, &service, 4), std::memcpy(out.data() + 5, &call, 4),
      std::memcpy(out.data() + 9, &length, 4);
  return out + encoding + std::string("\0\1\0\0\0", 5);
}

}  // namespace live_page
