// TCPROS: the header of a connection between two ROS 1 nodes, and the messages behind it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace adapters::ros1 {

using Fields = std::map<std::string, std::string, std::less<>>;

/// The fields "name=value" of a header, each with its length before it (uint32, little-endian). None where a
/// length leads out of `bytes` or a field has no name.
[[nodiscard]] std::optional<Fields> parse_fields(std::span<const std::uint8_t> bytes);
/// A header with its length, ready to send.
[[nodiscard]] std::vector<std::uint8_t> header(const Fields& fields);

/// Cuts a stream into blocks: a length (uint32, little-endian) and so many bytes. Memory grows with what has
/// arrived, never with what a length announces.
class Blocks {
 public:
  /// @param largest  a longer block breaks the stream.
  explicit Blocks(std::size_t largest) : largest_(largest) {}

  void add(std::span<const std::uint8_t> bytes) { buffer_.insert(buffer_.end(), bytes.begin(), bytes.end()); }
  /// The next whole block, valid until the next call of `add`.
  [[nodiscard]] std::optional<std::span<const std::uint8_t>> next();
  /// Forgets blocks that have been given; call it when `next` has nothing.
  void drop();
  [[nodiscard]] bool broken() const noexcept { return broken_; }
  /// What has arrived and was not given.
  [[nodiscard]] std::span<const std::uint8_t> rest() const noexcept {
    return {buffer_.data() + given_, buffer_.size() - given_};
  }

 private:
  std::size_t largest_, given_ = 0;
  std::vector<std::uint8_t> buffer_;
  bool broken_ = false;
};

}  // namespace adapters::ros1
