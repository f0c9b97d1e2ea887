#include "examples/adapters/skin/icub_can.hpp"

#include <algorithm>

namespace adapters::skin {
namespace {
constexpr std::uint8_t first_part = 0x40, second_part = 0xc0;
}

std::optional<IcubFrame> parse_icub(std::uint32_t identifier, std::span<const std::uint8_t> data) noexcept {
  if ((identifier & ~0xffu) != 0x300 || data.empty()) return std::nullopt;
  IcubFrame out;
  out.board = identifier >> 4 & 15;
  out.triangle = identifier & 15;
  out.first = data[0] == first_part ? 0 : 7;
  out.count = data[0] == first_part ? 7 : 5;
  if ((data[0] != first_part && data[0] != second_part) || data.size() < 1 + out.count || data.size() > 8)
    return std::nullopt;
  std::copy_n(data.begin() + 1, out.count, out.raw.begin());
  return out;
}

std::array<std::uint8_t, 8> icub_data(const IcubFrame& frame) noexcept {
  std::array<std::uint8_t, 8> out{frame.first == 0 ? first_part : second_part};
  std::copy_n(frame.raw.begin(), std::min<std::size_t>(frame.count, 7), out.begin() + 1);
  return out;
}

skinctl::CellSample IcubFrame::sample(std::size_t k, skinctl::Nanoseconds time) const noexcept {
  skinctl::CellSample out;
  out.time = time;
  out.cell = icub_taxels_of_a_board * board + icub_taxels_of_a_triangle * triangle + first +
             static_cast<std::uint32_t>(k);
  out.force[0] = static_cast<float>(255 - raw[k]) / 255.0f;
  return out;
}

}  // namespace adapters::skin
