// SPDX-License-Identifier: BSD-3-Clause
// A subset of a robot's joints, chosen at compile time.
#pragma once

#include <bit>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/link_mask.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The joints `from` to `to - 1` as a set, bit i for joint i.
[[nodiscard]] constexpr LinkMask joints_between(std::size_t from, std::size_t to) noexcept {
  LinkMask set = 0;
  for (std::size_t i = from; i < to && i < 64; ++i) set |= LinkMask(1) << i;
  return set;
}

/// The joints of `Set` among `N`, in their order. The number of joints of a subset is part of the types:
/// `JointTorque<16>` for a hand, `JointVelocity<6>` for its arm.
template <std::size_t N, LinkMask Set>
struct JointSubset {
  static_assert(N <= 64 && (Set & ~joints_between(0, N)) == 0,
                "the set names a joint that the robot has not");
  static constexpr std::size_t count = static_cast<std::size_t>(std::popcount(Set));
  /// Joint `index[k]` of the robot is joint k of the subset.
  static constexpr std::array<std::size_t, count> index = [] {
    std::array<std::size_t, count> out{};
    std::size_t k = 0;
    for (std::size_t i = 0; i < N; ++i)
      if ((Set >> i) & 1u) out[k++] = i;
    return out;
  }();
  using Others = JointSubset<N, joints_between(0, N) & ~Set>;
  /// Whether the subset holds every joint of the robot.
  static constexpr bool is_all = count == N;
  static constexpr LinkMask set = Set;
  /// The index of joint `i` in the subset; of a joint that is not in it, the number of its joints
  /// before `i`.
  [[nodiscard]] static constexpr std::size_t place(std::size_t i) noexcept {
    return static_cast<std::size_t>(std::popcount(Set & joints_between(0, i)));
  }

  /// The elements of `whole` for the joints of the subset.
  template <class Kind, Scalar T>
    requires is_all
  [[nodiscard]] static SKINCTL_INLINE constexpr const JointVector<Kind, N, T>& of(
      const JointVector<Kind, N, T>& whole) noexcept {
    return whole;
  }
  template <class Kind, Scalar T>
    requires(!is_all)
  [[nodiscard]] static SKINCTL_INLINE constexpr JointVector<Kind, count, T> of(
      const JointVector<Kind, N, T>& whole) noexcept {
    return JointVector<Kind, count, T>::generate([&](std::size_t k)
                                                     SKINCTL_INLINE_LAMBDA { return whole[index[k]]; });
  }
  /// Writes `part` to the joints of the subset; the other joints keep their values.
  template <class Kind, Scalar T>
  static SKINCTL_INLINE constexpr void put(const JointVector<Kind, count, T>& part,
                                           JointVector<Kind, N, T>& whole) noexcept {
    for (std::size_t k = 0; k < count; ++k) whole[index[k]] = part[k];
  }
};

/// All joints of a robot.
template <std::size_t N>
using AllJoints = JointSubset<N, joints_between(0, N)>;

SKINCTL_END_NAMESPACE
