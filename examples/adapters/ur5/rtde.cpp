#include "examples/adapters/ur5/rtde.hpp"

#include <bit>
#include <cmath>
#include <cstring>

namespace adapters::ur5 {

void PackageWriter::f64(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  u32(static_cast<std::uint32_t>(bits >> 32));
  u32(static_cast<std::uint32_t>(bits));
}
const std::vector<std::uint8_t>& PackageWriter::finish() {
  bytes_[0] = static_cast<std::uint8_t>(bytes_.size() >> 8);
  bytes_[1] = static_cast<std::uint8_t>(bytes_.size());
  return bytes_;
}

std::uint8_t PayloadReader::u8() noexcept {
  if (left_.empty()) {
    ok_ = false;
    return 0;
  }
  const std::uint8_t x = left_.front();
  left_ = left_.subspan(1);
  return x;
}
double PayloadReader::f64() noexcept {
  return std::bit_cast<double>(u64());
}
std::string PayloadReader::text(std::size_t n) {
  if (n > left_.size()) {
    ok_ = false;
    n = left_.size();
  }
  std::string s(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(n));
  left_ = left_.subspan(n);
  return s;
}

std::span<std::uint8_t> Framer::room() noexcept {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  return std::span(buffer_).subspan(end_);
}
std::optional<Package> Framer::next() noexcept {
  if (broken_ || end_ - begin_ < 3) return {};
  const std::size_t size = (std::size_t(buffer_[begin_]) << 8) | buffer_[begin_ + 1];
  if (size < 3 || size > largest) {
    broken_ = true;
    return {};
  }
  if (end_ - begin_ < size) return {};
  const Package package{buffer_[begin_ + 2], std::span(buffer_).subspan(begin_ + 3, size - 3)};
  begin_ += size;
  return package;
}

bool Report::decode(std::span<const std::uint8_t> payload, const ReportExtras& extras) noexcept {
  if (payload.size() != bytes + (extras.tool ? 48 : 0) + (extras.motors ? 48 : 0) + (extras.echo ? 4 : 0))
    return false;
  PayloadReader in(payload);
  timestamp = in.f64();
  for (double& x : q) x = in.f64();
  for (double& x : dq) x = in.f64();
  robot_mode = in.i32();
  safety_mode = in.i32();
  runtime_state = in.u32();
  digital_outputs = in.u64();
  for (double& x : told) x = in.f64();
  slider = in.f64();
  for (double& x : wrench) x = in.f64();
  if (extras.tool)
    for (double& x : tool) x = in.f64();
  if (extras.motors)
    for (double& x : motors) x = in.f64();
  if (extras.echo) echo = in.i32();
  return in.ok();
}
bool Report::finite() const noexcept {
  bool all = true;
  for (std::size_t i = 0; i < 6; ++i) all = all && std::isfinite(q[i]) && std::isfinite(dq[i]);
  return all;
}

std::string describe_robot_mode(std::int32_t mode) {
  constexpr const char* names[] = {"disconnected", "confirm safety", "booting",
                                   "power off",    "power on",       "idle",
                                   "backdrive",    "running",        "updating firmware"};
  if (mode >= 0 && mode <= 8) return names[mode];
  return mode == -1 ? "no controller" : "mode " + std::to_string(mode);
}
std::string describe_safety_mode(std::int32_t mode) {
  constexpr const char* names[] = {"normal",         "reduced",        "protective stop",      "recovery",
                                   "safeguard stop", "emergency stop", "robot emergency stop", "violation",
                                   "fault"};
  if (mode >= 1 && mode <= 9) return names[mode - 1];
  return "safety mode " + std::to_string(mode);
}

}  // namespace adapters::ur5
