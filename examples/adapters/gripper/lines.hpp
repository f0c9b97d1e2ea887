// Lines of text out of a stream of bytes, without allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace adapters::gripper {

/// Collects bytes and gives lines. A line that is longer than there is room for is thrown away and counted.
class Lines {
 public:
  /// Where the next bytes may be written; never empty after `next` has found no line.
  [[nodiscard]] std::span<std::uint8_t> room() noexcept {
    return std::span(reinterpret_cast<std::uint8_t*>(bytes_.data()), bytes_.size()).subspan(size_);
  }
  void wrote(std::size_t n) noexcept { size_ += n; }
  void clear() noexcept { size_ = taken_ = 0; }

  /// True and the oldest line, without its end, valid until the next call; false: there is no whole line.
  bool next(std::string_view& line) noexcept {
    std::memmove(bytes_.data(), bytes_.data() + taken_, size_ - taken_);
    size_ -= taken_;
    taken_ = 0;
    const auto end = std::string_view(bytes_.data(), size_).find('\n');
    if (end == std::string_view::npos) {
      if (size_ == bytes_.size()) {
        ++overlong_;
        size_ = 0;
      }
      return false;
    }
    line = {bytes_.data(), end};
    taken_ = end + 1;
    return true;
  }
  [[nodiscard]] std::uint64_t overlong() const noexcept { return overlong_; }

 private:
  std::array<char, 256> bytes_{};
  std::size_t size_ = 0, taken_ = 0;
  std::uint64_t overlong_ = 0;
};

}  // namespace adapters::gripper
