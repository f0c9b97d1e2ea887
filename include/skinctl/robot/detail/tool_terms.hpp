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
  const math::Ldlt<N, T> factors(m0.data);
  if (!factors.positive_definite()) return false;
  const Poses<M, ancestors<M>(L), T> poses(model, angles);
  const auto jacobian_of_tool = jacobian<L>(poses, s_.X_LT);
  jacobian_of_tool.for_each([&](auto i, const auto& c) SKINCTL_INLINE_LAMBDA {
    const T column[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
    for (std::size_t k = 0; k < Rows; ++k) out.J[k][S::place(i.value)] = column[k];
  });
  const auto bias = bias_acceleration(jacobian_of_tool, v);
  const T dJv[6] = {bias.linear.x,  bias.linear.y,  bias.linear.z,
                    bias.angular.x, bias.angular.y, bias.angular.z};

  // W = S' J, whose mobility W M_0^-1 W' has the ratios rho as eigenvalues.
  T W[Rows][N], mobility[Rows][Rows], Z[Rows][Rows];
  for (std::size_t k = 0; k < Rows; ++k)
    for (std::size_t i = 0; i < N; ++i) {
      T sum(0);
      for (std::size_t p = k; p < Rows; ++p) sum = sum + root_[p][k] * out.J[p][i];
      W[k][i] = sum;
    }
  for (std::size_t k = 0; k < Rows; ++k) {
    T x[N];
    factors.solve(W[k], x);
    for (std::size_t l = 0; l <= k; ++l) {
      T sum(0);
      for (std::size_t i = 0; i < N; ++i) sum = sum + W[l][i] * x[i];
      mobility[k][l] = mobility[l][k] = sum;
    }
  }
  detail::real_of_inverse(mobility, a_, Z);

  // M_rest = M_0 - W' Z W, and the matrix that includes its friction.
  const T rate = s_.rest_decay, rest_weight = T(1) + Policy::weight(T(h * rate)) * h * rate;
  const T weight = Policy::weight(T(h * fastest_));
  for (std::size_t i = 0; i < N; ++i) {
    T ZW[Rows], LJ[Rows], DJ[Rows];
    for (std::size_t k = 0; k < Rows; ++k) {
      ZW[k] = LJ[k] = DJ[k] = T(0);
      for (std::size_t l = 0; l < Rows; ++l) {
        ZW[k] = ZW[k] + Z[k][l] * W[l][i];
        LJ[k] = LJ[k] + s_.mass[k][l] * out.J[l][i];
        DJ[k] = DJ[k] + s_.damping[k][l] * out.J[l][i];
      }
    }
    for (std::size_t j = 0; j <= i; ++j) {
      T taken(0), felt(0), damped(0);
      for (std::size_t k = 0; k < Rows; ++k) {
        taken = taken + W[k][j] * ZW[k];
        felt = felt + out.J[k][j] * LJ[k];
        damped = damped + out.J[k][j] * DJ[k];
      }
      const T rest = m0(i, j) - taken;
      out.rest(i, j) = out.rest(j, i) = rest;
      out.mass(i, j) = out.mass(j, i) = rest + felt;
      out.friction(i, j) = out.friction(j, i) = damped + rate * rest;
      out.implicit(i, j) = out.implicit(j, i) = h * weight * damped + (rest_weight - T(1)) * rest;
    }
  }

  JointAcceleration<N, T> own;
  factors.solve(coriolis.data, own.data);
  out.coriolis = out.rest * own;
  for (std::size_t k = 0; k < Rows; ++k) {
    T force(0);
    for (std::size_t l = 0; l < Rows; ++l) force = force + s_.mass[k][l] * dJv[l];
    for (std::size_t i = 0; i < N; ++i) out.coriolis[i] = out.coriolis[i] + out.J[k][i] * force;
  }
  return true;
}

namespace detail {
struct NoWeight {
  template <Real T>
  static T weight(const T&) noexcept {
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
  static_cast<void>(terms<detail::NoWeight, AllJoints<N>>(model, angles, JointVelocity<N, T>{}, m,
                                                          JointTorque<N, T>{}, T(0), out));
  return out;
}

SKINCTL_END_NAMESPACE
