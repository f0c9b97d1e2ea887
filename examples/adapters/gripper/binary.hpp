// Grippers that only open and close and do not say how far they are.
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>

#include "skinctl/core/contract.hpp"
#include "skinctl/hardware/gripper.hpp"

namespace adapters::gripper {

/// What switches such a gripper: `set(closed)` is false where the word could not be sent; `good()` is false
/// once the line is gone; `read()` is what the device echoes, if it does.
template <class L>
concept GripperLine = requires(L& line, const L& same, bool closed) {
  { line.set(closed) } noexcept -> std::same_as<bool>;
  { line.good() } noexcept -> std::same_as<bool>;
  { same.read() } noexcept -> std::same_as<std::optional<bool>>;
};

struct BinaryConfig {
  double opening = 0.08;  ///< [m]
  double force = 20;      ///< it closes with, as its maker states it [N]
  skinctl::Nanoseconds travel =
      std::chrono::milliseconds(1000);  ///< from one end to the other; it takes no word before
  skinctl::Nanoseconds echo =
      std::chrono::milliseconds(500);  ///< so soon a line that echoes must show the word
};

/// A `GripperDriver`. A goal of less than half the opening closes it. Its opening is the time since the last
/// word, so `GripperState::measured` is false, and it never says that it holds: ask the skin on its fingers.
template <GripperLine Line>
class BinaryGripper {
 public:
  /// Throws `ConfigurationError` for a travel or an opening that is not above 0.
  BinaryGripper(Line& line, const BinaryConfig& config) : line_(line), config_(config) {
    skinctl::require(config.opening > 0, "the opening of a gripper", config.opening, "above 0 [m]");
    skinctl::require(config.travel.count() > 0, "the travel of a gripper",
                     skinctl::milliseconds(config.travel), "above 0 [ms]");
  }

  [[nodiscard]] skinctl::GripperRange range() const noexcept {
    const double speed = config_.opening / skinctl::seconds<double>(config_.travel);
    return {config_.opening, config_.force, config_.force, speed, speed};
  }
  bool move(const skinctl::GripperGoal& goal) noexcept {
    if (!finite(goal) || !line_.good()) return false;
    wanted_ = goal.opening < 0.5 * config_.opening;
    return true;
  }
  skinctl::GripperState poll(skinctl::Nanoseconds now) noexcept {
    const bool busy = told_ && now - since_ < config_.travel;
    if (wanted_ && wanted_ != told_ && !busy && line_.good() && line_.set(*wanted_)) {
      told_ = wanted_;
      since_ = now;
    }
    skinctl::GripperState out;
    out.time = now;
    if (told_) {
      const double share =
          std::min(skinctl::seconds<double>(now - since_) / skinctl::seconds<double>(config_.travel), 1.0);
      out.heard = true;
      out.opening = config_.opening * (*told_ ? 1 - share : share);
      out.moving = share < 1 || wanted_ != told_;
    } else {
      out.moving = wanted_.has_value();
    }
    const auto echo = line_.read();
    if (!line_.good())
      out.error = skinctl::GripperError::lost;
    else if (told_ && echo && *echo != *told_ && now - since_ > config_.echo)
      out.error = skinctl::GripperError::fault;
    return out;
  }
  /// These cannot stop on the way: what was asked for last is left as it is, and nothing new is begun.
  void stop() noexcept { wanted_ = told_; }

 private:
  Line& line_;
  BinaryConfig config_;
  std::optional<bool> wanted_, told_;  ///< closed?
  skinctl::Nanoseconds since_{};
};

}  // namespace adapters::gripper
