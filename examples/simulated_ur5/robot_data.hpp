// The UR5's constants as its controller tells them to clients.
#pragma once

#include <array>
#include <cstdint>

#include "examples/simulated_ur5/geometry.hpp"

namespace simulated_ur5::robot_data {

// Denavit-Hartenberg parameters of the maker's data sheet; an arm without calibration has these exactly.
inline constexpr Joints dh_theta = {0, 0, 0, 0, 0, 0};
inline constexpr Joints dh_a = {0, -0.425, -0.39225, 0, 0, 0};
inline constexpr Joints dh_d = {0.089159, 0, 0, 0.10915, 0.09465, 0.0823};
inline constexpr Joints dh_alpha = {pi / 2, 0, 0, pi / 2, -pi / 2, 0};

inline constexpr double default_joint_speed = 1.05;        ///< movej [rad/s]
inline constexpr double default_joint_acceleration = 1.4;  ///< movej [rad/s^2]
inline constexpr double default_tool_speed = 0.25;         ///< movel [m/s]
inline constexpr double default_tool_acceleration = 1.2;   ///< movel [m/s^2]
inline constexpr double equivalent_radius = 0.35;          ///< [m]

inline constexpr std::int32_t robot_type_ur5 = 1, robot_sub_type = 1, controller_box_type = 2;
inline constexpr std::int32_t masterboard_version = 2;
inline constexpr std::uint32_t calibration_linearised = 1;  ///< status: checksum and parameters agree

/// One checksum per joint: CRC-32 of its four parameters, big-endian, in the order theta, a, d, alpha.
std::array<std::uint32_t, joint_count> kinematics_checksum();

}  // namespace simulated_ur5::robot_data
