// The code by which a cell's light says in a row of images whose it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace camera {

/// A light is on in one image of each pair: in the first for a 1, in the second for a 0. So every light is
/// seen in each pair, whatever its id, and a lamp or the sun, which are on in both, are no light. Ten bits of
/// the id, lowest first, then four that check them.
struct Blinks {
  static constexpr std::size_t id_bits = 10, check_bits = 4, bits = id_bits + check_bits;
  static constexpr std::size_t images = 2 * bits;
  static constexpr std::uint16_t highest = (1u << id_bits) - 1;

  /// The id with its check, the remainder by `x^4 + x + 1`: two wrong bits, or up to four next to each other,
  /// are found.
  [[nodiscard]] static constexpr std::uint32_t code(std::uint16_t id) noexcept {
    std::uint32_t rest = std::uint32_t(id & highest) << check_bits;
    for (std::size_t k = bits; k-- > check_bits;)
      if ((rest >> k & 1u) != 0) rest ^= 0b10011u << (k - check_bits);
    return std::uint32_t(id & highest) << check_bits | rest;
  }
  /// Whether the light of `id` is on in this image.
  [[nodiscard]] static constexpr bool on(std::uint16_t id, std::size_t image) noexcept {
    return ((code(id) >> image / 2 & 1u) != 0) == (image % 2 == 0);
  }
  /// Whose light it is, of the bits that were read; none where they do not fit their check.
  [[nodiscard]] static constexpr std::optional<std::uint16_t> id(std::uint32_t read) noexcept {
    const auto found = static_cast<std::uint16_t>(read >> check_bits & highest);
    return code(found) == read ? std::optional(found) : std::nullopt;
  }
};

}  // namespace camera
