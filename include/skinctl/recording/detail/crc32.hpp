// SPDX-License-Identifier: BSD-3-Clause
// The CRC-32 of MCAP, zip and Ethernet: reflected polynomial 0xedb88320, eight bytes a step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

using Crc32Tables = std::array<std::array<std::uint32_t, 256>, 8>;
constexpr Crc32Tables crc32_tables() noexcept {
  Crc32Tables t{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    t[0][i] = c;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t i = 0; i < 256; ++i) t[k][i] = t[0][t[k - 1][i] & 0xff] ^ (t[k - 1][i] >> 8);
  return t;
}

/// The CRC of bytes, or of bytes that follow others of CRC `before`.
[[nodiscard]] inline std::uint32_t crc32(std::span<const unsigned char> bytes,
                                         std::uint32_t before = 0) noexcept {
  static constexpr Crc32Tables t = crc32_tables();
  std::uint32_t c = ~before;
  while (bytes.size() >= 8) {
    std::uint32_t low = 0, high = 0;
    std::memcpy(&low, bytes.data(), 4);
    std::memcpy(&high, bytes.data() + 4, 4);
    low ^= c;
    c = t[7][low & 0xff] ^ t[6][(low >> 8) & 0xff] ^ t[5][(low >> 16) & 0xff] ^ t[4][low >> 24] ^
        t[3][high & 0xff] ^ t[2][(high >> 8) & 0xff] ^ t[1][(high >> 16) & 0xff] ^ t[0][high >> 24];
    bytes = bytes.subspan(8);
  }
  for (const unsigned char b : bytes) c = t[0][(c ^ b) & 0xff] ^ (c >> 8);
  return ~c;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
