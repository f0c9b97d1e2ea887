#include "examples/adapters/skin/papill_array.hpp"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "examples/adapters/serial.hpp"
#include "skinctl/core/contract.hpp"

namespace adapters::skin {
namespace {

constexpr std::array<std::uint8_t, 4> start_mark{0x55, 0x66, 0x77, 0x88}, end_mark{0xaa, 0xbb, 0xcc, 0xdd};
constexpr std::uint16_t force_entry = 2;
constexpr std::size_t mark_size = start_mark.size(), sum_size = 2;

/// Numbers one after the other; past the end they are 0, and `whole` says so.
class Numbers {
 public:
  Numbers(std::span<const std::uint8_t> bytes, std::size_t at)
      : bytes_(bytes), at_(at), whole_(at <= bytes.size()) {}
  std::uint64_t number(std::size_t size) noexcept {
    std::uint64_t out = 0;
    if (!has(size)) return 0;
    for (std::size_t k = size; k-- > 0;) out = out << 8 | bytes_[at_ + k];
    at_ += size;
    return out;
  }
  template <class Floats>
  void floats(Floats& out) noexcept {
    for (float& x : out) x = std::bit_cast<float>(static_cast<std::uint32_t>(number(4)));
  }
  void skip(std::size_t size) noexcept {
    if (has(size)) at_ += size;
  }
  [[nodiscard]] bool whole() const noexcept { return whole_; }
  [[nodiscard]] std::size_t at() const noexcept { return at_; }

