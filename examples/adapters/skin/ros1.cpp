#include "examples/adapters/skin/ros1.hpp"

#include <bit>

namespace adapters::skin {
namespace {

/// Takes numbers off the front of bytes; once there are too few it fails for good.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class U>
  U take() {
    if (bytes_.size() < sizeof(U)) {
      good_ = false;
      bytes_ = {};
      return 0;
    }
    U x = 0;
    for (std::size_t k = sizeof(U); k > 0; --k) x = static_cast<U>((x << 7 << 1) | bytes_[k - 1]);
    bytes_ = bytes_.subspan(sizeof(U));
    return x;
  }
  /// An array of doubles: the first ones go to `into`, the others are passed over.
  void reals(std::span<float> into, double unit, std::size_t most) {
    const auto n = take<std::uint32_t>();
    good_ = good_ && n <= most && bytes_.size() >= 8 * std::size_t{n};
    for (std::size_t k = 0; good_ && k < n; ++k) {
      const double x = unit * std::bit_cast<double>(take<std::uint64_t>());
      if (k < into.size()) into[k] = static_cast<float>(x);
    }
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool at_end() const { return good_ && bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool good_ = true;
};

template <class U>
void put(std::vector<std::uint8_t>& out, U x) {
  for (std::size_t k = 0; k < sizeof(U); ++k) out.push_back(static_cast<std::uint8_t>(x >> (8 * k)));
}
void put_reals(std::vector<std::uint8_t>& out, std::span<const float> values, double unit) {
  put(out, static_cast<std::uint32_t>(values.size()));
  for (const float x : values) put(out, std::bit_cast<std::uint64_t>(static_cast<double>(x) / unit));
}

}  // namespace

bool parse_ros1(std::span<const std::uint8_t> bytes, std::vector<skinctl::CellSample>& out,
                const Ros1Units& units) {
  const std::size_t before = out.size();
  Cursor at(bytes);
  const auto count = at.take<std::uint32_t>();
  if (count <= units.max_cells) {
    for (std::size_t i = 0; i < count && at.good(); ++i) {
      skinctl::CellSample s;
      s.cell = at.take<std::uint32_t>();
      s.time = skinctl::Nanoseconds(static_cast<std::int64_t>(at.take<std::uint64_t>()));
      at.reals({&s.proximity, 1}, 1, units.max_values);
      at.reals(s.force, 1, units.max_values);
      at.reals(s.acceleration, units.acceleration, units.max_values);
      at.reals({&s.temperature, 1}, 1, units.max_values);
      out.push_back(s);
    }
    if (at.at_end()) return true;
  }
  out.resize(before);
  return false;
}

std::vector<std::uint8_t> ros1_message(std::span<const skinctl::CellSample> samples, const Ros1Units& units) {
  std::vector<std::uint8_t> out;
  out.reserve(4 + 92 * samples.size());
  put(out, static_cast<std::uint32_t>(samples.size()));
  for (const auto& s : samples) {
    put(out, s.cell);
    put(out, static_cast<std::uint64_t>(s.time.count()));
    put_reals(out, {&s.proximity, 1}, 1);
    put_reals(out, s.force, 1);
    put_reals(out, s.acceleration, units.acceleration);
    put_reals(out, {&s.temperature, 1}, 1);
  }
  return out;
}

}  // namespace adapters::skin
