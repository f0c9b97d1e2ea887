// SPDX-License-Identifier: BSD-3-Clause
// Robots on robots: a hand on an arm, two arms on one base.
#pragma once

#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A base without a robot, for others to be attached to. Gravity along -z.
struct BareBase {
  static constexpr std::size_t joints = 0;
  static constexpr std::array<int, 1> parents = {-1};  // not read: there are no joints
  static constexpr std::array<JointKind, 1> kinds = {JointKind::revolute};
  template <Scalar T>
  static SKINCTL_INLINE constexpr auto gravity() noexcept {
    return Triple{TypedConstant<0>{}, TypedConstant<0>{}, T(-9.81)};
  }
};

/// Pose of a body in the frame of the body that carries it.
struct Stand {
  Rotation<double> R{};     ///< axes of the body in the carrier's frame
  double p[3] = {0, 0, 0};  ///< origin of the body in the carrier's frame [m]
};

/// The tree `B` with its base fixed to link `At` of the tree `A` (-1: its base): the links of `A` keep their
/// numbers, those of `B` come after them.
template <class A, int At, class B>
struct AttachedTree {
  static_assert(At >= -1 && At < static_cast<int>(A::joints), "the trunk has no such link");
  static_assert(A::joints + B::joints <= 64, "more than 64 joints");
  static constexpr std::size_t trunk = A::joints;
  static constexpr std::size_t joints = A::joints + B::joints;
  static constexpr auto parents = [] {
    std::array<int, joints> p{};
    for (std::size_t i = 0; i < trunk; ++i) p[i] = A::parents[i];
    for (std::size_t i = 0; i < B::joints; ++i)
      p[trunk + i] = B::parents[i] < 0 ? At : B::parents[i] + static_cast<int>(trunk);
    return p;
  }();
  static constexpr auto kinds = [] {
    std::array<JointKind, joints> k{};
    for (std::size_t i = 0; i < trunk; ++i) k[i] = A::kinds[i];
    for (std::size_t i = 0; i < B::joints; ++i) k[trunk + i] = B::kinds[i];
    return k;
  }();
};

/// The model `B` attached to link `At` of the model `A`, itself a model: a static arm stays static, a
/// calibrated hand calibrated. Both keep their frames, so a patch or tool fixed to a link stays valid. Only
/// the placement of the first links of `B` is computed, once. Gravity is that of `A`.
template <class A, int At, RobotModel B, Scalar T = double>
class Attached : public AttachedTree<A, At, B> {
  using Tree = AttachedTree<A, At, B>;
  static_assert(!detail::SaysMovingBase<A> && !detail::SaysMovingBase<B>,
                "OnMovingBase goes outside: OnMovingBase(attach<5>(arm, hand))");

 public:
  using scalar = T;

  /// @param stand  pose of the base of `B` in link `At`. Throws `ConfigurationError` for axes that are no
  ///               rotation (error above 1e-6), and an origin beyond 1e6 m.
  Attached(const A& a, const B& b, const Stand& stand = {}) : a_(a), b_(b) {
    require(rotation_error(stand.R) <= 1e-6, "|R'R - 1| of a stand", rotation_error(stand.R), "<= 1e-6");
    for (const double x : stand.p) require(x >= -1e6 && x <= 1e6, "origin of a stand", x, "within 1e6 m");
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      (place<children<B, -1>[K]>(roots_[K], stand), ...);
    }(std::make_index_sequence<roots>{});
  }

  template <std::size_t Ix, LinkParameter P, Scalar U>
  SKINCTL_INLINE constexpr auto number() const noexcept {
    if constexpr (Ix < Tree::trunk) {
      return a_.template number<Ix, P, U>();
    } else if constexpr (B::parents[Ix - Tree::trunk] < 0 && P < LinkParameter::mass) {
      static_assert(std::same_as<U, T>, "an attached model computes in the scalar that it stores");
      return T(roots_[root(Ix - Tree::trunk)][std::size_t(P)]);
    } else {
      return b_.template number<Ix - Tree::trunk, P, U>();
    }
  }
  [[nodiscard]] constexpr bool masses_assumed() const noexcept {
    if constexpr (A::joints > 0)
      if (has_assumed_masses(a_)) return true;
    return has_assumed_masses(b_);
  }
  template <Scalar U>
  SKINCTL_INLINE constexpr auto gravity() const noexcept {
    return a_.template gravity<U>();
  }

 private:
  static constexpr std::size_t roots = children<B, -1>.size();
  using Placement = std::array<T, std::size_t(LinkParameter::mass)>;

  static constexpr std::size_t root(std::size_t i) noexcept {
    std::size_t k = 0;
    while (children<B, -1>[k] != i) ++k;
    return k;
  }
  template <std::size_t Ix>
  void place(Placement& out, const Stand& stand) const {
    const auto l =
        placed_at(numbers_of<Ix, T>(b_), B::kinds[Ix], stand.R, {stand.p[0], stand.p[1], stand.p[2]});
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = T(l.numbers[k]);
  }

  [[no_unique_address]] A a_;
  [[no_unique_address]] B b_;
  std::array<Placement, roots> roots_;
};

/// Attaches `B` to link `At` of `A`.
template <int At, Scalar T = double, class A, RobotModel B>
[[nodiscard]] Attached<A, At, B, T> attach(const A& a, const B& b, const Stand& stand = {}) {
  return Attached<A, At, B, T>(a, b, stand);
}

SKINCTL_END_NAMESPACE
