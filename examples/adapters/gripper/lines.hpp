// Lines of text out of a stream of bytes, without allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace adapters::gripper {

/// Collects bytes and gives lines that are not empty. A line that is longer than there is room for is thrown
/// away and counted.
class Lines {
 public:
  /// @param word  a line of its own wherever a line begins with it, whether a line end follows or not; empty:
  ///              none.
  explicit Lines(std::string_view word = {}) : word_(word) {}

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
    for (std::string_view rest(bytes_.data(), size_); !rest.empty(); rest.remove_prefix(1)) {
      if (rest.front() == '\n' || rest.front() == '\r') continue;
      const bool word = !word_.empty() && rest.starts_with(word_);
      const auto end = word ? word_.size() : rest.find('\n');
      if (end == std::string_view::npos) break;
      line = rest.substr(0, end);
      taken_ = size_ - rest.size() + end;
      return true;
    }
    if (size_ == bytes_.size()) {
      ++overlong_;
      size_ = 0;
    }
    return false;
  }
  [[nodiscard]] std::uint64_t overlong() const noexcept { return overlong_; }

 private:
  std::string_view word_;
  std::array<char, 256> bytes_{};
  std::size_t size_ = 0, taken_ = 0;
  std::uint64_t overlong_ = 0;
};

}  // namespace adapters::gripper
