// SPDX-License-Identifier: BSD-3-Clause
// How far places of a skin have moved inwards, along their normals, between two positions of a robot.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "skinctl/kinematics/poses.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Inward displacement of places of a skin on the links `Links`, between two positions of a robot.
template <RobotModel M, LinkMask Links, Scalar T>
class InwardWay {
  static constexpr std::size_t count = static_cast<std::size_t>(std::popcount(Links));

 public:
  InwardWay(const M& model, const JointPosition<M::joints, T>& before,
            const JointPosition<M::joints, T>& now) noexcept {
    const auto a = link_poses<Links>(model, before), b = link_poses<Links>(model, now);
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      ((put<Ix>(a, b)), ...);
    }(std::make_index_sequence<M::joints>{});
  }
  /// Displacement of a place against its outward normal [m], positive inwards, on the link in slot `slot`;
  /// `place` [m] and `normal` along the link's axes.
  [[nodiscard]] float operator()(std::size_t slot, const std::array<float, 3>& place,
                                 const std::array<float, 3>& normal) const noexcept {
    const Link& l = links_[slot];
    float way = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      const float moved =
          l.origin[r] + l.turned[0][r] * place[0] + l.turned[1][r] * place[1] + l.turned[2][r] * place[2];
      way -= moved * (l.axes[0][r] * normal[0] + l.axes[1][r] * normal[1] + l.axes[2][r] * normal[2]);
    }
    return way;
  }

 private:
  using Vector = std::array<float, 3>;
  struct Link {
    Vector origin;                 ///< displacement of the origin [m]
    std::array<Vector, 3> axes;    ///< axes of the link now, as vectors of the base
    std::array<Vector, 3> turned;  ///< change of `axes`
  };
  static Vector number(const Xyz<T>& v) noexcept {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  template <std::size_t Ix, class P>
  void put(const P& a, const P& b) noexcept {
    if constexpr ((Links >> Ix) & 1u) {
      const auto X = a.template get<Ix>(), Y = b.template get<Ix>();
      const auto p = X.axes(), q = Y.axes();
      links_[static_cast<std::size_t>(std::popcount(Links & ((LinkMask(1) << Ix) - 1)))] = {
          number(Y.origin() - X.origin()),
          {number(q.x), number(q.y), number(q.z)},
          {number(q.x - p.x), number(q.y - p.y), number(q.z - p.z)}};
    }
  }
  std::array<Link, count == 0 ? 1 : count> links_{};
};

}  // namespace detail
SKINCTL_END_NAMESPACE
