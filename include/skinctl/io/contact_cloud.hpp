// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a skin as a point cloud.
#pragma once

#include <type_traits>

#include "skinctl/io/ros_messages.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One contact, as it lies in the cloud `/skin/contacts`.
struct ContactPoint {
  std::array<float, 3> position{};  ///< centre of pressure in the base [m]
  std::array<float, 3> force{};     ///< force on the robot, along the base's axes [N]
  float area = 0;                   ///< area of the contact [m^2]
  std::uint32_t link = 0;           ///< index of the link

  static constexpr std::array<ros::PointField, 8> fields = {{{"x", 0},
                                                             {"y", 4},
                                                             {"z", 8},
                                                             {"fx", 12},
                                                             {"fy", 16},
                                                             {"fz", 20},
                                                             {"area", 24},
                                                             {"link", 28, ros::PointNumber::u32}}};
};
static_assert(std::is_standard_layout_v<ContactPoint> && sizeof(ContactPoint) == 32);

/// The point cloud of `contacts`, to which it refers; their coordinates are in `frame`.
[[nodiscard]] inline ros::PointCloud contact_cloud(Nanoseconds time, std::string_view frame,
                                                   std::span<const ContactPoint> contacts) noexcept {
  return {time,
          frame,
          ContactPoint::fields,
          sizeof(ContactPoint),
          {reinterpret_cast<const unsigned char*>(contacts.data()), contacts.size_bytes()}};
}

SKINCTL_END_NAMESPACE
