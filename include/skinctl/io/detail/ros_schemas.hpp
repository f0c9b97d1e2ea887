// SPDX-License-Identifier: BSD-3-Clause
// The definitions of the ROS 2 messages that skinctl writes, without their comments.
#pragma once

#include <string>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::ros_schema {

/// A type that a definition uses, behind the line that separates it.
inline std::string used(const std::string& type, const std::string& fields) {
  return std::string(80, '=') + "\nMSG: " + type + '\n' + fields;
}
inline std::string header() {
  return used("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
         used("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
}
inline std::string string() {
  return "string data\n";
}
inline std::string joint_state() {
  return "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" +
         header();
}
inline std::string tf_message() {
  return "geometry_msgs/TransformStamped[] transforms\n" +
         used("geometry_msgs/TransformStamped",
              "std_msgs/Header header\nstring child_frame_id\nTransform transform\n") +
         used("geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n") +
         used("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n") +
         used("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n") + header();
}
inline std::string point_cloud() {
  return "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n"
         "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" +
         used(
             "sensor_msgs/PointField",
             "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
             "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n") +
         header();
}
inline std::string multi_array() {
  return "MultiArrayLayout layout\nfloat64[] data\n" +
         used("std_msgs/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset\n") +
         used("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n");
}

}  // namespace detail::ros_schema
SKINCTL_END_NAMESPACE
