// Any gripper with a valve or a relay on digital outputs.
#pragma once

#include <optional>

#include "examples/adapters/gripper/binary.hpp"

namespace adapters::gripper {

/// A `GripperLine` over the outputs of a robot or of any other device: `write(bit, on)` is false where it
/// failed, `bits()` gives what the device reports, or nothing before it has.
///
/// `close_bit` is on while closed; a valve with two coils has an `open_bit` too, off then.
template <class Outputs>
class DigitalLine {
 public:
  DigitalLine(Outputs& outputs, int close_bit, std::optional<int> open_bit = std::nullopt)
      : outputs_(outputs), close_(close_bit), open_(open_bit) {}
  /// The coil that is on goes off first: two at once would fight.
  bool set(bool closed) noexcept {
    const auto coil = [&](std::optional<int> bit, bool on) { return !bit || outputs_.write(*bit, on); };
    return good_ =
               closed ? coil(open_, false) && coil(close_, true) : coil(close_, false) && coil(open_, true);
  }
  [[nodiscard]] bool good() noexcept { return good_; }
  [[nodiscard]] std::optional<bool> read() const noexcept {
    const std::optional<std::uint64_t> bits = outputs_.bits();
    if (!bits) return std::nullopt;
    return (*bits >> close_ & 1) != 0;
  }

 private:
  Outputs& outputs_;
  int close_;
  std::optional<int> open_;
  bool good_ = true;
};

}  // namespace adapters::gripper
