#include "examples/adapters/skin/lights.hpp"

#include <algorithm>
#include <cstring>

#include "skinctl/core/contract.hpp"

namespace adapters::skin {
namespace {

template <class T>
void write_number(std::span<std::uint8_t> into, std::size_t at, T value) noexcept {
  for (std::size_t k = 0; k < sizeof(T); ++k) into[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
}
template <class T>
T read_number(std::span<const std::uint8_t> from, std::size_t at) noexcept {
  T value = 0;
  for (std::size_t k = sizeof(T); k > 0; --k) value = static_cast<T>(value << 8 | from[at + k - 1]);
  return value;
}
bool has_magic(std::span<const std::uint8_t> bytes, const char* magic) noexcept {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), magic, 4) == 0;
}

}  // namespace

Picture Picture::of(std::span<const std::uint32_t> lit, std::uint64_t number) {
  Picture out;
  out.number = number;
  if (lit.empty()) return out;
  const auto [lowest, highest] = std::minmax_element(lit.begin(), lit.end());
  skinctl::require(*highest - *lowest < most, "lights: distance of the ids of cells",
                   double(*highest - *lowest), "up to 8191");
  out.first = *lowest;
  out.count = static_cast<std::uint16_t>(*highest - *lowest + 1);
  for (const std::uint32_t id : lit) {
    std::uint8_t& byte = out.bits[(id - out.first) / 8];
    byte = static_cast<std::uint8_t>(byte | 1u << ((id - out.first) % 8));
  }
  return out;
}

std::size_t write_picture(std::span<std::uint8_t> into, const Picture& picture, bool sealed) noexcept {
  std::memcpy(into.data(), "SKIL", 4);
  write_number(into, 4, std::uint16_t(sealed));
  write_number(into, 6, picture.count);
  write_number(into, 8, picture.number);
  write_number(into, 16, picture.first);
  const std::size_t size = (std::size_t(picture.count) + 7) / 8;
  std::copy_n(picture.bits.begin(), size, into.begin() + Picture::header);
  return Picture::header + size;
}

bool parse_picture(std::span<const std::uint8_t> bytes, const Key* key, Picture& out) noexcept {
  if (!has_magic(bytes, "SKIL") || bytes.size() < Picture::header) return false;
  const auto count = read_number<std::uint16_t>(bytes, 6);
  const std::size_t size = (std::size_t(count) + 7) / 8;
  if (read_number<std::uint16_t>(bytes, 4) != (key != nullptr) || count > Picture::most ||
      bytes.size() != Picture::header + size + (key != nullptr ? tag_size : 0))
    return false;
  if (count % 8 != 0 && bytes[Picture::header + size - 1] >> (count % 8) != 0) return false;
  if (key != nullptr && !key->made(Sealed::lights, bytes)) return false;
  const auto first = read_number<std::uint32_t>(bytes, 16);
  if (first + count < first) return false;  // ids end before the row does
  out = {};
  out.number = read_number<std::uint64_t>(bytes, 8), out.first = first, out.count = count;
  std::copy_n(bytes.begin() + Picture::header, size, out.bits.begin());
  return true;
}

ShownBytes shown_datagram(std::uint64_t number) noexcept {
  ShownBytes out{'S', 'K', 'I', 'A'};
  write_number(std::span(out), 4, number);
  return out;
}

std::optional<std::uint64_t> parse_shown(std::span<const std::uint8_t> bytes, const Key* key) noexcept {
  if (!has_magic(bytes, "SKIA") || bytes.size() != ShownBytes().size() + (key != nullptr ? tag_size : 0) ||
      (key != nullptr && !key->made(Sealed::lights, bytes)))
    return std::nullopt;
  return read_number<std::uint64_t>(bytes, 4);
}

}  // namespace adapters::skin
