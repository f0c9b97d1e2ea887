// SPDX-License-Identifier: BSD-3-Clause
// The numbers of the cycles of a scene.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/recording/cycle_hand_over.hpp"
#include "skinctl/recording/cycle_numbers.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The numbers of the cycles of a scene, one after the other.
template <class C>
class NumbersOf {
 public:
  static constexpr std::size_t joints = C::joints;
  static constexpr std::size_t laws = std::tuple_size_v<decltype(C::Output::shares)>;

  /// The numbers of the cycle `r`: views into this object and into `r`.
  [[nodiscard]] CycleNumbers operator()(const CycleRecord<C>& r) {
    for (std::size_t i = 0; i < joints; ++i) {
      q_[i] = static_cast<double>(r.input.measured.q[i]);
      dq_[i] = static_cast<double>(r.input.measured.dq[i]);
      torque_[i] = static_cast<double>(r.command.torque[i]);
      for (std::size_t k = 0; k < laws; ++k) shares_[k * joints + i] = static_cast<double>(r.shares[k][i]);
    }
    return {r.number, r.input.now, r.input.measured.time, q_, dq_, torque_, shares_, r.input.samples, r.times,
            r.status, r.bytes};
  }

 private:
  std::array<double, joints> q_{}, dq_{}, torque_{};
  std::array<double, laws * joints> shares_{};
};

SKINCTL_END_NAMESPACE
