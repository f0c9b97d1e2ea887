// A torque that moves no faster than a bound, and catches up with what the laws ask for.
#pragma once

#include "skinctl/core/law.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Per joint, with `stay` the torque at which the sum of all would stay where it was, did the touch:
///
///     out = clamp(own, stay - R dt, stay + R dt)
///
/// and what `own` then lacks or has too much is carried on until it has been caught up with.
template <std::size_t N>
struct RateBound {
  std::array<double, N> stay{};
  bool lags = false;   ///< `own` has not been caught up with
  bool winds = false;  ///< ... and is more than 10 ms away: laws in a closed loop would wind up

  /// What has to be added to `own` [N m] for an interval in which the torque may move by `most`.
  template <class T>
  [[nodiscard]] JointTorque<N, T> missing(const JointTorque<N, T>& own, const T& most) const noexcept {
    JointTorque<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      const T middle = static_cast<T>(stay[i]), high = middle + most, low = middle - most;
      out[i] = own[i] > high ? T(high - own[i]) : own[i] < low ? T(low - own[i]) : T(0);
    }
    return out;
  }
  /// After an interval with the torque `own + added`. `moved`: by how much other weights will move the skin's
  /// torque until the next, if the touch stays. What is not finite is forgotten.
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
