// Datagrams that only who holds a key can make: version 2 of PROTOCOL.md. Needs libsodium; without it a key is
// refused.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace adapters::skin {

inline constexpr std::size_t session_size = 8, tag_size = 16;
/// Samples of a sealed datagram: one less, so that it fits into one Ethernet frame as well.
inline constexpr std::size_t max_sealed_samples = 32;

/// The secret of a sender and its receiver: 32 bytes. Its memory is wiped at the end.
class Key {
 public:
  static constexpr std::size_t size = 32;

  /// Throws `ConfigurationError` where the program was built without libsodium, naming the package.
  explicit Key(std::span<const std::uint8_t, size> bytes);
  /// Reads 64 hexadecimal digits. Throws `ConfigurationError` for a file that cannot be read, that others than
  /// its owner may read or write, or that holds anything else.
  static Key read(const std::string& file);
  Key(const Key&) = default;
  Key& operator=(const Key&) = default;
  ~Key();

  /// BLAKE2b of `bytes` with this key.
  [[nodiscard]] std::array<std::uint8_t, tag_size> tag(std::span<const std::uint8_t> bytes) const noexcept;
  /// Whether the last `tag_size` bytes are the tag of those before; takes as long wherever they differ.
  [[nodiscard]] bool made(std::span<const std::uint8_t> datagram) const noexcept;

 private:
  std::array<std::uint8_t, size> bytes_{};
};

/// Turns a datagram of version 1 with at most `max_sealed_samples` samples, the first `size` bytes of
/// `buffer`, into one of version 2, and returns its size; 0 where the buffer or the datagram does not allow
/// it. A sender takes a greater session at each start and whenever its sequence numbers are used up.
[[nodiscard]] std::size_t seal(std::span<std::uint8_t> buffer, std::size_t size, std::uint64_t session,
                               const Key& key) noexcept;

/// A session for a sender that starts now: nanoseconds since 1970.
[[nodiscard]] std::uint64_t session_now() noexcept;

}  // namespace adapters::skin