 private:
  bool has(std::size_t size) noexcept {
    whole_ = whole_ && size <= bytes_.size() - at_;
    return whole_;
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_;
  bool whole_;
};

/// Where the blocks 1, 3 and 4 begin, 0: there is none, and whether there are others.
struct Index {
  std::array<std::size_t, 5> at{};
  bool others = false;
};
/// Nothing for an index that contradicts itself.
std::optional<Index> read_index(std::span<const std::uint8_t> bytes) noexcept {
  Index out;
  const std::size_t size = bytes.empty() ? 0 : bytes[0];
  if (size < 1 || size > 4) return std::nullopt;
  Numbers index(bytes, 1);
  std::size_t end = bytes.size();
  for (std::size_t at = 1; at < end; at += 2 + size) {
    const auto type = index.number(2);
    const auto offset = static_cast<std::size_t>(index.number(size));
    if (!index.whole() || offset < at + 2 + size || offset > bytes.size()) return std::nullopt;
    end = std::min(end, offset);
    if (type != 1 && type != 3 && type != 4) {
      out.others = true;
    } else if (std::exchange(out.at[type], offset) != 0) {
      return std::nullopt;
    }
  }
  return out;
}
bool read_pillars(Numbers& block, std::size_t index_size, PapillArrayPacket& out) noexcept {
  out.sensors = static_cast<std::size_t>(block.number(2));
  if (out.sensors > PapillArrayPacket::max_sensors) return false;
  block.skip(out.sensors * index_size);
  for (std::size_t s = 0; s < out.sensors; ++s) {
    auto& sensor = out.sensor[s];
    sensor.pillars = static_cast<std::size_t>(block.number(2));
    if (sensor.pillars > PapillArrayPacket::max_pillars) return false;
    block.skip(sensor.pillars * index_size);
    for (std::size_t k = 0; k < sensor.pillars; ++k) {
      if (block.number(2) != force_entry) return false;
      block.floats(sensor.pillar[k]);
    }
  }
  return block.whole();
}
bool read_whole(Numbers& block, std::size_t index_size, PapillArrayPacket& out) noexcept {
  if (block.number(2) != out.sensors) return false;
  block.skip(out.sensors * index_size);
  for (std::size_t s = 0; s < out.sensors; ++s) {
    if (block.number(2) != force_entry) return false;
    block.floats(out.sensor[s].whole);
    out.sensor[s].has_whole = true;
  }
  return block.whole();
}
std::uint16_t sum_of(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t sum = 0;
  for (const std::uint8_t b : bytes) sum += b;
  return static_cast<std::uint16_t>(sum);
}

}  // namespace

bool parse_papill_array(std::span<const std::uint8_t> bytes, PapillArrayPacket& out) noexcept {
  if (bytes.size() < sum_size + 1 || bytes.size() > PapillArrayParser::largest) return false;
  const auto blocks = bytes.first(bytes.size() - sum_size);
  if (Numbers(bytes, blocks.size()).number(sum_size) != sum_of(blocks)) return false;
  const auto index = read_index(blocks);
  if (!index || index->at[1] == 0 || index->at[3] == 0) return false;
  out = {};
  Numbers head(blocks, index->at[1]), pillars(blocks, index->at[3]), whole(blocks, index->at[4]);
  out.number = static_cast<std::uint32_t>(head.number(4));
  out.microseconds = head.number(8);
  if (!head.whole() || !read_pillars(pillars, blocks[0], out)) return false;
  if (index->at[4] != 0 && !read_whole(whole, blocks[0], out)) return false;
  return index->others || std::max({head.at(), pillars.at(), whole.at()}) == blocks.size();
}

bool PapillArrayParser::take(std::uint8_t byte) noexcept {
  if (filled_ == buffer_.size()) {  // the older half can begin no packet that still ends
    std::copy(buffer_.begin() + largest, buffer_.end(), buffer_.begin());
    std::copy(sum_.begin() + largest, sum_.end(), sum_.begin());
    filled_ -= largest, counts_.dropped += largest;
    const auto kept = std::remove_if(starts_.begin(), starts_.begin() + std::ptrdiff_t(started_),
                                     [](std::uint16_t s) { return s < largest; });
    started_ = static_cast<std::size_t>(kept - starts_.begin());
    for (std::size_t k = 0; k < started_; ++k) starts_[k] = static_cast<std::uint16_t>(starts_[k] - largest);
  }
  buffer_[filled_] = byte;
  sum_[filled_ + 1] = static_cast<std::uint16_t>(sum_[filled_] + byte);
  ++filled_;
  if (filled_ < mark_size) return false;
  const auto newest = buffer_.begin() + std::ptrdiff_t(filled_ - mark_size);
  if (std::equal(start_mark.begin(), start_mark.end(), newest) && started_ < starts_.size())
    starts_[started_++] = static_cast<std::uint16_t>(filled_ - mark_size);
  return std::equal(end_mark.begin(), end_mark.end(), newest) && try_starts();
}

bool PapillArrayParser::try_starts() noexcept {
  for (std::size_t k = started_; k-- > 0;) {
    const std::size_t start = starts_[k], first = start + mark_size, end = filled_ - mark_size;
    if (filled_ - start > largest || end < first + sum_size) continue;
    const auto sum = static_cast<std::uint16_t>(sum_[end - sum_size] - sum_[first]);
    if (sum != (buffer_[end - 2] | buffer_[end - 1] << 8)) continue;
    if (!parse_papill_array(std::span(buffer_).subspan(first, end - first), packet_)) continue;
    counts_.dropped += start, ++counts_.packets;
    filled_ = started_ = 0;
    return true;
  }
  return false;
}

std::vector<std::uint8_t> papill_array_bytes(const PapillArrayPacket& packet) {
  std::vector<std::uint8_t> out(start_mark.begin(), start_mark.end());
  const auto put = [&](std::uint64_t number, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k) out.push_back(static_cast<std::uint8_t>(number >> (8 * k)));
  };
  const auto put_floats = [&](const std::array<float, 6>& x) {
    put(force_entry, 2);
    for (const float f : x) put(std::bit_cast<std::uint32_t>(f), 4);
  };
  constexpr std::size_t index_size = 2, head = 1 + 3 * (2 + index_size), entry = 2 + 24;
  std::size_t pillars = 2 + packet.sensors * index_size;
  for (std::size_t s = 0; s < packet.sensors; ++s)
    pillars += 2 + packet.sensor[s].pillars * (index_size + entry);
  put(index_size, 1);
  put(1, 2), put(head, index_size), put(3, 2), put(head + 12, index_size), put(4, 2),
      put(head + 12 + pillars, index_size);
  put(packet.number, 4), put(packet.microseconds, 8);
  put(packet.sensors, 2);
  for (std::size_t s = 0, at = 2 + packet.sensors * index_size; s < packet.sensors; ++s) {
    put(at, index_size);
    at += 2 + packet.sensor[s].pillars * (index_size + entry);
  }
  for (std::size_t s = 0; s < packet.sensors; ++s) {
    const std::size_t n = packet.sensor[s].pillars;
    put(n, 2);
    for (std::size_t k = 0; k < n; ++k) put(2 + n * index_size + k * entry, index_size);
    for (std::size_t k = 0; k < n; ++k) put_floats(packet.sensor[s].pillar[k]);
  }
  put(packet.sensors, 2);
  for (std::size_t s = 0; s < packet.sensors; ++s)
    put(2 + packet.sensors * index_size + s * entry, index_size);
  for (std::size_t s = 0; s < packet.sensors; ++s) put_floats(packet.sensor[s].whole);
  put(sum_of(std::span(out).subspan(mark_size)), sum_size);
  out.insert(out.end(), end_mark.begin(), end_mark.end());
  return out;
}

std::span<const PapillArraySamples::Sample> PapillArraySamples::of(const PapillArrayPacket& packet,
                                                                   skinctl::Nanoseconds time) {
  samples_.clear();
  for (std::size_t s = 0; s < packet.sensors; ++s)
    for (std::size_t k = 0; k < packet.sensor[s].pillars; ++k) {
      Sample sample{.time = time, .cell = papill_array_cell(s, k), .readings = packet.sensor[s].pillar[k]};
      unrest_.measure(pillars_[sample.cell], sample), unrest_.tell(pillars_[sample.cell], sample);
      samples_.push_back(sample);
    }
  return samples_;
}

PapillArrayLine::PapillArrayLine(const std::string& device, unsigned rate, bool bias) {
  skinctl::require(rate == 100 || rate == 250 || rate == 500 || rate == 1000, "PapillArrayLine: rate",
                   double(rate), "100, 250, 500 or 1000 a second");
  fd_ = open_serial(device, 115200);
  const std::string asked = "f" + std::to_string(rate) + "\n" + (bias ? "z\n" : "");
  if (::write(fd_.get(), asked.data(), asked.size()) != static_cast<ssize_t>(asked.size()))
    throw ConnectionError("serial line '" + device + "': it takes nothing");
}

const PapillArrayPacket* PapillArrayLine::next(can::Deadline deadline) noexcept {
  for (bool looked = false; !closed_; looked = true) {
    while (at_ < end_)
      if (parser_.take(bytes_[at_++])) return &parser_.packet();
    if (looked && std::chrono::steady_clock::now() >= deadline) return nullptr;  // whatever it floods us with
    at_ = 0;
    const Read read = read_some(fd_, bytes_, end_, deadline);
    closed_ = read == Read::closed;
    if (read != Read::some) return nullptr;
  }
  return nullptr;
}

}  // namespace adapters::skin
