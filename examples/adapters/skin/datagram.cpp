#include "examples/adapters/skin/datagram.hpp"

#include <algorithm>
#include <bit>

namespace adapters::skin {
namespace {

using skinctl::Nanoseconds;

constexpr std::uint16_t sealed_flag = 1;
constexpr std::size_t hexagon_readings = skinctl::KindTable<skinctl::Hexagon>::readings;
constexpr std::uint32_t hexagons = skinctl::KindTable<skinctl::Hexagon>::fingerprint();

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

/// Flags, readings and kind of version 3; bytes before the samples, 0 for what is none.
std::size_t parse_kind(std::span<const std::uint8_t> bytes, Datagram& out) noexcept {
  if (bytes.size() < header_size + kind_size) return 0;
  const auto flags = little<std::uint16_t>(bytes, header_size);
  out.readings = little<std::uint16_t>(bytes, header_size + 2);
  out.kind = little<std::uint32_t>(bytes, header_size + 4);
  if ((flags & ~sealed_flag) != 0 || out.readings < 1 || out.readings > 32) return 0;
  out.sealed = (flags & sealed_flag) != 0;
  return header_size + kind_size;
}

}  // namespace

bool parse(std::span<const std::uint8_t> bytes, Datagram& out) noexcept {
  if (bytes.size() < header_size || bytes.size() > largest) return false;
  if (bytes[0] != 'S' || bytes[1] != 'K' || bytes[2] != 'I' || bytes[3] != 'N') return false;
  out = {};
  out.version = little<std::uint16_t>(bytes, 4);
  if (out.version < 1 || out.version > 3) return false;
  out.sealed = out.version == 2;
  out.kind = hexagons, out.readings = hexagon_readings;
  std::size_t before = out.version == 3 ? parse_kind(bytes, out) : header_size;
  if (before == 0) return false;
  if (out.sealed) before += question_size;
  const std::size_t around = before + (out.sealed ? tag_size : 0);
  const std::size_t count = little<std::uint16_t>(bytes, 6);
  if (bytes.size() != around + count * out.size_of_sample()) return false;
  if (out.version == 3 && count > max_samples(out.readings)) return false;
  if (out.sealed)
    std::copy_n(bytes.begin() + std::ptrdiff_t(before - question_size), question_size, out.question.begin());
  out.sequence = little<std::uint32_t>(bytes, 8);
  out.sent = Nanoseconds(static_cast<std::int64_t>(little<std::uint64_t>(bytes, 12)));
  out.samples = bytes.subspan(before, count * out.size_of_sample());
  return true;
}

void Datagram::read(std::size_t i, Nanoseconds& time, std::uint32_t& cell, std::uint16_t& measured,
                    std::uint16_t& unrest, std::span<float> x) const noexcept {
  const auto bytes = samples.subspan(i * size_of_sample(), size_of_sample());
  cell = little<std::uint32_t>(bytes, 0);
  time = Nanoseconds(static_cast<std::int64_t>(little<std::uint64_t>(bytes, 4)));
  const bool says = version >= 3;
  measured = says ? little<std::uint16_t>(bytes, 12) : skinctl::unsaid;
  unrest = says ? little<std::uint16_t>(bytes, 14) : skinctl::unsaid;
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = std::bit_cast<float>(little<std::uint32_t>(bytes, (says ? 16 : 12) + 4 * k));
}

Writer::Writer(std::span<std::uint8_t, largest> buffer, std::uint32_t sequence, Nanoseconds sent,
               std::uint32_t kind, std::size_t readings, const Question* question) noexcept
    : buffer_(buffer), size_(header_size + kind_size), readings_(readings) {
  for (std::size_t k = 0; k < 4; ++k) buffer[k] = static_cast<std::uint8_t>("SKIN"[k]);
  std::size_t at = put(buffer, 4, std::uint16_t{3});
  at = put(buffer, at, count_);
  at = put(buffer, at, sequence);
  at = put(buffer, at, static_cast<std::uint64_t>(sent.count()));
  at = put(buffer, at, static_cast<std::uint16_t>(question != nullptr ? sealed_flag : 0));
  at = put(buffer, at, static_cast<std::uint16_t>(readings));
  put(buffer, at, kind);
  if (question == nullptr) return;
  std::copy(question->begin(), question->end(), buffer.begin() + std::ptrdiff_t(size_));
  size_ += question_size;
}

bool Writer::add(Nanoseconds time, std::uint32_t cell, std::uint16_t measured, std::uint16_t unrest,
                 std::span<const float> x) noexcept {
  if (count_ == max_samples(readings_)) return false;
  size_ = put(buffer_, size_, cell);
  size_ = put(buffer_, size_, static_cast<std::uint64_t>(time.count()));
  size_ = put(buffer_, size_, measured);
  size_ = put(buffer_, size_, unrest);
  for (const float f : x) size_ = put(buffer_, size_, std::bit_cast<std::uint32_t>(f));
  put(buffer_, 6, ++count_);
  return true;
}

bool plausible(const skinctl::CellSample& s, const Datagram& datagram, Nanoseconds oldest) noexcept {
  if (skinctl::check(s).any()) return false;
  for (const float a : s.acceleration)
    if (!(a >= -1000 && a <= 1000)) return false;
  return s.temperature >= -100 && s.temperature <= 200 && in_time(s.time, datagram, oldest);
}

bool in_time(Nanoseconds time, const Datagram& datagram, Nanoseconds oldest) noexcept {
  // Without overflow for any two stamps.
  return time <= datagram.sent &&
         (datagram.sent < Nanoseconds::min() + oldest || time >= datagram.sent - oldest);
}

}  // namespace adapters::skin
