// The version that a controller reports, and what it can do.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace adapters::ur5 {

/// Of the controller's software, as RTDE tells it: 3.x on CB3, 5.x on e-Series, 10.x with PolyScope X.
struct Version {
  std::uint32_t major = 0, minor = 0, bugfix = 0, build = 0;

  friend constexpr auto operator<=>(const Version&, const Version&) = default;
  [[nodiscard]] std::string text() const {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(bugfix) + "." +
           std::to_string(build);
  }
  [[nodiscard]] constexpr bool is_polyscope_x() const noexcept { return major >= 10; }
  /// `direct_torque` exists.
  [[nodiscard]] constexpr bool takes_torques() const noexcept {
    return is_polyscope_x() ? *this >= Version{10, 11} : *this >= Version{5, 23};
  }
  /// `direct_torque` takes a scale of viscous and Coulomb friction for each joint.
  [[nodiscard]] constexpr bool takes_friction_scales() const noexcept {
    return is_polyscope_x() ? *this >= Version{10, 12, 1} : *this >= Version{5, 25, 1};
  }
  /// Registers 24 to 47, which no field bus uses, exist.
  [[nodiscard]] constexpr bool has_upper_registers() const noexcept {
    return major <= 3 ? *this >= Version{3, 9} : *this >= Version{5, 3};
  }
  /// Cycles a second.
  [[nodiscard]] constexpr double rate() const noexcept { return major >= 5 ? 500 : 125; }
};

}  // namespace adapters::ur5
