// One RTDE connection as a client: negotiation, recipes, packages.
#pragma once

#include <string>

#include "examples/adapters/socket.hpp"
#include "examples/adapters/ur5/rtde.hpp"
#include "examples/adapters/ur5/version.hpp"

namespace adapters::ur5 {

/// Why no package came.
enum class RtdeEnd : unsigned char { none, time_over, closed, nonsense };

/// Speaks version 2. What can fail before the loop throws `ConnectionError`; `read` does not throw.
class RtdeClient {
 public:
  /// Connects, agrees on version 2 and asks for the controller's version.
  void connect(const std::string& host, std::uint16_t port, Timeout timeout);
  /// Subscribes; the recipe's number. `types`: those expected; the error names the outputs that differ.
  std::uint8_t outputs(double rate, const std::string& names, const std::string& types);
  /// Registers inputs; the recipe's number. Those that another client holds, and unknown ones, are named in
  /// the error.
  std::uint8_t inputs(const std::string& names);
  void start();
  /// The next package, waiting at most `timeout`.
  RtdeEnd read(Package& package, Timeout timeout) noexcept;
  /// One that has arrived whole already.
  std::optional<Package> next() noexcept { return framer_.next(); }
  bool write(std::span<const std::uint8_t> bytes, Timeout timeout) noexcept {
    return stream_.write(bytes, timeout);
  }
  void close() noexcept { stream_.close(); }

  [[nodiscard]] const Version& version() const noexcept { return version_; }
  /// The newest text that the controller sent over RTDE.
  [[nodiscard]] const std::string& said() const noexcept { return said_; }
  /// Keeps a text package.
  void hear(std::span<const std::uint8_t> payload);

 private:
  Package ask(PackageWriter& question, std::uint8_t type, const char* what);

  Stream stream_;
  Framer framer_;
  Version version_;
  Timeout timeout_{};
  std::string said_;
};

}  // namespace adapters::ur5
