// SPDX-License-Identifier: BSD-3-Clause
// Poses of the requested links.
#pragma once

#include "skinctl/frames/transform.hpp"
#include "skinctl/kinematics/joint_frame.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Axes and origin of a link along the axes of the base.
template <class X, class Y, class Z, class P>
struct Place {
  X x;
  Y y;
  Z z;
  P p;
};
template <class X, class Y, class Z, class P>
Place(X, Y, Z, P) -> Place<X, Y, Z, P>;

using BasePlace = Place<Triple<TypedConstant<1>, TypedConstant<0>, TypedConstant<0>>,
                        Triple<TypedConstant<0>, TypedConstant<1>, TypedConstant<0>>, UnitZ, ZeroTriple>;
/// The place of the base: a constant, because Clang 16 crashes where it initialises an aggregate none of
/// whose members has a byte.
inline constexpr BasePlace base_place{};

/// The pose of a link from that of its parent.
template <class Frame, class Parent>
SKINCTL_INLINE constexpr auto placed(const Frame& frame, const Parent& in) noexcept {
  const auto x1 = frame.gamma.cos * in.x + frame.gamma.sin * in.y;
  const auto y1 = frame.gamma.cos * in.y - frame.gamma.sin * in.x;
  const auto y2 = frame.alpha.cos * y1 + frame.alpha.sin * in.z;
  const auto z2 = frame.alpha.cos * in.z - frame.alpha.sin * y1;
  return Place{frame.theta.cos * x1 + frame.theta.sin * y2, frame.theta.cos * y2 - frame.theta.sin * x1,
               by_component(z2), in.p + frame.p.x * in.x + frame.p.y * in.y + frame.p.z * in.z};
}

/// The type of a link's pose: its typed constants follow from the type of the model.
template <std::size_t Ix, RobotModel M, Scalar T>
struct PlaceOf {
  static constexpr auto parent() noexcept {
    if constexpr (M::parents[Ix] < 0) {
      return std::type_identity<BasePlace>{};
    } else {
      return std::type_identity<typename PlaceOf<std::size_t(M::parents[Ix]), M, T>::type>{};
    }
  }
  using type =
      decltype(placed(joint_frame<Ix>(std::declval<const M&>(), std::declval<const JointAngles<M, T>&>()),
                      std::declval<const typename decltype(parent())::type&>()));
};

/// `x`, or the typed constant `K` if it is one.
template <ScalarOrConstant K, Scalar T>
SKINCTL_INLINE constexpr auto known_or(const T& x) noexcept {
  if constexpr (is_known<K>) {
    return K{};
  } else {
    return x;
  }
}
template <Scalar T, class X, class Y, class Z>
SKINCTL_INLINE constexpr auto known_or(const Xyz<T>& v, std::type_identity<Triple<X, Y, Z>>) noexcept {
  return Triple{known_or<X>(v.x), known_or<Y>(v.y), known_or<Z>(v.z)};
}

}  // namespace detail

/// Poses `X_BaseLink` of the links in `Mask`, eq. (2), computed at construction; nothing else is stored, and
/// joints that carry none of these links are not read. Trivially copyable.
///
/// Of a UR5 every number of the tool's pose is within 2.8e-15 (float: 1.5e-6) of the exact one at every state
/// (1, m; proven, `bench/studies/bounds`).
///
/// The axes are orthonormal to within the rounding of the sines and cosines times the depth of the tree. A
/// NaN in q gives NaN poses of the links that the joint carries.
template <RobotModel M, LinkMask Mask, Scalar T = double>
class Poses {
 public:
  static constexpr LinkMask mask = Mask;
  static_assert((Mask & ~all_links(M::joints)) == 0, "the mask names a link that the model does not have");

  template <LinkMask A>
  SKINCTL_INLINE Poses(const M& model, const JointAngles<M, T, A>& angles) noexcept {
    detail::for_each_link<children<M, -1>>(
        [&](auto link) SKINCTL_INLINE_LAMBDA { compute<link.value>(model, angles, detail::base_place); });
  }
  SKINCTL_INLINE Poses(const M& model, const JointPosition<M::joints, T>& q) noexcept
      : Poses(model, JointAngles<M, T, Mask>(model, q)) {}

  /// Pose of link `Ix` in the base. A link outside `Mask` does not compile.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE Transform<Base, Link<Ix>, T> get() const noexcept {
    const Stored& at = stored<Ix>();
    return Transform<Base, Link<Ix>, T>::trusted({at.x, at.y, at.z}, at.p);
  }

  /// Axes and origin of link `Ix` along the axes of the base; typed constants of the model's type stay typed.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE auto place() const noexcept {
    using Typed = typename detail::PlaceOf<Ix, M, T>::type;
    const Stored& at = stored<Ix>();
    return detail::Place{detail::known_or(at.x, std::type_identity<decltype(Typed::x)>{}),
                         detail::known_or(at.y, std::type_identity<decltype(Typed::y)>{}),
                         detail::known_or(at.z, std::type_identity<decltype(Typed::z)>{}),
                         detail::known_or(at.p, std::type_identity<decltype(Typed::p)>{})};
  }

 private:
  using Stored = detail::Place<Xyz<T>, Xyz<T>, Xyz<T>, Xyz<T>>;

  static constexpr std::size_t slot(std::size_t i) noexcept {
    return static_cast<std::size_t>(std::popcount(Mask & ((LinkMask(1) << i) - 1)));
  }

  template <std::size_t Ix>
  SKINCTL_INLINE const Stored& stored() const noexcept {
    static_assert((Mask >> Ix) & 1u, "this link's pose was not asked for: add it to the mask of links");
    return places_[slot(Ix)];
  }

  /// Computes link `Ix` from the pose of its parent, then its needed children.
  template <std::size_t Ix, class A, class Parent>
  SKINCTL_INLINE void compute(const M& model, const A& angles, const Parent& parent) noexcept {
    if constexpr ((closure<M>(Mask) >> Ix) & 1u) {
      const auto own = detail::placed(joint_frame<Ix>(model, angles), parent);
      if constexpr ((Mask >> Ix) & 1u) {
        Stored& at = places_[slot(Ix)];
        assign(at.x, own.x), assign(at.y, own.y), assign(at.z, own.z), assign(at.p, own.p);
      }
      detail::for_each_link<children<M, int(Ix)>>(
          [&](auto link) SKINCTL_INLINE_LAMBDA { compute<link.value>(model, angles, own); });
    }
  }
  Stored places_[Mask == 0 ? 1 : static_cast<std::size_t>(std::popcount(Mask))];
};

/// The poses of the links in `Mask` (all by default) at `q`.
template <LinkMask Mask = ~LinkMask(0), RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE auto link_poses(const M& model, const JointPosition<M::joints, T>& q) noexcept {
  return Poses < M, Mask & all_links(M::joints), T > (model, q);
}
// clang-format off
template <LinkMask Mask = ~LinkMask(0), RobotModel M, Scalar T> requires(!computes_in<M, T>)
void link_poses(const M&, const JointPosition<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
template <LinkMask Mask = ~LinkMask(0), RobotModel M, class... Q> requires(any_eigen<Q...>)
void link_poses(const M&, const Q&...) = delete;  // an Eigen vector has no kind: name it, JointPosition<N>(v)
// clang-format on

SKINCTL_END_NAMESPACE
