// How far the library's results are from 50 digits, in units of the last place of the scalar.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/robots.hpp"

namespace skinctl::testing {

using Exact = oracle::EulerLagrange<Digits50>;

/// A link of a model as a body of the definition, its numbers in double taken as exact; cosine and sine of a
/// placement are scaled to length one.
inline oracle::BasicBody<Digits50> exact_body(int parent, JointKind kind, const LinkParameters<double>& l) {
  using P = LinkParameter;
  using oracle::table_detail::product;
  const auto unit = [&](P c, P s) {
    const Digits50 x(l[c]), y(l[s]), length = sqrt(x * x + y * y);
    return std::array<Digits50, 2>{x / length, y / length};
  };
  const auto about_z = [](const std::array<Digits50, 2>& turn) {
    return std::array<Digits50, 9>{turn[0],     -turn[1],    Digits50(0), turn[1],    turn[0],
                                   Digits50(0), Digits50(0), Digits50(0), Digits50(1)};
  };
  const auto [ca, sa] = unit(P::cos_alpha, P::sin_alpha);
  const Digits50 offset(l[P::offset]);
  oracle::BasicBody<Digits50> b;
  b.parent = parent;
  b.R = product(about_z(unit(P::cos_gamma, P::sin_gamma)),
                {Digits50(1), Digits50(0), Digits50(0), Digits50(0), ca, -sa, Digits50(0), sa, ca});
  b.p = {Digits50(l[P::p_x]), Digits50(l[P::p_y]), Digits50(l[P::p_z])};
  if (kind == JointKind::revolute) {
    b.motion = oracle::Motion::revolute;
    b.R = product(b.R, about_z({cos(offset), sin(offset)}));
  } else {
    b.motion = oracle::Motion::prismatic;
    for (std::size_t k = 0; k < 3; ++k) b.p[k] += b.R[3 * k + 2] * offset;
    b.R = product(b.R, about_z(unit(P::cos_beta, P::sin_beta)));
  }
  b.mass = Digits50(l[P::mass]);
  b.com = {Digits50(l[P::c_x]), Digits50(l[P::c_y]), Digits50(l[P::c_z])};
  const Digits50 xx(l[P::s_xx]), yy(l[P::s_yy]), zz(l[P::s_zz]), xy(-l[P::s_xy]), xz(-l[P::s_xz]),
      yz(-l[P::s_yz]);
  b.inertia = {yy + zz, xy, xz, xy, xx + zz, yz, xz, yz, xx + yy};
  return b;
}

/// The tree of a model. Frames are the model's own.
template <RobotModel M>
[[nodiscard]] Exact exact_tree(const M& model) {
  const auto links = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<LinkParameters<double>, M::joints>{numbers_of<I, double>(model)...};
  }(std::make_index_sequence<M::joints>{});
  oracle::BasicRobot<Digits50> robot;
  for (std::size_t i = 0; i < M::joints; ++i)
    robot.bodies.push_back(exact_body(M::parents[i], M::kinds[i], links[i]));
  const Xyz<double> g = dense<double>(model.template gravity<double>());
  robot.gravity = {Digits50(g.x), Digits50(g.y), Digits50(g.z)};
  return Exact(robot);
}

/// Errors in units of the last place of each result's scale: 1 for axes, the longest reach for origins, the
/// largest element for Jacobians, M and accelerations, and for torques the largest sum over links of the
/// magnitudes of their shares.
struct Ulps {
  double pose = 0, jacobian = 0, inverse_dynamics = 0, gravity = 0, mass = 0, acceleration = 0;
  /// Of forward dynamics: the torque `M (ddq - exact ddq)` that would explain the error, against the scale of
  /// the torques. The error of ddq itself is larger by the condition of M.
  double explained = 0;

  void note(const Ulps& u) {
    pose = std::max(pose, u.pose), jacobian = std::max(jacobian, u.jacobian);
    inverse_dynamics = std::max(inverse_dynamics, u.inverse_dynamics);
    gravity = std::max(gravity, u.gravity), mass = std::max(mass, u.mass);
    acceleration = std::max(acceleration, u.acceleration), explained = std::max(explained, u.explained);
  }
};

namespace detail {
inline Digits50 largest(const std::vector<Digits50>& x) {
  Digits50 most(0);
  for (const Digits50& v : x)
    if (abs(v) > most) most = abs(v);
  return most;
}
/// In units of the last place of `T` at `scale`; NaN or infinity is worse than everything.
template <class T, class V>
double in_ulps(const V& mine, const std::vector<Digits50>& exact, const Digits50& scale) {
  double worst = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Digits50 error = abs(Digits50(mine[i]) - exact[i]);
    const double u = scale == 0 ? (error == 0 ? 0.0 : 1e300)
                                : static_cast<double>(error / scale) /
                                      static_cast<double>(std::numeric_limits<T>::epsilon());
    if (!(u <= worst)) worst = u == u ? u : 1e300;
  }
  return worst;
}
}  // namespace detail

