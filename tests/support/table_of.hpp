// The table of a model that has none of its own: its numbers, for the oracles.
#pragma once

#include "skinctl/model/model.hpp"
#include "tests/support/robot_table.hpp"

namespace skinctl::testing {

/// The frames are the model's own.
template <RobotModel M>
[[nodiscard]] oracle::Robot table_of(const M& model) {
  using P = LinkParameter;
  using oracle::table_detail::product;
  const auto links = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<LinkParameters<double>, M::joints>{numbers_of<I, double>(model)...};
  }(std::make_index_sequence<M::joints>{});
  const auto about_z = [](double c, double s) { return std::array<double, 9>{c, -s, 0, s, c, 0, 0, 0, 1}; };
  oracle::Robot robot;
  for (std::size_t i = 0; i < M::joints; ++i) {
    const auto& l = links[i];
    oracle::Body b;
    b.parent = M::parents[i];
    b.R = product(about_z(l[P::cos_gamma], l[P::sin_gamma]),
                  {1, 0, 0, 0, l[P::cos_alpha], -l[P::sin_alpha], 0, l[P::sin_alpha], l[P::cos_alpha]});
    b.p = {l[P::p_x], l[P::p_y], l[P::p_z]};
    if (M::kinds[i] == JointKind::revolute) {
      b.R = product(b.R, about_z(std::cos(l[P::offset]), std::sin(l[P::offset])));
    } else {
      b.motion = oracle::Motion::prismatic;
      for (std::size_t k = 0; k < 3; ++k) b.p[k] += b.R[3 * k + 2] * l[P::offset];
      b.R = product(b.R, about_z(l[P::cos_beta], l[P::sin_beta]));
    }
    const LinkInertia in = inertia_of(l);
    b.mass = in.mass;
    b.com = {in.c[0], in.c[1], in.c[2]};
    b.inertia = {in.xx, in.xy, in.xz, in.xy, in.yy, in.yz, in.xz, in.yz, in.zz};
    robot.bodies.push_back(b);
  }
  const Xyz<double> g = dense<double>(model.template gravity<double>());
  robot.gravity = {g.x, g.y, g.z};
  return robot;
}

}  // namespace skinctl::testing
