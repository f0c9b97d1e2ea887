#include "examples/adapters/allegro/datagrams.hpp"

#include <concepts>

namespace adapters::allegro {
namespace {

constexpr std::uint32_t magic = 0x32423556;  // "V5B2"
constexpr std::uint8_t version = 1;

/// Place on the wire of joint `i`: the thumb (12 to 15) first.
constexpr std::size_t place(std::size_t i) {
  return (i + 4) % 16;
}

template <std::unsigned_integral U>
U read(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  U x = 0;
  for (std::size_t k = 0; k < sizeof(U); ++k)
    x = static_cast<U>(x | static_cast<U>(static_cast<U>(bytes[at + k]) << (8 * k)));
  return x;
}

template <std::unsigned_integral U>
void write(std::uint8_t* to, U x) noexcept {
  for (std::size_t k = 0; k < sizeof(U); ++k) to[k] = static_cast<std::uint8_t>(x >> (8 * k));
}

void write_header(std::uint8_t* to, DatagramType type, std::uint16_t length, std::uint32_t sequence,
                  std::uint32_t ms) noexcept {
  write(to, magic);
  to[4] = version;
  to[5] = static_cast<std::uint8_t>(type);
  write(to + 6, length);
  write(to + 8, sequence);
  write(to + 12, ms);
}

template <std::size_t N>
std::optional<std::array<std::uint8_t, N>> bytes_of(const Datagram& d, DatagramType type) noexcept {
  if (d.type != type || d.payload.size() < N) return std::nullopt;
  std::array<std::uint8_t, N> out{};
  for (std::size_t i = 0; i < N; ++i) out[i] = d.payload[i];
  return out;
}

}  // namespace

std::optional<Datagram> parse(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() < header_size || read<std::uint32_t>(bytes, 0) != magic || bytes[4] != version)
    return std::nullopt;
  const std::size_t length = read<std::uint16_t>(bytes, 6);
  if (bytes.size() - header_size < length) return std::nullopt;
  return Datagram{static_cast<DatagramType>(bytes[5]), read<std::uint32_t>(bytes, 8),
                  read<std::uint32_t>(bytes, 12), bytes.subspan(header_size, length)};
}

std::optional<Telemetry> telemetry(const Datagram& d) noexcept {
  if (d.type != DatagramType::telemetry || d.payload.size() < telemetry_size) return std::nullopt;
  Telemetry t;
  t.sample = read<std::uint32_t>(d.payload, 0);
  for (std::size_t i = 0; i < 16; ++i) {
    t.position[i] = static_cast<std::int16_t>(read<std::uint16_t>(d.payload, 4 + 2 * place(i)));
    t.current[i] = static_cast<std::int16_t>(read<std::uint16_t>(d.payload, 36 + 2 * place(i)));
    t.tactile[i] = read<std::uint16_t>(d.payload, 68 + 2 * i);
    t.velocity[i] = static_cast<std::int32_t>(read<std::uint32_t>(d.payload, 100 + 4 * place(i)));
  }
  return t;
}

std::optional<std::array<std::uint8_t, 7>> hello_answer(const Datagram& d) noexcept {
  return bytes_of<7>(d, DatagramType::hello_answer);
}
std::optional<std::array<std::uint8_t, 8>> serial_answer(const Datagram& d) noexcept {
  return bytes_of<8>(d, DatagramType::serial_answer);
}

std::optional<FaultMask> fault_mask(const Datagram& d) noexcept {
  if (d.type != DatagramType::fault_mask || d.payload.size() < 8) return std::nullopt;
  return FaultMask{read<std::uint32_t>(d.payload, 0), read<std::uint32_t>(d.payload, 4)};
}
std::optional<MotorError> motor_error(const Datagram& d) noexcept {
  if (d.type != DatagramType::motor_error || d.payload.size() < 2) return std::nullopt;
  return MotorError{d.payload[0], d.payload[1]};
}

std::array<std::uint8_t, 16> plain(DatagramType type, std::uint32_t sequence, std::uint32_t ms) noexcept {
  std::array<std::uint8_t, 16> out{};
  write_header(out.data(), type, 0, sequence, ms);
  return out;
}

std::array<std::uint8_t, 48> torques(const std::array<std::int16_t, 16>& value, std::uint32_t sequence,
                                     std::uint32_t ms) noexcept {
  std::array<std::uint8_t, 48> out{};
  write_header(out.data(), DatagramType::torque, 32, sequence, ms);
  for (std::size_t i = 0; i < 16; ++i)
    write(out.data() + header_size + 2 * place(i), static_cast<std::uint16_t>(value[i]));
  return out;
}

}  // namespace adapters::allegro
