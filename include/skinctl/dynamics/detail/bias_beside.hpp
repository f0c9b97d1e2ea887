// SPDX-License-Identifier: BSD-3-Clause
// The bias of a virtual robot, computed beside a law's recursion.
#pragma once

#include <utility>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/dynamics/detail/recursion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The bias of the virtual robot half a sub-step ahead, for the solution that follows the laws: `C v + G`, or
/// `C v` where a law reads G, which is then added as the law read it.
///
/// A recursion of plain numbers keeps a processor's multipliers busy, and leaves half of each register empty:
/// a law that runs one computes the bias in the other half.
template <std::size_t N, Real T>
struct BiasBeside {
  JointVelocity<N, T> v;   ///< joint velocities half a sub-step ahead [rad/s]
  JointTorque<N, T> bias;  ///< bias torque, valid if `known` [N m]
  bool known = false;      ///< a law has computed it
};

/// Two numbers in one register of 16 bytes; of four floats two are not used.
template <class T>
inline constexpr bool pairs_up =
    (std::same_as<T, float> || std::same_as<T, double>) && native_lanes<T> * sizeof(T) >= 16;
template <class T>
using Pair = Lane<T, 16 / sizeof(T)>;
/// Whether a recursion over `M` can be run in pairs; one with numbers of its own computes in their scalar.
template <RobotModel M, class T>
inline constexpr bool computes_in_pairs = [] {
  if constexpr (pairs_up<T>) {
    return computes_in<M, Pair<T>>;
  } else {
    return false;
  }
}();
template <class T>
[[nodiscard]] SKINCTL_INLINE Pair<T> pair_of(const T& a, const T& b) noexcept {
  return Pair<T>(typename Pair<T>::Vector{a, b});
}

/// The motion of a law's recursion.
template <class Angles, std::size_t N, Real T>
struct RecursionMotion {
  const Angles& angles;
  const JointVelocity<N, T>& dq;
  const JointVelocity<N, T>& dq_r;
  const JointAcceleration<N, T>& ddq_r;
  T gravity;  ///< the part of gravity that counts
};

/// `run_recursion` of a law's motion into `tau`, and of the bias into `beside`, in two lanes.
/// @tparam Weighs   whether gravity counts for one of them.
/// @param ahead     the angles at which the bias is taken.
/// @param gravity   the part of gravity that counts for the bias.
template <bool Weighs, RobotModel M, class Angles, class Ahead, std::size_t N, Real T>
SKINCTL_INLINE void run_recursion_beside(const M& model, const RecursionMotion<Angles, N, T>& motion,
                                         JointTorque<N, T>& tau, const Ahead& ahead, const T& gravity,
                                         BiasBeside<N, T>& beside) noexcept {
  using P = Pair<T>;
  const auto both = [](const T& a, const T& b) SKINCTL_INLINE_LAMBDA { return pair_of(a, b); };
  const JointAngles<M, P> angles(motion.angles, ahead, both);
  P dq[N], dq_r[N], ddq_r[N], out[N];
  // A zero that the compiler does not know: for a known one GCC moves between registers by an instruction
  // that Valgrind
  // 3.19 does not have, and a cycle could not be counted.
  const T zero = beside.v[0] - beside.v[0];
  unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    dq[i] = pair_of(motion.dq[i], beside.v[i]);
    dq_r[i] = pair_of(motion.dq_r[i], beside.v[i]);
    ddq_r[i] = pair_of(motion.ddq_r[i], zero);
  });
  const auto run = [&](const auto& a0) SKINCTL_INLINE_LAMBDA {
    run_recursion<P>(model, angles, Values<P>{dq}, Values<P>{dq_r}, Values<P>{ddq_r}, a0, out);
  };
  if constexpr (Weighs) {
    run(-pair_of(motion.gravity, gravity) * model.template gravity<P>());
  } else {
    run(ZeroTriple{});
  }
  unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    tau[i] = out[i][0];
    beside.bias[i] = out[i][1];
  });
  beside.known = true;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
