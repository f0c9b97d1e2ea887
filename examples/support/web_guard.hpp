// Keeps web pages away from ports that speak lines of text.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace examples {

/// Looks at the first bytes of a connection: any web page can open a connection to a port of this computer
/// and send a text in the body of a request, which a protocol of lines would take for commands.
class WebGuard {
 public:
  /// True: `bytes`, the next of the connection, make what came so far the beginning of an HTTP request (a
  /// method in capitals and a path, a URL or an asterisk) or of a TLS handshake. Nothing of them may be used.
  [[nodiscard]] bool refuses(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t b : bytes) {
      if (decided_) break;
      decided_ = decide(static_cast<char>(b));
    }
    return refused_;
  }

 private:
  /// Whether the next character is the last that is needed.
  bool decide(char c) {
    constexpr char tls_handshake = 0x16;
    if (blank_) {
      target_ += c;
      constexpr std::string_view url = "http";
      refused_ = target_ == "/" || target_ == "*" || target_ == url;
      return refused_ || !url.starts_with(target_);
    }
    refused_ = first_ && c == tls_handshake;
    blank_ = !first_ && c == ' ';
    first_ = false;
    return refused_ || (!blank_ && (c < 'A' || c > 'Z'));
  }

  std::string target_;
  bool first_ = true, blank_ = false, decided_ = false, refused_ = false;
};

}  // namespace examples
