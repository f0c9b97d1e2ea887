// Poses of the links that a scene asks for.
#pragma once

#include "skinctl/frames/transform.hpp"
#include "skinctl/kinematics/joint_frame.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `X_BaseLink` of the links in `Mask`, eq. (2), computed when it is built; nothing else is stored, and no
/// joint that carries none of them is touched. Trivially copyable.
///
/// The axes are orthonormal to within the rounding of the sines and cosines times the depth of the tree. A
/// NaN in q gives NaN poses of the links that the joint carries.
template <Model M, LinkMask Mask, Scalar T = double>
class Poses {
 public:
  static constexpr LinkMask mask = Mask;
  static_assert((Mask & ~all_links(M::joints)) == 0, "the mask names a link that the model does not have");

  template <LinkMask A>
  SKINCTL_INLINE Poses(const M& model, const JointAngles<M, T, A>& angles) noexcept {
    constexpr Triple x{Known<1>{}, Known<0>{}, Known<0>{}};
    constexpr Triple y{Known<0>{}, Known<1>{}, Known<0>{}};
    detail::for_each_link<children<M, -1>>([&](auto link) SKINCTL_INLINE_LAMBDA {
      place<link.value>(model, angles, x, y, UnitZ{}, ZeroTriple{});
    });
  }
  SKINCTL_INLINE Poses(const M& model, const JointPosition<M::joints, T>& q) noexcept
      : Poses(model, JointAngles<M, T, Mask>(model, q)) {}

  /// Pose of link `I` in the base. A link that was not asked for does not compile.
  template <std::size_t I>
  [[nodiscard]] SKINCTL_INLINE Transform<Base, Link<I>, T> get() const noexcept {
    static_assert((Mask >> I) & 1u, "this link's pose was not asked for: add it to the mask of links");
    const Place& at = places_[slot(I)];
    return Transform<Base, Link<I>, T>::trusted({at.x, at.y, at.z}, at.p);
  }

 private:
  struct Place {
    Xyz<T> x, y, z, p;
  };
  static constexpr std::size_t slot(std::size_t i) noexcept {
    return static_cast<std::size_t>(std::popcount(Mask & ((LinkMask(1) << i) - 1)));
  }

  /// Places link `I`, given the axes and origin of its parent, then its children that are needed.
  template <std::size_t I, class A, class X, class Y, class Z, class O>
  SKINCTL_INLINE void place(const M& model, const A& angles, const X& x, const Y& y, const Z& z,
                            const O& o) noexcept {
    if constexpr ((closure<M>(Mask) >> I) & 1u) {
      const auto frame = joint_frame<I>(model, angles);
      const auto p = o + frame.p.x * x + frame.p.y * y + frame.p.z * z;
      const auto x1 = frame.gamma.cos * x + frame.gamma.sin * y;
      const auto y1 = frame.gamma.cos * y - frame.gamma.sin * x;
      const auto y2 = frame.alpha.cos * y1 + frame.alpha.sin * z;
      const auto z2 = frame.alpha.cos * z - frame.alpha.sin * y1;
      const auto x3 = frame.theta.cos * x1 + frame.theta.sin * y2;
      const auto y3 = frame.theta.cos * y2 - frame.theta.sin * x1;
      if constexpr ((Mask >> I) & 1u) {
        Place& at = places_[slot(I)];
        assign(at.x, x3), assign(at.y, y3), assign(at.z, z2), assign(at.p, p);
      }
      detail::for_each_link<children<M, int(I)>>(
          [&](auto link) SKINCTL_INLINE_LAMBDA { place<link.value>(model, angles, x3, y3, z2, p); });
    }
  }
  Place places_[Mask == 0 ? 1 : static_cast<std::size_t>(std::popcount(Mask))];
};

/// The poses of the links in `Mask` (all by default) at `q`.
template <LinkMask Mask = ~LinkMask(0), Model M, Scalar T>
[[nodiscard]] SKINCTL_INLINE auto link_poses(const M& model, const JointPosition<M::joints, T>& q) noexcept {
  return Poses < M, Mask & all_links(M::joints), T > (model, q);
}
// clang-format off
template <LinkMask Mask = ~LinkMask(0), Model M, Scalar T> requires(!computes_in<M, T>)
void link_poses(const M&, const JointPosition<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
// clang-format on

SKINCTL_END_NAMESPACE
