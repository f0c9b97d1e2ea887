// SPDX-License-Identifier: BSD-3-Clause
// The type of a ROS 2 message: name, definition, and the hash by which nodes compare them.
#pragma once

#include <string>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A message type as files, streams and DDS name it.
struct MessageType {
  std::string name;  ///< name, as "sensor_msgs/msg/JointState"
  std::string
      schema;  ///< the `.msg` text, then each type it uses after a line of 80 `=` and `MSG: package/Type`
  std::string hash;  ///< hash: "RIHS01_" and 64 hexadecimal digits (REP 2016)

  /// The name as DDS has it: "sensor_msgs::msg::dds_::JointState_".
  [[nodiscard]] std::string dds_name() const {
    std::string out;
    for (const char c : name) out += c == '/' ? std::string("::") : std::string(1, c);
    return out.insert(out.rfind("::") + 2, "dds_::") + '_';
  }
};

SKINCTL_END_NAMESPACE
