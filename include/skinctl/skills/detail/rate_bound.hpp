// SPDX-License-Identifier: BSD-3-Clause
// A bound on the rate of a torque; the difference from the laws' torque is carried until it is made up.
#pragma once

#include "skinctl/law/law.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A bound on the rate of the laws' torque. Per joint, with `stay` the torque at which the sum would not
/// change if the touch did not:
///
///     out = clamp(own, stay - R dt, stay + R dt)
///
/// and the difference from `own` is carried on until it is made up.
template <std::size_t N>
struct RateBound {
  std::array<double, N> stay{};  ///< torque that would stay [N m]
  bool lags = false;             ///< a difference is carried
  bool winds = false;            ///< difference above 10 ms of the bound: laws in a closed loop would wind up

  /// The torque to add to `own` [N m] for an interval in which the torque may change by `most`.
  template <class T>
  [[nodiscard]] JointTorque<N, T> missing(const JointTorque<N, T>& own, const T& most) const noexcept {
    JointTorque<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      const T middle = static_cast<T>(stay[i]), high = middle + most, low = middle - most;
      out[i] = own[i] > high ? T(high - own[i]) : own[i] < low ? T(low - own[i]) : T(0);
    }
    return out;
  }
  /// Updates the bound after an interval with the torque `own + added`. `moved`: the change of the skin's
  /// torque until the next interval by changing weights, under a constant touch. Numbers that are not finite
  /// are dropped.
  /// @param rate  R, whatever is added [N m/s].
  template <class T>
  void follow(const JointTorque<N, T>& own, const JointTorque<N, T>& added, const JointTorque<N, T>& moved,
              double rate) noexcept {
    lags = winds = false;
    for (std::size_t i = 0; i < N; ++i) {
      const double size = static_cast<double>(detail::magnitude(added[i]));
      lags = lags || size > 0;
      winds = winds || size > 0.01 * rate;
      const double next = static_cast<double>(own[i] + added[i] - moved[i]);
      if (next - next == 0) stay[i] = next;
    }
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
