// SPDX-License-Identifier: BSD-3-Clause
// Whether the settings of a tracking law fit the robot and the limits of its scene.
#pragma once

#include "skinctl/tracking/settings.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Throws `ConfigurationError` with both numbers if a law's settings differ from those of the robot that
/// carries its torque.
template <std::size_t N, Real T>
SKINCTL_COLD void check_for(const JointControlSettings<N, T>& s, const LawTerms<N, T>& robot) {
  const auto same = [](const char* what, const T& ours, const T& theirs) {
    if (ours == theirs) return;
    char text[192];
    std::snprintf(text, sizeof text,
                  "skinctl: %s: %.9g in the law, %.9g in the robot's description: tracking_settings(robot) "
                  "takes it from there",
                  what, static_cast<double>(ours), static_cast<double>(theirs));
    refuse(text);
  };
  if (s.dt < robot.dt) {
    char text[192];
    std::snprintf(text, sizeof text,
                  "skinctl: dt: %.9g ms in the law, but in late cycles of the robot's description it is "
                  "evaluated every "
                  "%.9g ms: tracking_settings(robot) takes it from there",
                  milliseconds(s.dt), milliseconds(robot.dt));
    refuse(text);
  }
  if (s.delay_in_loop() < robot.loop_delay) {
    char text[192];
    std::snprintf(text, sizeof text,
                  "skinctl: loop_delay: %.9g ms in the law, %.9g ms by the robot's description: "
                  "tracking_settings(robot) takes it from there",
                  milliseconds(s.delay_in_loop()), milliseconds(robot.loop_delay));
    refuse(text);
  }
  const auto &ours = s.virtual_dynamics, &theirs = robot.virtual_dynamics;
  same("virtual damping", ours.damping, theirs.damping);
  for (std::size_t i = 0; i < N; ++i) {
    same("virtual inertia", ours.inertia[i], theirs.inertia[i]);
    same("viscous friction", ours.viscous[i], theirs.viscous[i]);
  }
}
/// Throws `ConfigurationError` where a limit of jerk would leave the robot swinging about its goal for ever
/// after a touch: `(lambda + k) K_c (A/J)^2 > 1` of a joint that viscous friction slows at the rate k [1/s],
/// A/J the time in which the jerk builds up its acceleration.
template <std::size_t N, Real T>
SKINCTL_COLD void check_for(const JointControlSettings<N, T>& s, const JerkTerms<N, T>& limit) {
  for (std::size_t i = 0; i < N; ++i) {
    const T all = (s.lambda + limit.friction[i]) * s.K_c * limit.rise[i] * limit.rise[i];
    if (all <= T(1) + T(64) * std::numeric_limits<T>::epsilon()) continue;
    char text[224];
    std::snprintf(
        text, sizeof text,
        "skinctl: MaxJerk: (lambda + friction) K_c (A/J)^2 = %.9g of joint %zu, allowed: at most 1, else a "
        "touch may leave the arm swinging: tracking_settings(robot, jerk) gives gains that fit",
        static_cast<double>(all), i);
    refuse(text);
  }
}

SKINCTL_END_NAMESPACE
