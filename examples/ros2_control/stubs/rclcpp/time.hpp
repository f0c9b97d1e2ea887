// Stands for rclcpp where there is none: the members that the controller calls, with their signatures.
#pragma once

#include <cstdint>

namespace rclcpp {

class Time {
 public:
  explicit Time(std::int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
  [[nodiscard]] std::int64_t nanoseconds() const { return nanoseconds_; }

 private:
  std::int64_t nanoseconds_;
};

class Duration {
 public:
  explicit Duration(std::int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
  [[nodiscard]] std::int64_t nanoseconds() const { return nanoseconds_; }

 private:
  std::int64_t nanoseconds_;
};

}  // namespace rclcpp
