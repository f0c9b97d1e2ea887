// SPDX-License-Identifier: BSD-3-Clause
// The placement of a link in its parent at a given joint position: one step of every recursion over a tree.
#pragma once

#include <bit>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/math/sincos.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

/// Calls `f` with the index of each link of `L` (an array), in order. What is called through it is a whole
/// subtree, which the compiler copies at every call that it inlines: so one call for a chain.
template <auto L, class F>
SKINCTL_INLINE constexpr void for_each_link(F&& f) {
  if constexpr (L.size() == 1) {
    f(std::integral_constant<std::size_t, L[0]>{});
  } else {
    [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      (f(std::integral_constant<std::size_t, L[K]>{}), ...);
    }(std::make_index_sequence<L.size()>{});
  }
}

/// Whether a joint of `Mask` is of the given kind.
template <Topology M, LinkMask Mask>
constexpr bool any_of_kind(JointKind kind) noexcept {
  for (std::size_t i = 0; i < M::joints; ++i)
    if (((Mask >> i) & 1u) && M::kinds[i] == kind) return true;
  return false;
}

/// Whether the first `Count` joints rotate by q itself, without offsets.
template <RobotModel M, Scalar T, std::size_t Count>
constexpr bool no_offsets() noexcept {
  return []<std::size_t... Ix>(std::index_sequence<Ix...>) {
    return (is_zero<decltype(std::declval<const M&>().template number<Ix, LinkParameter::offset, T>())> &&
            ...);
  }(std::make_index_sequence<Count>{});
}

}  // namespace detail

/// Sines and cosines of all joint angles, offsets included, computed at once on native lanes: the only
/// transcendental functions of a cycle. Joints behind the last link of `Mask` are left out, and so are joints
/// of `Unused` before and behind the others, if the caller knows that their angles have no effect.
template <RobotModel M, Scalar T, LinkMask Mask = all_links(M::joints), LinkMask Unused = 0>
struct JointAngles {
  static constexpr LinkMask links = closure<M>(Mask);
  static constexpr std::size_t count = static_cast<std::size_t>(std::bit_width(links));
  static constexpr std::size_t storage = count == 0 ? 1 : count;
  T sin[storage];
  T cos[storage];
  T shift[detail::any_of_kind<M, links>(JointKind::prismatic) ? storage
                                                              : 1];  ///< displacements of sliding joints [m]

  SKINCTL_INLINE JointAngles(const M& model, const JointPosition<M::joints, T>& q) noexcept {
    constexpr LinkMask turning = links & ~Unused;
    constexpr auto first = turning == 0 ? 0 : static_cast<std::size_t>(std::countr_zero(turning));
    constexpr std::size_t turns = static_cast<std::size_t>(std::bit_width(turning)) - first;
    const auto position = [&](auto i) SKINCTL_INLINE_LAMBDA {
      return T(q[i] + model.template number<i, LinkParameter::offset, T>());
    };
    if constexpr (detail::any_of_kind<M, links>(JointKind::prismatic))
      detail::unrolled<count>([&](auto i) SKINCTL_INLINE_LAMBDA { shift[i] = position(i); });
    if constexpr (turns > 0 && detail::any_of_kind<M, links>(JointKind::revolute)) {
      if constexpr (detail::no_offsets<M, T, count>()) {
        math::sincos<turns>(q.data + first, sin + first, cos + first);
      } else {
        T angles[turns];
        detail::unrolled<turns>([&](auto i) SKINCTL_INLINE_LAMBDA {
          angles[i] = position(std::integral_constant<std::size_t, i + first>{});
        });
        math::sincos<turns>(static_cast<const T*>(angles), sin + first, cos + first);
      }
    }
  }
};

/// The placement of link `Ix` in its parent: rotation `Rz(gamma) Rx(alpha) Rz(theta)` and origin, factor by
/// factor, so that a vector is rotated by at most three plane rotations and typed zeros and ones cost
/// nothing.
template <class Gamma, class Alpha, class Theta, class P>
struct JointFrame {
  Gamma gamma;  ///< first turn, about the parent's z
  Alpha alpha;  ///< second turn, about x
  Theta theta;  ///< turn of the joint, about z
  P p;          ///< origin of the link's frame in the parent's frame

  /// Coordinates in the link's axes to coordinates in the parent's axes.
  template <class V>
  SKINCTL_INLINE constexpr auto to_parent(const V& v) const noexcept {
    return turn_z(gamma, turn_x(alpha, turn_z(theta, v)));
  }
  /// Coordinates in the parent's axes to coordinates in the link's axes.
  template <class V>
  SKINCTL_INLINE constexpr auto to_link(const V& v) const noexcept {
    return turn_back_z(theta, turn_back_x(alpha, turn_back_z(gamma, v)));
  }
};
template <class G, class A, class Th, class P>
JointFrame(G, A, Th, P) -> JointFrame<G, A, Th, P>;

/// The frame of link `Ix` at the given joint angles.
template <std::size_t Ix, RobotModel M, Scalar T, LinkMask Mask, LinkMask Unused>
SKINCTL_INLINE constexpr auto joint_frame(const M& model,
                                          const JointAngles<M, T, Mask, Unused>& angles) noexcept {
  using P = LinkParameter;
  const Turn gamma{model.template number<Ix, P::cos_gamma, T>(),
                   model.template number<Ix, P::sin_gamma, T>()};
  const Turn alpha{model.template number<Ix, P::cos_alpha, T>(),
                   model.template number<Ix, P::sin_alpha, T>()};
  const Triple p{model.template number<Ix, P::p_x, T>(), model.template number<Ix, P::p_y, T>(),
                 model.template number<Ix, P::p_z, T>()};
  if constexpr (M::kinds[Ix] == JointKind::revolute) {
    return JointFrame{gamma, alpha, Turn{angles.cos[Ix], angles.sin[Ix]}, p};
  } else {
    const auto along =
        turn_z(gamma, turn_x(alpha, Triple{TypedConstant<0>{}, TypedConstant<0>{}, angles.shift[Ix]}));
    const Turn beta{model.template number<Ix, P::cos_beta, T>(), model.template number<Ix, P::sin_beta, T>()};
    return JointFrame{gamma, alpha, beta, p + along};
  }
}

SKINCTL_END_NAMESPACE
