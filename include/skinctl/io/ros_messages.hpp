// SPDX-License-Identifier: BSD-3-Clause
// ROS 2 messages, encoded from values that lie elsewhere. Needs no ROS.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "skinctl/core/time.hpp"
#include "skinctl/frames/rotation.hpp"
#include "skinctl/io/cdr.hpp"
#include "skinctl/io/detail/ros_schemas.hpp"
#include "skinctl/io/message_type.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Messages as views: each has `type()`, and `encode(writer, message)` writes it. Whoever encodes must not be
/// in the loop the first time that `type()` is called: it allocates then.
namespace ros {

/// std_msgs/String.
struct String {
  std::string_view data;

  [[nodiscard]] static const MessageType& type() {
    static const MessageType t = {"std_msgs/msg/String", detail::ros_schema::string(),
                                  "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"};
    return t;
  }
};

/// sensor_msgs/JointState; velocity and effort may be empty.
struct JointState {
  Nanoseconds time{};
  std::string_view frame;
  std::span<const std::string> names;
  std::span<const double> position;  ///< joint positions [rad] or [m]
  std::span<const double> velocity;  ///< joint velocities [rad/s] or [m/s]
  std::span<const double> effort;    ///< joint torques [N m] or forces [N]

  [[nodiscard]] static const MessageType& type() {
    static const MessageType t = {"sensor_msgs/msg/JointState", detail::ros_schema::joint_state(),
                                  "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"};
    return t;
  }
};

/// One transform of a TFMessage: the pose of `child` in `parent`.
struct StampedTransform {
  Nanoseconds time{};
  std::string_view parent, child;
  Xyz<double> p{0, 0, 0};  ///< origin of the child in the parent [m]
  Rotation<double> R;      ///< axes of the child in the parent
};

/// tf2_msgs/TFMessage.
struct Transforms {
  std::span<const StampedTransform> transforms;

  [[nodiscard]] static const MessageType& type() {
    static const MessageType t = {"tf2_msgs/msg/TFMessage", detail::ros_schema::tf_message(),
                                  "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
    return t;
  }
};

/// The number types of sensor_msgs/PointField.
enum class PointNumber : std::uint8_t { i8 = 1, u8, i16, u16, i32, u32, f32, f64 };

/// One field of a point.
struct PointField {
  std::string_view name;
  std::uint32_t offset = 0;  ///< distance from the beginning of the point [bytes]
  PointNumber number = PointNumber::f32;
};

/// sensor_msgs/PointCloud2, one row: points of `point_size` bytes each, little-endian.
struct PointCloud {
  Nanoseconds time{};
  std::string_view frame;
  std::span<const PointField> fields;
  std::uint32_t point_size = 0;  ///< bytes of a point, above 0
  std::span<const unsigned char> points;

  [[nodiscard]] static const MessageType& type() {
    static const MessageType t = {"sensor_msgs/msg/PointCloud2", detail::ros_schema::point_cloud(),
                                  "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"};
    return t;
  }
};

/// std_msgs/Float64MultiArray of two dimensions, row by row. `labels` name the dimensions.
struct Matrix {
  std::array<std::string_view, 2> labels;
  std::size_t rows = 0, columns = 0;
  std::span<const double> data;  ///< rows times columns numbers

  [[nodiscard]] static const MessageType& type() {
    static const MessageType t = {"std_msgs/msg/Float64MultiArray", detail::ros_schema::multi_array(),
                                  "RIHS01_1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f"};
    return t;
  }
};

/// builtin_interfaces/Time: seconds, rounded down, and nanoseconds. Seconds beyond 2^31 wrap, as everywhere
/// in ROS.
inline void encode(CdrWriter& w, Nanoseconds time) noexcept {
  constexpr std::int64_t second = 1'000'000'000;
  std::int64_t s = time.count() / second, ns = time.count() % second;
  if (ns < 0) --s, ns += second;
  w.put(static_cast<std::int32_t>(s));
  w.put(static_cast<std::uint32_t>(ns));
}
inline void encode_header(CdrWriter& w, Nanoseconds time, std::string_view frame) noexcept {
  encode(w, time);
  w.put(frame);
}
inline void encode(CdrWriter& w, const String& m) noexcept {
  w.put(m.data);
}
inline void encode(CdrWriter& w, const JointState& m) noexcept {
  encode_header(w, m.time, m.frame);
  w.count(m.names.size());
  for (const std::string& name : m.names) w.put(std::string_view(name));
  w.sequence(m.position);
  w.sequence(m.velocity);
  w.sequence(m.effort);
}
inline void encode(CdrWriter& w, const Transforms& m) noexcept {
  w.count(m.transforms.size());
  for (const StampedTransform& t : m.transforms) {
    encode_header(w, t.time, t.parent);
    w.put(t.child);
    const auto q = detail::unit_quaternion(t.R.x, t.R.y, t.R.z);
    for (const double x : {t.p.x, t.p.y, t.p.z, q.v.x, q.v.y, q.v.z, q.w}) w.put(x);
  }
}
inline void encode(CdrWriter& w, const PointCloud& m) noexcept {
  const auto size = static_cast<std::uint32_t>(m.points.size());
  encode_header(w, m.time, m.frame);
  w.put(std::uint32_t(1));
  w.put(m.point_size > 0 ? size / m.point_size : 0);
  w.count(m.fields.size());
  for (const PointField& f : m.fields) {
    w.put(f.name);
    w.put(f.offset);
    w.put(static_cast<std::uint8_t>(f.number));
    w.put(std::uint32_t(1));
  }
  w.put(false);  // not big-endian
  w.put(m.point_size);
  w.put(size);
  w.sequence(m.points);
  w.put(true);  // dense: no point is missing
}
inline void encode(CdrWriter& w, const Matrix& m) noexcept {
  w.count(2);
  w.put(m.labels[0]);
  w.put(static_cast<std::uint32_t>(m.rows));
  w.put(static_cast<std::uint32_t>(m.rows * m.columns));
  w.put(m.labels[1]);
  w.put(static_cast<std::uint32_t>(m.columns));
  w.put(static_cast<std::uint32_t>(m.columns));
  w.put(std::uint32_t(0));
  w.sequence(m.data);
}

}  // namespace ros

SKINCTL_END_NAMESPACE
