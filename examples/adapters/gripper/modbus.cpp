#include "examples/adapters/gripper/modbus.hpp"

namespace adapters::gripper::modbus {

std::uint16_t u16_at(std::span<const std::uint8_t> data, std::size_t at) noexcept {
  return static_cast<std::uint16_t>((data[at] << 8) | data[at + 1]);
}

Found find_frame(std::span<const std::uint8_t> bytes, Frame& frame, std::size_t& size) noexcept {
  if (bytes.size() < header_size) return Found::more;
  const std::size_t length = u16_at(bytes, 4);  // of what follows it: unit, function, data
  if (u16_at(bytes, 2) != 0 || length < 2 || length > largest - 6) return Found::nonsense;
  size = 6 + length;
  if (bytes.size() < size) return Found::more;
  frame = {u16_at(bytes, 0), bytes[6], bytes[7], bytes.subspan(8, length - 2)};
  return Found::frame;
}

Bytes::Bytes(std::uint16_t transaction, std::uint8_t unit, std::uint8_t function) noexcept {
  u16(transaction).u16(0).u16(0).u8(unit).u8(function);
}
Bytes& Bytes::u8(std::uint8_t x) noexcept {
  if (size_ < bytes_.size()) bytes_[size_++] = x;
  if (size_ > 6) {
    bytes_[4] = static_cast<std::uint8_t>((size_ - 6) >> 8);
    bytes_[5] = static_cast<std::uint8_t>(size_ - 6);
  }
  return *this;
}
Bytes& Bytes::u16(std::uint16_t x) noexcept {
  return u8(static_cast<std::uint8_t>(x >> 8)).u8(static_cast<std::uint8_t>(x));
}

Bytes read_request(std::uint16_t transaction, std::uint8_t unit, std::uint16_t first,
                   std::uint16_t count) noexcept {
  return Bytes(transaction, unit, read_registers).u16(first).u16(count);
}
Bytes write_request(std::uint16_t transaction, std::uint8_t unit, std::uint16_t first,
                    std::span<const std::uint16_t> values) noexcept {
  Bytes out(transaction, unit, write_registers);
  out.u16(first)
      .u16(static_cast<std::uint16_t>(values.size()))
      .u8(static_cast<std::uint8_t>(2 * values.size()));
  for (const std::uint16_t x : values) out.u16(x);
  return out;
}

bool registers_of(const Frame& answer, std::span<std::uint16_t> into) noexcept {
  if (answer.function != read_registers || answer.data.size() != 1 + 2 * into.size() ||
      answer.data[0] != 2 * into.size())
    return false;
  for (std::size_t k = 0; k < into.size(); ++k) into[k] = u16_at(answer.data, 1 + 2 * k);
  return true;
}

}  // namespace adapters::gripper::modbus
