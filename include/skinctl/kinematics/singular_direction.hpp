// The direction in which a frame moves least, and the joint motion that moves it so little.
#pragma once

#include "skinctl/kinematics/damped_inverse.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The least singular value of a Jacobian with its vectors: `J v = sigma u`, `J'u = sigma v`, |u| = |v| = 1.
template <class J, Task What = Task::pose>
struct SingularDirection;
template <Topology M, LinkMask Columns, Frame Body, Scalar T, Task What>
struct SingularDirection<Jacobian<M, Columns, Body, Body, Base, T>, What> {
  Twist<Body, Base, Body, Base, T> u;  ///< metres and radians alike; its angular part is 0 for a position
  JointVelocity<M::joints, T> v;       ///< of either sign where sigma is 0
  T sigma;
  /// `u' dJ(v) v`: along which side of u the frame leaves the singularity when the joints move along +-v. It
  /// cannot go to the other side: that is where its workspace ends.
  T bend;
};

namespace detail {
/// `x <- A^-1 x / |A^-1 x|`, a few times: towards the eigenvector of the least eigenvalue. False where A is
/// no number.
template <std::size_t N, Real T>
[[nodiscard]] bool least_direction(const T (&a)[N][N], T (&x)[N]) noexcept {
  using std::sqrt;
  T regular[N * N], trace(0);
  for (std::size_t i = 0; i < N; ++i) trace = trace + a[i][i];
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) regular[i * N + j] = a[i][j];
  for (std::size_t i = 0; i < N; ++i)
    regular[i * N + i] = regular[i * N + i] + T(64) * std::numeric_limits<T>::epsilon() * trace;
  const math::Ldlt<N, T> factors(regular);
  for (int step = 0; step < 4; ++step) {
    factors.solve(x, x);
    T square(0);
    for (const T& e : x) square = square + e * e;
    if (!(square > T(0)) || !(square - square == T(0))) return false;
    const T scale = T(1) / sqrt(square);
    for (T& e : x) e = scale * e;
  }
  return true;
}
}  // namespace detail

/// Next to a singularity, by a few steps of inverse iteration: it errs by (sigma / the next singular
/// value)^8. `near`, a joint motion, decides the sign of `v` where sigma is too small to tell. Does not
/// divide by zero; `v` and `bend` are 0 where `J` is no number.
template <Task What = Task::pose, Topology M, LinkMask Columns, Frame Body, Real T>
[[nodiscard]] SKINCTL_COLD auto singular_direction(const Jacobian<M, Columns, Body, Body, Base, T>& J,
                                                   const JointVelocity<M::joints, T>& near) noexcept {
  using Of = Jacobian<M, Columns, Body, Body, Base, T>;
  constexpr std::size_t R = What == Task::pose ? 6 : 3;
  constexpr auto C = static_cast<std::size_t>(std::popcount(Columns));
  using std::sqrt;
  SingularDirection<Of, What> d{{}, {}, T(0), T(0)};
  T columns[C][R], outer[R][R] = {}, inner[C][C] = {}, u[R], v[C];
  std::size_t k = 0;
  J.for_each([&](auto, const auto& c) {
    const T six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
    for (std::size_t r = 0; r < R; ++r) columns[k][r] = six[r];
    ++k;
  });
  for (std::size_t i = 0; i < C; ++i)
    for (std::size_t r = 0; r < R; ++r) {
      for (std::size_t s = 0; s < R; ++s) outer[r][s] = outer[r][s] + columns[i][r] * columns[i][s];
      for (std::size_t j = 0; j < C; ++j) inner[i][j] = inner[i][j] + columns[i][r] * columns[j][r];
    }
  for (std::size_t r = 0; r < R; ++r) u[r] = T(1) + T(static_cast<int>(r)) * T(0.17);
  if (!detail::least_direction(outer, u)) return d;
  T square(0);
  for (std::size_t i = 0; i < C; ++i) {
    v[i] = T(0);
    for (std::size_t r = 0; r < R; ++r) v[i] = v[i] + columns[i][r] * u[r];
    square = square + v[i] * v[i];
  }
  const T sigma = sqrt(square);
  const T noise = T(64) * sqrt(std::numeric_limits<T>::epsilon()) * T(0.01);
  if (sigma > noise) {
    for (T& e : v) e = e / sigma;
  } else {
    for (std::size_t i = 0; i < C; ++i) v[i] = T(1) - T(static_cast<int>(i)) * T(0.31);
    if (!detail::least_direction(inner, v)) return d;
    T along(0);
    k = 0;
    J.for_each([&](auto i, const auto&) { along = along + near[i.value] * v[k++]; });
    if (along < T(0))
      for (T& e : v) e = -e;
  }
  d.sigma = sigma;
  k = 0;
  J.for_each([&](auto i, const auto&) { d.v[i.value] = v[k++]; });
  d.u.linear = {u[0], u[1], u[2]};
  if constexpr (What == Task::pose) d.u.angular = {u[3], u[4], u[5]};
  const auto a = bias_acceleration(J, d.v);
  d.bend = dot(d.u.linear, a.linear) + dot(d.u.angular, a.angular);
  return d;
}

SKINCTL_END_NAMESPACE
