// What one region of a person's body bears, and how fast a robot may be that could meet it.
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
/// **Not a safety-rated function.** It slows a robot that is told what a person bears; it does not replace a
/// risk assessment, nor the robot's own safety system. No number is shipped: each field starts as NaN or a negative time, which
/// is refused, and what stands in it is the user's own.
struct BodyRegion {
  static constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  static constexpr Nanoseconds unset_time = Nanoseconds::min();
  double force = unset;            ///< F_q: most force while pressed [N]
  double blow = unset;             ///< F_t: most force in the first moments [N], >= `force`
  Nanoseconds first = unset_time;  ///< how long the first moments last
  double stiffness = unset;        ///< k: of the region with what covers the robot [N/m]
  double mass = unset;             ///< m_H: of the region [kg]; infinity if it cannot give way
  double power = std::numeric_limits<double>::infinity();  ///< most that a contact takes [W]

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

/// `mu = 1 / (1/m_H + 1/m_R)` [kg]: the mass with which two bodies meet.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T reduced_mass(const T& body, const T& robot) noexcept {
  return T(1) / (T(1) / body + T(1) / robot);
}

/// The speed [m/s] at which `robot` [kg] may meet the region: its spring then peaks at the force of a blow,
/// `1/2 mu v^2 = F_t^2 / (2 k)`.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T speed_of_blow(const BodyRegion& region, const T& robot) noexcept {
  using std::sqrt;
  return T(region.blow) / sqrt(reduced_mass(T(region.mass), robot) * T(region.stiffness));
}

/// Speed and separation: how somebody may come near, and how the robot stops.
struct Separation {
  double body_speed = BodyRegion::unset;          ///< v_H: of the person towards the robot [m/s]
  Nanoseconds reaction = BodyRegion::unset_time;  ///< T_R: until the robot begins to brake
  double deceleration = BodyRegion::unset;        ///< of any point of the robot, at least [m/s^2]
  double margin = BodyRegion::unset;              ///< C + Z: what is kept, with all uncertainties [m]

  SKINCTL_COLD void check() const {
    require(body_speed >= 0 && body_speed <= 100, "Separation: body speed", body_speed, "0 to 100 m/s");
    require(reaction >= 0ns && reaction <= 10s, "Separation: reaction", seconds<double>(reaction),
            "0 to 10 s");
    require(deceleration > 0 && deceleration <= 1e4, "Separation: deceleration", deceleration,
            "> 0, <= 1e4 m/s^2");
    require(margin >= 0 && margin <= 100, "Separation: margin", margin, "0 to 100 m");
  }
};

/// The speed from which the robot is at rest when somebody who is `distance` away now has come as near as the
/// margin: `S = v_H (T_R + v/a) + v T_R + v^2/(2 a) + C`. 0 if there is none.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T speed_of_separation(const Separation& s, const T& distance) noexcept {
  const T a = T(s.deceleration), v = T(s.body_speed), t = seconds<T>(s.reaction);
  return speed_to_stop(T(distance - T(s.margin) - v * t), T(t + v / a), a);
}

SKINCTL_END_NAMESPACE
