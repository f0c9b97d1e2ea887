// The force with which a wrist presses down what its hand holds, and whether a person pushes the arm meanwhile.
#pragma once

#include <array>
#include <span>

#include "examples/packing_oranges/layout.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/wrench_sample.hpp"

namespace packing {

/// Readings of a wrist's force sensor along the tool, which points down. What it read in the last moments
/// before a press began, its bias and the weight of the hand, is no press.
class Pressing {
 public:
  static constexpr std::size_t before = 8;  ///< readings whose mean counts as no press
  static constexpr skinctl::Nanoseconds fades =
      120ms;                         ///< time that a skill takes to hand over to the next one
  static constexpr double felt = 1;  ///< force of a cell that is a person's, 10 deviations of its noise [N]

  /// A reading, before each cycle.
  void feel(const skinctl::WrenchSample& reading) { reading_ = reading; }
  /// A cycle; `presses`: a skill that presses is at work. What follows it takes over within `fades`.
  void step(bool presses) {
    if (presses && !on_) {
      none_ = 0;
      for (const double f : last_) none_ += f / before;
    }
    if (presses) pressed_ = reading_.time;
    on_ = reading_.time - pressed_ < fades;
    last_[next_] = -reading_.force[2];
    next_ = (next_ + 1) % before;
    sample_ = {reading_.time, {0, 0, -force()}, {}};
  }
  /// With which the wrist presses; 0 while it does not [N].
  [[nodiscard]] double force() const { return on_ ? -reading_.force[2] - none_ : 0; }
  /// What the cycle is told: nothing unless it presses.
  [[nodiscard]] std::span<const skinctl::WrenchSample> samples() const {
    return {&sample_, on_ ? std::size_t(1) : std::size_t(0)};
  }

  /// Whether somebody pushes the skin.
  [[nodiscard]] static bool pushed(std::span<const skinctl::CellSample> samples, double newtons) {
    for (const skinctl::CellSample& s : samples)
      if (static_cast<double>(s.force[0]) * newtons > felt) return true;
    return false;
  }

 private:
  skinctl::WrenchSample reading_{}, sample_{};
  std::array<double, before> last_{};
  double none_ = 0;
  std::size_t next_ = 0;
  skinctl::Nanoseconds pressed_{-1s};
  bool on_ = false;
};

}  // namespace packing
