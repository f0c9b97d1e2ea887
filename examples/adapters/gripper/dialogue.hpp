// Question and answer with a device that may fall silent: one question at a time, and a clock.
#pragma once

#include <chrono>

#include "skinctl/core/gripper.hpp"

namespace adapters::gripper {

/// How long a gripper may be silent.
struct Patience {
  skinctl::Nanoseconds silent = std::chrono::milliseconds(100);  ///< then its state is said to be old
  skinctl::Nanoseconds lost = std::chrono::seconds(2);           ///< then it is given up
  skinctl::Nanoseconds again = std::chrono::milliseconds(200);   ///< then what was not answered is said again
};

/// Whose turn it is to speak. Times are those of `poll`.
class Dialogue {
 public:
  explicit Dialogue(const Patience& patience) : patience_(patience) {}

  /// The first call starts the clock.
  void at(skinctl::Nanoseconds now) noexcept {
    if (!started_) heard_ = asked_ = now;
    started_ = true;
    now_ = now;
  }
  /// From now on times are of another clock.
  void change_clock() noexcept { started_ = false; }
  [[nodiscard]] bool waiting() const noexcept { return waiting_; }
  void asked() noexcept {
    waiting_ = true;
    asked_ = now_;
  }
  /// Whether the last words should be said again: they, or the answer to them, were lost.
  [[nodiscard]] bool overdue() const noexcept { return waiting_ && now_ - asked_ > patience_.again; }
  void give_up_waiting() noexcept { waiting_ = false; }
  void heard() noexcept {
    waiting_ = false;
    heard_ = now_;
  }
  /// None, `silent` or `lost`. A clock that went backwards counts as no time.
  [[nodiscard]] skinctl::GripperError error() const noexcept {
    const auto since = now_ - heard_;
    return since > patience_.lost     ? skinctl::GripperError::lost
           : since > patience_.silent ? skinctl::GripperError::silent
                                      : skinctl::GripperError::none;
  }

 private:
  Patience patience_;
  skinctl::Nanoseconds heard_{}, now_{}, asked_{};
  bool started_ = false, waiting_ = false;
};

}  // namespace adapters::gripper
