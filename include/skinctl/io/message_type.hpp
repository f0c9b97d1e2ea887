// SPDX-License-Identifier: BSD-3-Clause
// The type of a ROS 2 message: name, definition, and the hash by which nodes compare them.
#pragma once

#include <string>
#include <string_view>

#include "skinctl/io/detail/type_description.hpp"

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

/// The type `name` with the definition `schema`; its hash is computed from the definition. Throws
/// `ConfigurationError` with the line for a definition that is no ROS message, or lacks a type that it uses.
[[nodiscard]] inline MessageType message_type(std::string name, std::string schema) {
  std::string hash = "RIHS01_" + detail::sha256(detail::TypeDescription(name, schema).json());
  return {std::move(name), std::move(schema), std::move(hash)};
}

SKINCTL_END_NAMESPACE
