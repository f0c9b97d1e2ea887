#include "examples/adapters/skin/datagram.hpp"

#include <bit>

#include "examples/adapters/skin/authentication.hpp"

namespace adapters::skin {
namespace {

template <class U>
U little(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  U x = 0;
  for (std::size_t k = sizeof(U); k > 0; --k) x = static_cast<U>((x << 8) | bytes[at + k - 1]);
  return x;
}
template <class U>
std::size_t put(std::span<std::uint8_t> bytes, std::size_t at, U x) noexcept {
  for (std::size_t k = 0; k < sizeof(U); ++k) bytes[at + k] = static_cast<std::uint8_t>(x >> (8 * k));
  return at + sizeof(U);
}
float real(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return std::bit_cast<float>(little<std::uint32_t>(bytes, at));
}

}  // namespace

bool parse(std::span<const std::uint8_t> bytes, Datagram& out) noexcept {
  if (bytes.size() < header_size || bytes.size() > largest) return false;
  if (bytes[0] != 'S' || bytes[1] != 'K' || bytes[2] != 'I' || bytes[3] != 'N') return false;
  const std::uint16_t version = little<std::uint16_t>(bytes, 4);
  if (version != 1 && version != 2) return false;
  const bool sealed = version == 2;
  const std::size_t count = little<std::uint16_t>(bytes, 6);
  const std::size_t around = header_size + (sealed ? session_size + tag_size : 0);
  if (count > (sealed ? max_sealed_samples : max_samples) || bytes.size() != around + count * sample_size)
    return false;
  out.sealed = sealed;
  out.session = sealed ? little<std::uint64_t>(bytes, header_size) : 0;
  out.sequence = little<std::uint32_t>(bytes, 8);
  out.sent = skinctl::Nanoseconds(static_cast<std::int64_t>(little<std::uint64_t>(bytes, 12)));
  out.samples = bytes.subspan(header_size + (sealed ? session_size : 0), count * sample_size);
  return true;
}

skinctl::CellSample Datagram::sample(std::size_t i) const noexcept {
  const auto bytes = samples.subspan(i * sample_size, sample_size);
  skinctl::CellSample s;
  s.cell = little<std::uint32_t>(bytes, 0);
  s.time = skinctl::Nanoseconds(static_cast<std::int64_t>(little<std::uint64_t>(bytes, 4)));
  for (std::size_t k = 0; k < 3; ++k) s.force[k] = real(bytes, 12 + 4 * k);
  s.proximity = real(bytes, 24);
  for (std::size_t k = 0; k < 3; ++k) s.acceleration[k] = real(bytes, 28 + 4 * k);
  s.temperature = real(bytes, 40);
  return s;
}

std::size_t write(std::span<std::uint8_t> buffer, std::uint32_t sequence, skinctl::Nanoseconds sent,
                  std::span<const skinctl::CellSample> samples) noexcept {
  const std::size_t size = header_size + samples.size() * sample_size;
  if (samples.size() > max_samples || buffer.size() < size) return 0;
  for (std::size_t k = 0; k < 4; ++k) buffer[k] = static_cast<std::uint8_t>("SKIN"[k]);
  std::size_t at = put(buffer, 4, std::uint16_t{1});
  at = put(buffer, at, static_cast<std::uint16_t>(samples.size()));
  at = put(buffer, at, sequence);
  at = put(buffer, at, static_cast<std::uint64_t>(sent.count()));
  const auto put_real = [&](float x) { at = put(buffer, at, std::bit_cast<std::uint32_t>(x)); };
  for (const skinctl::CellSample& s : samples) {
    at = put(buffer, at, s.cell);
    at = put(buffer, at, static_cast<std::uint64_t>(s.time.count()));
    for (const float x : s.force) put_real(x);
    put_real(s.proximity);
    for (const float x : s.acceleration) put_real(x);
    put_real(s.temperature);
  }
  return size;
}

bool plausible(const skinctl::CellSample& s, const Datagram& datagram, skinctl::Nanoseconds oldest) noexcept {
  if (skinctl::check(s).any()) return false;
  for (const float a : s.acceleration)
    if (!(a >= -1000 && a <= 1000)) return false;
  if (!(s.temperature >= -100 && s.temperature <= 200)) return false;
  // Without overflow for any two stamps.
  return s.time <= datagram.sent &&
         (datagram.sent < skinctl::Nanoseconds::min() + oldest || s.time >= datagram.sent - oldest);
}

}  // namespace adapters::skin
