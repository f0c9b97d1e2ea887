// Has the way to the robot and back become longer than it was at the start, when the loop's delay was
// declared?
#pragma once

#include <algorithm>

namespace compliant_ur5 {

/// Judges once a cycle, from the round trip that the robot's program echoes
/// (`adapters::ur5::Driver::round_trip`). What a network does to single packets is no fault: a trip counts as
/// longer once it has been for `lasting`, less the time in which it was not.
class DelayJudge {
 public:
  static constexpr double start =
      0.5;  ///< from the first cycle on, in which the usual round trip is found [s]
  /// `lasting` by position or velocity: longer than one time-out of TCP, which is 200 ms [s].
  static constexpr double beyond_time_out = 0.25;
  /// The same by torque, where the robot stops by itself when commands time out, and delay shakes the arm
  /// sooner [s].
  static constexpr double by_torque = 0.1;

  /// @param period   of states and commands [s]: a trip without any network takes one or two.
  /// @param network  declared to the loop: to the robot and back, beyond that [s].
  /// @param margin   beyond what was usual at the start [s].
  /// @param lasting  see above [s].
  DelayJudge(double period, double network, double margin, double lasting) noexcept
      : declared_(2 * period + network), margin_(margin), lasting_(lasting) {}

  /// @param t     since the first cycle [s].
  /// @param dt    since the last one [s].
  /// @param trip  newest round trip [s]; negative: not known, and nothing is judged.
  void cycle(double t, double dt, double trip) noexcept {
    if (!(trip >= 0)) return;
    if (t < start) shortest_ = std::min(shortest_, trip);
    longer_ = std::clamp(longer_ + (trip > usual() + margin_ ? dt : -dt), 0.0, lasting_);
    if (longer_ > 0) trip_ = trip;
  }

  [[nodiscard]] bool late() const noexcept { return longer_ >= lasting_; }
  /// The newest round trip that was too long [s].
  [[nodiscard]] double trip() const noexcept { return trip_; }
  /// The shortest one of the start, and at most what is declared [s].
  [[nodiscard]] double usual() const noexcept { return std::min(shortest_, declared_); }

 private:
  double declared_, margin_, lasting_;
  double shortest_ = 1e9, trip_ = 0, longer_ = 0;
};

}  // namespace compliant_ur5
