// SPDX-License-Identifier: BSD-3-Clause
// The largest rate of the torque that laws ask for by themselves.
#pragma once

#include <array>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/joint_subset.hpp"
#include "skinctl/law/evaluate.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Whether a law tracks something, alone or in a sum.
template <class L, std::size_t Terms>
inline constexpr bool tracks = [] {
  for (std::size_t i = 0; i < Terms; ++i)
    if (LawTable<L>::role_of_part(i) == LawRole::tracking) return true;
  return false;
}();

/// The last torque of a law without its reactive parts. Trivially copyable.
template <std::size_t N, Real T>
struct OwnTorque {
  JointTorque<N, T> last;
  JointTorque<N, T> total;  ///< torque with the reactive parts [N m]
  bool known = false;

  /// Bounds the change of `torque` without its reactive parts since the last call by `step` to either side;
  /// the parts that answer touch pass at once, a delay would cost stability in contact. True if it acted. The
  /// first torque passes, and so does a change that leaves the whole torque where it was, such as that to
  /// other gains with the difference carried beside them.
  ///
  /// What no joint can give is cut off first. Else a law that asks for 35 times the limit took 1.4 s at 50
  /// limits a second to turn round, and with a goal it swung about it for ever.
  ///
  /// @param cut  brings a torque within the limits; true if it changed it.
  /// @tparam S  the joints of `torque`, among those of `shares`.
  template <class L, class S = AllJoints<N>, std::size_t Whole, std::size_t Terms, class Cut>
  SKINCTL_INLINE bool bound(const std::array<JointTorque<Whole, T>, Terms>& shares,
                            const JointTorque<N, T>& step, const Cut& cut,
                            JointTorque<N, T>& torque) noexcept {
    if constexpr (!tracks<L, Terms>) {
      return false;
    } else {
      using R = Row<N, T>;
      R reactive = T(0);
      for_each_index<Terms>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
        if (LawTable<L>::role_of_part(i) == LawRole::reactive) reactive = reactive + R(S::of(shares[i]));
      });
      JointTorque<N, T> possible;
      (R(torque) - reactive).store(possible);
      bool acts = cut(possible);
      const R own = possible;
      if (acts) [[unlikely]]
        (reactive + own).store(torque);
      R kept = own;
      if (known)
        kept = select(magnitude(R(torque) - R(total)) <= R(step), own,
                      clamp(own, R(last) - R(step), R(last) + R(step)));
      acts = acts || any(kept != own);
      if (acts) [[unlikely]]
        (reactive + kept).store(torque);
      kept.store(last);
      total = torque;
      known = true;
      return acts;
    }
  }
};

/// The torque of no joint.
template <Real T>
struct OwnTorque<0, T> {
  bool known = false;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
