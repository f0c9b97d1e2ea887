// A tool with a handle, and a bread: their shapes. A tool lies along x, its handle about the origin.
#pragma once

#include "examples/packing_oranges/layout.hpp"

namespace packing {

inline constexpr skinctl::Xyz<double> handle_half{0.05, 0.010, 0.025}, blade_half{0.07, 0.002, 0.015};  // [m]
inline constexpr double handle_mass = 0.12, blade_mass = 0.02;  // [kg]
/// The blade's end, from the middle of the handle [m].
inline constexpr skinctl::Xyz<double> tool_tip{handle_half.x + 2 * blade_half.x, 0, 0};
/// How a tool lies before an arm, from its side: across the way of the fingers, its blade towards the other
/// arm [rad].
inline constexpr double tool_yaw = M_PI / 2;
/// A roll of bread, which stands upright [m, kg].
inline constexpr double bread_radius = 0.035, bread_half = 0.025, bread_mass = 0.12;

/// Among the things of the world: the bread and the tool before an arm.
[[nodiscard]] constexpr std::size_t bread_of(std::size_t arm) noexcept {
  return arm * slots;
}
[[nodiscard]] constexpr std::size_t tool_of(std::size_t arm) noexcept {
  return arm * slots + 1;
}
[[nodiscard]] constexpr bool is_tool(std::size_t slot) noexcept {
  return slot % slots == 1;
}

}  // namespace packing
