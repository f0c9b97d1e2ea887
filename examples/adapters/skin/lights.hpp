// Which lights of a skin's cells are on: pictures that a receiver wants, and answers of the sender, as
// PROTOCOL.md defines them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "examples/adapters/skin/authentication.hpp"

namespace adapters::skin {

/// Of a row of consecutive ids, which lights are on; those of all other cells are out.
struct Picture {
  static constexpr std::size_t most = 8192;  ///< cells of the row
  static constexpr std::size_t header = 20;  ///< bytes before the bits

  std::uint64_t number = 0;  ///< greater in each newer picture; 0: there was none yet
  std::uint32_t first = 0;   ///< id of the row's first cell
  std::uint16_t count = 0;   ///< cells of the row
  std::array<std::uint8_t, most / 8> bits{};

  [[nodiscard]] bool on(std::uint32_t id) const noexcept {
    const std::uint32_t i = id - first;
    return id >= first && i < count && (bits[i / 8] >> (i % 8) & 1u) != 0;
  }
  /// These lights on, under this number. Throws `ConfigurationError` for ids farther apart than a row.
  static Picture of(std::span<const std::uint32_t> lit, std::uint64_t number);
};

/// Bytes of a picture without its seal; `into` has room for `largest`.
std::size_t write_picture(std::span<std::uint8_t> into, const Picture& picture, bool sealed) noexcept;
/// With a key only what it sealed, without one only what is open; then `out` is the picture. False, and `out`
/// as it was, for all else.
[[nodiscard]] bool parse_picture(std::span<const std::uint8_t> bytes, const Key* key, Picture& out) noexcept;

/// "All lights are as the picture of this number says", without its seal.
using ShownBytes = std::array<std::uint8_t, 12>;
[[nodiscard]] ShownBytes shown_datagram(std::uint64_t number) noexcept;
/// The number of the picture that is shown; none for bytes that are no such answer of who holds the key.
[[nodiscard]] std::optional<std::uint64_t> parse_shown(std::span<const std::uint8_t> bytes,
                                                       const Key* key) noexcept;

}  // namespace adapters::skin
