// The terms of a shaped virtual robot: definitions for tool_shape.hpp.
#pragma once

#include "skinctl/robot/tool_shape.hpp"

SKINCTL_BEGIN_NAMESPACE

template <std::size_t L, std::size_t Rows, Real T>
template <class Policy, class S, class M, class Angles>
SKINCTL_NOINLINE bool ToolShape<L, Rows, T>::terms(const M& model, const Angles& angles,
                                                   const JointVelocity<M::joints, T>& v,
                                                   const MassMatrix<S::count, T>& m0,
                                                   const JointTorque<S::count, T>& coriolis, const T& h,
                                                   ToolTerms<S::count, Rows, T>& out) const noexcept {
  static_assert(
      (ancestors<M>(L) & ~S::set) == 0,
      "ToolShape: on a link that no joint by torque moves; such a joint has the robot's own inertia");
  constexpr std::size_t N = S::count;
  const math::detail::OneSystem<N, T> factors(m0.data);
  if (!factors.positive_definite()) return false;
  using Joints = detail::Row<N, T>;    // over the joints
  using Space = detail::Row<Rows, T>;  // over the tool's directions
  const Poses<M, ancestors<M>(L), T> poses(model, angles);
  const auto jacobian_of_tool = jacobian<L>(poses, s_.X_LT);
  T columns[N][6] = {};
  jacobian_of_tool.for_each([&](auto i, const auto& c) SKINCTL_INLINE_LAMBDA {
    T(&to)[6] = columns[S::place(i.value)];
    to[0] = c.linear.x, to[1] = c.linear.y, to[2] = c.linear.z;
    to[3] = c.angular.x, to[4] = c.angular.y, to[5] = c.angular.z;
  });
  const auto bias = bias_acceleration(jacobian_of_tool, v);
  const T dJv[6] = {bias.linear.x,  bias.linear.y,  bias.linear.z,
                    bias.angular.x, bias.angular.y, bias.angular.z};
  const auto sum = [](auto count, auto&& term) SKINCTL_INLINE_LAMBDA {
    auto total = term(std::integral_constant<std::size_t, 0>{});
    detail::unrolled<count - 1>([&](auto k) SKINCTL_INLINE_LAMBDA {
      total = total + term(std::integral_constant<std::size_t, k + 1>{});
    });
    return total;
  };
  constexpr std::integral_constant<std::size_t, N> all_joints{};
  constexpr std::integral_constant<std::size_t, Rows> all_rows{};
  const auto rows_of = [](const Matrix& m, Space(&to)[Rows]) SKINCTL_INLINE_LAMBDA {
    detail::unrolled<Rows>([&](auto k) SKINCTL_INLINE_LAMBDA { to[k] = Space(m[k].data()); });
  };

  // W = S' J, whose mobility W M_0^-1 W' has the ratios rho as eigenvalues: by columns, one per joint.
  Space root[Rows], W[N], moved[N], mobility[Rows], Z[Rows];
  rows_of(root_, root);
  detail::for_each_of_few<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    W[i] = sum(all_rows, [&](auto p) SKINCTL_INLINE_LAMBDA { return columns[i][p] * root[p]; });
  });
  factors.solve(W, moved);
  detail::unrolled<Rows>([&](auto k) SKINCTL_INLINE_LAMBDA {
    mobility[k] = sum(all_joints, [&](auto i) SKINCTL_INLINE_LAMBDA { return W[i][k] * moved[i]; });
  });
  detail::real_of_inverse(mobility, a_, Z);

  // M_rest = M_0 - W' Z W, and the matrix that includes its friction.
  const T rate = s_.rest_decay, rest_weight = Policy::weight(T(h * rate), T(1)) * h * rate;
  const T weight = h * Policy::weight(T(h * fastest_), T(1));
  Joints J[Rows], WJ[Rows];  // rows of J and of W
  Space mass[Rows], damping[Rows];
  rows_of(s_.mass, mass), rows_of(s_.damping, damping);
  detail::unrolled<Rows>([&](auto k) SKINCTL_INLINE_LAMBDA {
    J[k] = Joints::of([&](auto i) SKINCTL_INLINE_LAMBDA { return columns[i][k]; });
    WJ[k] = Joints::of([&](auto i) SKINCTL_INLINE_LAMBDA { return W[i][k]; });
    J[k].store(out.J[k]);
  });
  const JointTorque<N, T> torque = coriolis;
  JointAcceleration<N, T> own;
  factors.solve(torque.data, own.data);
  Joints total = sum(all_rows, [&](auto k) SKINCTL_INLINE_LAMBDA {
    T force(0);
    for (std::size_t l = 0; l < Rows; ++l) force = force + s_.mass[k][l] * dJv[l];
    return force * J[k];
  });
  detail::for_each_of_few<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    const auto times = [&](const auto& of, const auto& x) SKINCTL_INLINE_LAMBDA {
      return sum(all_rows, [&](auto l) SKINCTL_INLINE_LAMBDA { return x(l) * of[l]; });
    };
    const auto of_W = [&](auto l) SKINCTL_INLINE_LAMBDA { return W[i][l]; };
    const auto of_J = [&](auto l) SKINCTL_INLINE_LAMBDA { return columns[i][l]; };
    const Space ZW = times(Z, of_W), LJ = times(mass, of_J), DJ = times(damping, of_J);
    const Joints rest =
        Joints(m0.data + i * N) - times(WJ, [&](auto k) SKINCTL_INLINE_LAMBDA { return ZW[k]; });
    const Joints felt = times(J, [&](auto k) SKINCTL_INLINE_LAMBDA { return LJ[k]; });
    const Joints damped = times(J, [&](auto k) SKINCTL_INLINE_LAMBDA { return DJ[k]; });
    rest.store(out.rest.data + i * N);
    (rest + felt).store(out.mass.data + i * N);
    (damped + rate * rest).store(out.friction.data + i * N);
    (weight * damped + rest_weight * rest).store(out.implicit.data + i * N);
    total = total + own[i] * rest;
  });
  total.store(out.coriolis);
  return true;
}

namespace detail {
struct NoWeight {
  template <Real T>
  static T weight(const T&, const T&) noexcept {
    return T(0);
  }
};
}  // namespace detail

template <std::size_t L, std::size_t Rows, Real T>
template <class M, std::size_t N>
SKINCTL_COLD ToolTerms<N, Rows, T> ToolShape<L, Rows, T>::at(
    const M& model, const JointPosition<N, T>& q, const JointTorque<N, T>& inertia) const noexcept {
  const JointAngles<M, T> angles(model, q);
  MassMatrix<N, T> m = mass_matrix(model, angles);
  for (std::size_t i = 0; i < N; ++i) m(i, i) = m(i, i) + inertia[i];
  ToolTerms<N, Rows, T> out;
  if (terms<detail::NoWeight, AllJoints<N>>(model, angles, JointVelocity<N, T>{}, m, JointTorque<N, T>{},
                                            T(0), out))
    return out;
  for (auto& row : out.J)
    for (T& x : row) x = T(0);
  out.mass = out.rest = out.friction = out.implicit = MassMatrix<N, T>();
  return out;
}

SKINCTL_END_NAMESPACE
