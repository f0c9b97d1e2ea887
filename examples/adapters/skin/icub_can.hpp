// The skin of the iCub on CAN: triangles of 12 taxels, two frames each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "skinctl/sensing/cell_sample.hpp"

namespace adapters::skin {

/// One frame: taxels 0 to 6 (first byte 0x40) or 7 to 11 (0xc0) of a triangle.
struct IcubFrame {
  std::uint32_t board = 0;     ///< 0 to 15, bits 4 to 7 of the identifier
  std::uint32_t triangle = 0;  ///< 0 to 15, bits 0 to 3
  std::uint32_t first = 0, count = 0;
  std::array<std::uint8_t, 7> raw{};  ///< 255 untouched, less when pressed

  /// Taxel `k` < count as a cell of one force sensor: its id is `192 board + 12 triangle + taxel`, its
  /// reading (255 - raw) / 255. Untouched taxels rest a little above 0, each elsewhere: see `RestLevel`.
  [[nodiscard]] skinctl::CellSample sample(std::size_t k, skinctl::Nanoseconds time) const noexcept;
};
inline constexpr std::uint32_t icub_taxels_of_a_triangle = 12, icub_taxels_of_a_board = 192;

/// Nothing for a frame of another class (identifier & 0x700 is not 0x300), or one that is too short.
[[nodiscard]] std::optional<IcubFrame> parse_icub(std::uint32_t identifier,
                                                  std::span<const std::uint8_t> data) noexcept;
/// The bytes of such a frame, for simulations; the last two of the second are error flags, none set.
[[nodiscard]] std::array<std::uint8_t, 8> icub_data(const IcubFrame& frame) noexcept;
[[nodiscard]] constexpr std::uint32_t icub_identifier(const IcubFrame& frame) noexcept {
  return 0x300 | (frame.board & 15) << 4 | (frame.triangle & 15);
}

}  // namespace adapters::skin
