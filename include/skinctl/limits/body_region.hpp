// SPDX-License-Identifier: BSD-3-Clause
// Limits of force for one region of a person's body, and the speed at which a robot may meet it.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The limits of power and force for one region of the body, in the form of ISO/TS 15066.
///
/// **Not a safety-rated function.** It slows a robot by given limits; it replaces neither a risk assessment
/// nor the robot's own safety system. No number is shipped: each field starts as NaN or a negative time,
/// which is refused, and its value is the user's own.
struct BodyRegion {
  static constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  static constexpr Nanoseconds unset_time = Nanoseconds::min();
  double force = unset;            ///< F_q: largest quasi-static force [N]
  double blow = unset;             ///< F_t: largest transient force [N], >= `force`
  Nanoseconds first = unset_time;  ///< duration of the transient phase
  double stiffness = unset;        ///< k: stiffness of the region, in series with the robot's cover [N/m]
  double mass = unset;             ///< m_H: mass of the region [kg]; infinity if it cannot give way
  double power = std::numeric_limits<double>::infinity();  ///< largest power of a contact [W]

  /// Throws `ConfigurationError` for a number that is out of its range, or was not given.
  SKINCTL_COLD void check() const {
    constexpr double big = std::numeric_limits<double>::max();
    require(force > 0 && force <= big, "BodyRegion: force", force, "> 0 N, finite: your own number");
    require(blow >= force && blow <= big, "BodyRegion: blow", blow, ">= force N, finite: your own number");
    require(first >= 0ns && first <= 60s, "BodyRegion: first", seconds<double>(first),
            "0 to 60 s: your own number");
    require(stiffness > 0 && stiffness <= 1e9, "BodyRegion: stiffness", stiffness,
            "> 0, <= 1e9 N/m: your own number");
    require(mass > 0, "BodyRegion: mass", mass, "> 0 kg, infinity if it cannot give way: your own number");
    require(power > 0, "BodyRegion: power", power, "> 0 W");
  }
};

/// `mu = 1 / (1/m_H + 1/m_R)` [kg]: the reduced mass of two bodies that collide.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T reduced_mass(const T& body, const T& robot) noexcept {
  return T(1) / (T(1) / body + T(1) / robot);
}

/// The speed [m/s] at which a robot of mass `robot` [kg] may meet the region: its spring then peaks at the
/// transient force limit, `1/2 mu v^2 = F_t^2 / (2 k)`.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T speed_of_blow(const BodyRegion& region, const T& robot) noexcept {
  using std::sqrt;
  return T(region.blow) / sqrt(reduced_mass(T(region.mass), robot) * T(region.stiffness));
}

/// Speed and separation: the speed of a person, and how the robot stops.
struct Separation {
  double body_speed = BodyRegion::unset;               ///< v_H: speed of the person towards the robot [m/s]
  Nanoseconds reaction_time = BodyRegion::unset_time;  ///< T_R: time until the robot begins to brake
  double deceleration = BodyRegion::unset;  ///< a: smallest deceleration of any point of the robot [m/s^2]
  double margin = BodyRegion::unset;        ///< C + Z: distance to keep, with all uncertainties [m]

  SKINCTL_COLD void check() const {
    require(body_speed >= 0 && body_speed <= 100, "Separation: body speed", body_speed, "0 to 100 m/s");
    require(reaction_time >= 0ns && reaction_time <= 10s, "Separation: reaction_time",
            seconds<double>(reaction_time), "0 to 10 s");
    require(deceleration > 0 && deceleration <= 1e4, "Separation: deceleration", deceleration,
            "> 0, <= 1e4 m/s^2");
    require(margin >= 0 && margin <= 100, "Separation: margin", margin, "0 to 100 m");
  }
};

/// The speed [m/s] from which the robot comes to rest before a person, `distance` away now, is as near as the
/// margin: `S = v_H (T_R + v/a) + v T_R + v^2/(2 a) + C`. 0 if there is no such speed.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T speed_of_separation(const Separation& s, const T& distance) noexcept {
  const T a = T(s.deceleration), v = T(s.body_speed), t = seconds<T>(s.reaction_time);
  return speed_to_stop(T(distance - T(s.margin) - v * t), T(t + v / a), a);
}

SKINCTL_END_NAMESPACE
