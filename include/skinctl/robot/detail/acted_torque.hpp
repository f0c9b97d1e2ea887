// SPDX-License-Identifier: BSD-3-Clause
// The torque that acts now of those that were sent.
#pragma once

#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The torques of the last cycles as far as a delay reaches back. What is measured now answers the torque
/// that was sent a delay ago: the last one instead would be taken for something that resists. Trivially
/// copyable.
template <std::size_t N, Real T>
class ActedTorque {
 public:
  /// Records the torque that was sent in the last cycle, `dt` seconds ago. Of cycles shorter than a part
  /// of `delay` not each is kept: then the answer is up to that part too old.
  ///
  /// @param acted  the torque that acted since that cycle; false if none is known that old.
  SKINCTL_INLINE bool step(const JointTorque<N, T>& last, const T& dt, const T& delay,
                           JointTorque<N, T>& acted) noexcept {
    if (!(delay > T(0))) [[likely]] {
      acted = last;
      return true;
    }
    time_ += static_cast<double>(dt);
    const double part = static_cast<double>(delay) / (slots - 2);
    if (kept_ == 0 || time_ - at_[newest_] >= (1 - rounding) * part) {
      newest_ = (newest_ + 1) % slots;
      if (kept_ < slots) ++kept_;
      at_[newest_] = time_;
      sent_[newest_] = last;
    }
    const double due = time_ - static_cast<double>(delay) + rounding * part;
    for (int k = 0; k < kept_; ++k) {
      const int slot = (newest_ + slots - k) % slots;
      if (at_[slot] > due) continue;
      acted = sent_[slot];
      return true;
    }
    return false;
  }

 private:
  static constexpr int slots = 18;
  /// Share of a part that the rounding of sums of times may take.
  static constexpr double rounding = 1e-3;
  JointTorque<N, T> sent_[slots];
  double at_[slots] = {};  ///< time at which each was recorded, as a sum of cycles [s]
  double time_ = 0;        ///< sum of the cycles [s]
  int newest_ = 0, kept_ = 0;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
