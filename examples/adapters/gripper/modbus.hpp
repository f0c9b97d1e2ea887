// Modbus TCP: the functions that a gripper needs, for both ends. Every byte is checked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace adapters::gripper::modbus {

inline constexpr std::uint8_t read_registers = 3, write_register = 6, write_registers = 16;
inline constexpr std::size_t header_size = 7, largest = 260, most_registers = 123;

/// What a whole frame says. `data` is what follows the function code.
struct Frame {
  std::uint16_t transaction = 0;
  std::uint8_t unit = 0;
  std::uint8_t function = 0;  ///< with 0x80 added: an exception, whose code is `data[0]`
  std::span<const std::uint8_t> data;
};

enum class Found { frame, more, nonsense };
/// Takes the first frame of `bytes`: `size` is its length. `more`: its end has not arrived; `nonsense`: this
/// is no Modbus, and no later byte can be trusted.
[[nodiscard]] Found find_frame(std::span<const std::uint8_t> bytes, Frame& frame, std::size_t& size) noexcept;

/// A request or an answer in bytes.
class Bytes {
 public:
  Bytes(std::uint16_t transaction, std::uint8_t unit, std::uint8_t function) noexcept;
  Bytes& u8(std::uint8_t x) noexcept;
  Bytes& u16(std::uint16_t x) noexcept;
  [[nodiscard]] std::span<const std::uint8_t> span() const noexcept { return {bytes_.data(), size_}; }

 private:
  std::array<std::uint8_t, largest> bytes_{};
  std::size_t size_ = 0;
};

[[nodiscard]] Bytes read_request(std::uint16_t transaction, std::uint8_t unit, std::uint16_t first,
                                 std::uint16_t count) noexcept;
[[nodiscard]] Bytes write_request(std::uint16_t transaction, std::uint8_t unit, std::uint16_t first,
                                  std::span<const std::uint16_t> values) noexcept;

/// The registers of an answer to `read_request`; false unless there are exactly `into.size()`.
[[nodiscard]] bool registers_of(const Frame& answer, std::span<std::uint16_t> into) noexcept;
/// Two bytes of `data`, big-endian; `at + 2 <= data.size()`.
[[nodiscard]] std::uint16_t u16_at(std::span<const std::uint8_t> data, std::size_t at) noexcept;

}  // namespace adapters::gripper::modbus
