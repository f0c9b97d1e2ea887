// SPDX-License-Identifier: BSD-3-Clause
// From the motion of a virtual robot to the force that its law gets: delays, lag, and cycles that hold.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The path of a contact's loop from the virtual robot's position to the law's torque, but for gains, at the
/// frequency w [1/s]: `(1 + T_lead (1 - exp(-s h))/h) exp(-s t_skin) x cot(x) H`, where h is a sub-step, x =
/// w dt/2 stands for forces that are linear between samples, and H is the robot as cycles see it:
///
///     H = exp(-s (T_d + m)) (1 - e^(-m/tau) + e^(-m/tau) (1 - e^(-dt/tau)) / (exp(s dt) - e^(-dt/tau)))
///
/// with the declared delay T_d, the lag tau and the period dt. Commands are held; behind delay and lag they
/// wait for the cycle that sees them, m, up to a period. A command that arrives together with a cycle may
/// just have missed it: with a delay of whole periods m is a period.
template <Real T>
class ContactPath {
 public:
  /// A frequency [1/s] and the path there.
  struct Point {
    T w;
    std::complex<T> way;
  };

  template <std::size_t N>
  ContactPath(const RobotConfiguration<N, T>& c, Nanoseconds skin_delay)
      : period_(seconds<T>(c.period)),
        substep_(seconds<T>(planned_substep(c.period, c.substep))),
        lead_(seconds<T>(c.leads_force_by())),
        skin_delay_(seconds<T>(skin_delay)),
        seen_(seconds<T>((c.delay / c.period + 1) * c.period)) {
    using std::exp;
    if (c.lag > 0ns) {
      rest_ = exp((seconds<T>(c.delay) - seen_) / seconds<T>(c.lag));
      decay_ = exp(-period_ / seconds<T>(c.lag));
    }
    for (T w = T(first) / total_delay(); w < last(); w *= T(step)) grid_.push_back({w, at(w)});
    grid_.push_back({last(), at(last())});
  }
  [[nodiscard]] std::complex<T> at(const T& w) const {
    const std::complex<T> z = std::polar(T(1), w * period_);
    using std::tan;
    const T x = T(0.5) * w * period_;
    return std::complex<T>(x / tan(x)) *
           (T(1) + lead_ / substep_ * (T(1) - std::polar(T(1), -w * substep_))) *
           std::polar(T(1), -w * (seen_ + skin_delay_)) *
           (T(1) - rest_ + rest_ * (T(1) - decay_) / (z - decay_));
  }
  /// The delay of the path for slow motion [s]: `T_d + t_skin + tau + dt/2` or a little more.
  [[nodiscard]] T total_delay() const noexcept {
    return seen_ + skin_delay_ + rest_ * period_ / (T(1) - decay_);
  }
  /// The highest frequency of interest [rad/s]: the one that cycles see, or that of `negligible`.
  [[nodiscard]] T last() const noexcept {
    const T nyquist = T(3.14159265358979323846) / period_, beyond = T(negligible) / total_delay();
    return beyond < nyquist ? beyond : nyquist;
  }
  [[nodiscard]] const std::vector<Point>& grid() const noexcept { return grid_; }

 private:
  /// Lowest frequency looked at, times the total delay [rad]: a contact that crosses below it is 1/40 000 as
  /// stiff as one that crosses at 1.
  static constexpr double first = 5e-3;
  /// Ratio of frequencies that follow each other: at 1 rad the delay turns by 7 degrees in between.
  static constexpr double step = 1.12;
  /// Highest frequency of interest, times the total delay [rad]: the response of a mass is 1/400 there.
  static constexpr double negligible = 20;

  T period_, substep_, lead_, skin_delay_;
  T seen_;                        ///< T_d + m: time until a cycle can see a command [s]
  T rest_ = T(0), decay_ = T(0);  ///< shares of a step that the lag leaves after m, and after a period
  std::vector<Point> grid_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
