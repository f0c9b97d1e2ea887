// Random cells on a robot's links for the laws of the skin, and tau_skin cell by cell, as in the paper.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/tactile/patch.hpp"
#include "tests/support/random_frames.hpp"

namespace skinctl::testing {

/// Calls `f(integral_constant<I>)` for 0 to N - 1.
template <std::size_t N, class F>
void for_each_index(F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f(std::integral_constant<std::size_t, I>{}), ...);
  }(std::make_index_sequence<N>{});
}

/// A patch of cells anywhere within `reach` of the link's origin, ids from `first_id` on.
template <std::size_t I, std::size_t N>
Patch<I, N> random_patch(Random& rng, std::uint32_t first_id, const CellGains& gains = {},
                         double reach = 0.3) {
  std::vector<PlacedCell<I>> cells;
  for (std::size_t i = 0; i < N; ++i)
    cells.push_back({first_id + static_cast<std::uint32_t>(i),
                     Transform<Link<I>, Cell>(random_rotation<double>(rng), random_xyz(rng, reach))});
  return Patch<I, N>(std::move(cells), gains);
}

/// One patch of each size on the given links.
template <std::size_t... I, std::size_t... N>
auto random_patches(Random& rng, const CellGains& gains, std::index_sequence<I...>,
                    std::index_sequence<N...>) {
  std::uint32_t id = 100;
  const auto one = [&]<std::size_t L, std::size_t C>() {
    const std::uint32_t first = id;
    id += static_cast<std::uint32_t>(C) + 3;
    return random_patch<L, C>(rng, first, gains);
  };
  return std::tuple { one.template operator()<I, N>()... };
}

template <std::size_t N, class T>
JointPosition<N, T> random_position(Random& rng, double reach = 3.0) {
  JointPosition<N, T> q;
  for (auto& x : q) x = T(reach) * uniform<T>(rng);
  return q;
}

/// `J_cell^T [F z ; 0]` of a cell that is pushed with `F` newtons along its inward normal: the paper's form,
/// with the Jacobian of the cell's own frame.
template <std::size_t I, class P, class M, class T>
JointTorque<M::joints, T> torque_of_cell(const P& poses, const M&, const Transform<Link<I>, Cell, T>& X_LC,
                                         const T& newton) {
  const auto J = jacobian<I>(poses, X_LC);
  const Transform<Base, Cell, T> X_BC = poses.template get<I>() * X_LC;
  const Wrench<Cell, Cell, Base, T> F{-newton * X_BC.axis_z(), {}};
  return transpose(J) * F;
}

/// Largest difference, and largest magnitude of either.
template <std::size_t N, class T>
std::pair<double, double> compare(const JointTorque<N, T>& a, const JointTorque<N, T>& b) {
  double worst = 0, size = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    if (!(std::abs(x - y) <= worst)) worst = std::abs(x - y);
    size = std::max({size, std::abs(x), std::abs(y)});
  }
  return {worst, size};
}

}  // namespace skinctl::testing
