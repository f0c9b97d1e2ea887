// SPDX-License-Identifier: BSD-3-Clause
// The number for which a goal is refused: its joint or coordinate, its value and the allowed range.
#pragma once

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "skinctl/control/velocity_control.hpp"
#include "skinctl/tracking/joint_space.hpp"
#include "skinctl/tracking/pose_targets.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A number of a goal that is out of its range, or none.
struct GoalFault {
  const char* quantity = nullptr;  ///< name of the number; null: every number is in its range
  const char* unit = "";           ///< unit of the number
  int joint = -1;                  ///< joint of the number, counted from 0; -1: it belongs to no joint
  double value = 0;                ///< number of the goal, in `unit`
  double lower = 0;                ///< smallest number that is allowed, in `unit`
  double upper = 0;                ///< largest number that is allowed, in `unit`
};

namespace detail {
inline constexpr double any_number = (std::numeric_limits<double>::max)();

template <class Numbers>
[[nodiscard]] GoalFault not_finite(const char* quantity, const Numbers& numbers) noexcept {
  int i = 0;
  for (const auto& x : numbers) {
    if (!std::isfinite(double(x))) return {quantity, "", i, double(x), -any_number, any_number};
    ++i;
  }
  return {};
}
template <class Limits, class Position>
[[nodiscard]] GoalFault joint_beyond(const Limits& limits, const Position& q) noexcept {
  for (std::size_t i = 0; i < Position::size(); ++i) {
    const GoalFault at{
        "position", "rad or m", int(i), double(q[i]), double(limits.lower()[i]), double(limits.upper()[i])};
    if (!(at.value >= at.lower && at.value <= at.upper)) return at;
  }
  return {};
}
template <class Pose>
[[nodiscard]] GoalFault pose_fault(const Pose& X) noexcept {
  const auto& p = X.origin();
  const std::pair<const char*, double> places[] = {
      {"origin x", double(p.x)}, {"origin y", double(p.y)}, {"origin z", double(p.z)}};
  for (const auto& [quantity, x] : places)
    if (!std::isfinite(x)) return {quantity, "m", -1, x, -any_number, any_number};
  const double error = double(rotation_error(X.axes()));  // targets are checked more finely: see `allows`
  if (!(error <= worst_goal_axes)) return {"axes, |R'R - 1|", "", -1, error, 0, worst_goal_axes};
  return {};
}
template <class Motion>
[[nodiscard]] GoalFault motion_fault(const char* quantity, const Motion& m) noexcept {
  for (const auto& x : {m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z})
    if (!std::isfinite(double(x))) return {quantity, "", -1, double(x), -any_number, any_number};
  return {};
}
[[nodiscard]] inline GoalFault first_of(const GoalFault& a, const GoalFault& b) noexcept {
  return a.quantity != nullptr ? a : b;
}
[[nodiscard]] inline GoalFault negative(Nanoseconds duration) noexcept {
  if (duration >= 0ns) return {};
  return {"duration", "s", -1, seconds<double>(duration), 0, any_number};
}

template <class Limits, class Goal>
[[nodiscard]] GoalFault fault_of(const Limits&, const Goal&) noexcept {
  return {};
}
template <class Limits, std::size_t N, Scalar T>
[[nodiscard]] GoalFault fault_of(const Limits& limits, const JointGoal<N, T>& goal) noexcept {
  return first_of(joint_beyond(limits, goal.q_g), negative(goal.duration));
}
template <class Limits, std::size_t N, Scalar T>
[[nodiscard]] GoalFault fault_of(const Limits& limits, const JointReference<N, T>& goal) noexcept {
  return first_of(joint_beyond(limits, goal.q_d),
                  first_of(not_finite("velocity", goal.dq_d), not_finite("acceleration", goal.ddq_d)));
}
template <class Limits, Frame P, Scalar T>
[[nodiscard]] GoalFault fault_of(const Limits&, const PoseGoal<P, T>& goal) noexcept {
  return first_of(pose_fault(goal.X_BP), negative(goal.duration));
}
template <class Limits, Frame P, Scalar T>
[[nodiscard]] GoalFault fault_of(const Limits&, const PoseReference<P, T>& goal) noexcept {
  return first_of(pose_fault(goal.X_BP),
                  first_of(motion_fault("velocity", goal.V), motion_fault("acceleration", goal.A)));
}
template <class Limits, std::size_t N, Real T>
[[nodiscard]] GoalFault fault_of(const Limits&, const VelocityGoal<N, T>& goal) noexcept {
  return not_finite("velocity", goal.velocity);
}
}  // namespace detail

/// The first number of a goal that is out of its range, for a goal that a scene refused: positions beyond the
/// limits of `scene`'s robot, numbers that are not finite, axes that are no rotation, a negative duration.
/// None for a goal that is too fast for its law, and for one that no law or skill takes now.
///
/// @param goal  goal of a spline, target or velocity, in a blend its `*goal`; of others nothing is known.
template <class Scene, class Goal>
[[nodiscard]] GoalFault goal_fault(const Scene& scene, const Goal& goal) noexcept {
  return detail::fault_of(scene.resolver().limits(), goal);
}

/// A sentence about a refused goal, as "position of joint 0: 7 rad or m, allowed: -6.28319 to 6.28319".
[[nodiscard]] inline std::string in_words(const GoalFault& f) {
  if (f.quantity == nullptr)
    return "every number is in its range: too fast for the law's largest speed, or no law takes it now";
  char text[160], of[24] = "";
  if (f.joint >= 0) std::snprintf(of, sizeof of, " of joint %d", f.joint);
  const char* gap = *f.unit == '\0' ? "" : " ";
  if (f.upper == detail::any_number) {
    std::snprintf(text, sizeof text, "%s%s: %.6g%s%s, allowed: %s", f.quantity, of, f.value, gap, f.unit,
                  f.lower == 0 ? "0 or more" : "any finite number");
  } else {
    std::snprintf(text, sizeof text, "%s%s: %.6g%s%s, allowed: %.6g to %.6g", f.quantity, of, f.value, gap,
                  f.unit, f.lower, f.upper);
  }
  return text;
}

SKINCTL_END_NAMESPACE