/// The poses of every link, computed by whichever function.
template <class T>
struct Placed {
  Xyz<T> x, y, z, p;
};

/// Errors of poses at `q`.
template <class T>
double pose_ulps(const Exact& exact, const std::vector<Digits50>& q, const std::vector<Placed<T>>& mine) {
  const auto X = exact.poses(q);
  Digits50 reach(0);
  for (const auto& pose : X) reach = std::max(reach, detail::largest({pose.p[0], pose.p[1], pose.p[2]}));
  double worst = 0;
  for (std::size_t i = 0; i < X.size(); ++i) {
    const auto& [x, y, z, p] = mine[i];
    const T axes[9] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
    const T origin[3] = {p.x, p.y, p.z};
    worst = std::max({worst, detail::in_ulps<T>(axes, {X[i].R.begin(), X[i].R.end()}, Digits50(1)),
                      detail::in_ulps<T>(origin, {X[i].p.begin(), X[i].p.end()}, reach)});
  }
  return worst;
}

/// All errors of `model` at a state, which must be a state of `T`.
template <class T, RobotModel M>
[[nodiscard]] Ulps ulps_at(const M& model, const Exact& exact, const JointPosition<M::joints, T>& q,
                           const JointVelocity<M::joints, T>& dq,
                           const JointAcceleration<M::joints, T>& ddq) {
  constexpr std::size_t N = M::joints;
  const auto wq = wide(q), wdq = wide(dq), wddq = wide(ddq);
  Ulps u;
  const auto poses = link_poses(model, q);
  std::vector<Placed<T>> placed;
  const auto X = exact.poses(wq);
  const auto link = [&](auto i) {
    const auto X_BL = poses.template get<i.value>();
    placed.push_back({X_BL.axis_x(), X_BL.axis_y(), X_BL.axis_z(), X_BL.origin()});
    if constexpr (children<M, int(i.value)>.size() == 0) {  // a point on each tip
      using detail::largest;
      const auto J = jacobian<i.value>(
          poses, Transform<Link<i.value>, Cell, T>::translation_xyz(T(0.125), T(-0.0625), T(0.25)));
      T rows[6 * N] = {};
      J.for_each([&](auto j, const auto& c) {
        const T six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
        for (std::size_t r = 0; r < 6; ++r) rows[r * N + j.value] = six[r];
      });
      const auto expected =
          exact.jacobian(X, int(i.value), {Digits50(0.125), Digits50(-0.0625), Digits50(0.25)});
      u.jacobian = std::max(u.jacobian, detail::in_ulps<T>(rows, expected, largest(expected)));
    }
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (link(std::integral_constant<std::size_t, I>{}), ...);
  }(std::make_index_sequence<N>{});
  u.pose = pose_ulps(exact, wq, placed);

  std::vector<Digits50> magnitude;
  const std::vector<Digits50> zero(N, Digits50(0));
  const auto tau = exact.dalembert(wq, wdq, wddq, &magnitude);
  const Digits50 scale = detail::largest(magnitude);
  u.inverse_dynamics = detail::in_ulps<T>(inverse_dynamics(model, q, dq, ddq), tau, scale);
  const auto G = exact.dalembert(wq, zero, zero, &magnitude);
  u.gravity = detail::in_ulps<T>(gravity_torque(model, q), G, detail::largest(magnitude));
  const auto exact_mass = exact.mass_matrix(wq);
  u.mass = detail::in_ulps<T>(mass_matrix(model, q).data, exact_mass, detail::largest(exact_mass));

  // Forward dynamics under the torque that T has of the exact one.
  JointTorque<N, T> applied;
  for (std::size_t i = 0; i < N; ++i) applied[i] = static_cast<T>(tau[i]);
  auto free = exact.dalembert(wq, wdq, zero);
  for (std::size_t i = 0; i < N; ++i) free[i] = Digits50(applied[i]) - free[i];
  const auto ddq_exact = Exact::solved(exact_mass, free);
  const auto mine = forward_dynamics(model, q, dq, applied).acceleration;
  u.acceleration = detail::in_ulps<T>(mine, ddq_exact, detail::largest(ddq_exact));
  std::vector<Digits50> off(N);
  for (std::size_t i = 0; i < N; ++i) off[i] = Digits50(mine[i]) - ddq_exact[i];
  u.explained =
      detail::in_ulps<T>(std::vector<Digits50>(N, Digits50(0)), Exact::product(exact_mass, off), scale);
  return u;
}

}  // namespace skinctl::testing
