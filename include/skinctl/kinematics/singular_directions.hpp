// SPDX-License-Identifier: BSD-3-Clause
// The two directions in which a frame is least mobile, and the corresponding joint motions.
#pragma once

#include <array>

#include "skinctl/kinematics/damped_inverse.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A singular value of a Jacobian with its vectors: `J v = sigma u`, `J'u = sigma v`, |u| = |v| = 1.
template <class J, TaskSpace What = TaskSpace::pose>
struct SingularDirection;
template <Topology M, LinkMask Columns, Frame Body, Scalar T, TaskSpace What>
struct SingularDirection<Jacobian<M, Columns, Body, Body, Base, T>, What> {
  Twist<Body, Base, Body, Base, T> u{};  ///< frame's motion, metres like radians; for a position angular 0
  JointVelocity<M::joints, T> v{};       ///< singular joint motion; if sigma is 0, its sign is arbitrary
  T sigma = T(0);
};

namespace detail {
/// Singular value below which a direction counts as singular [m/rad]: the frame follows at 3 cm/s a rad/s.
inline constexpr double singular_zone = 0.03;
/// Time constant of motions that begin or end next to a singularity [s]: some cycles, so that none jerks.
inline constexpr double singular_lag = 0.03;

/// The K eigenvectors of the smallest eigenvalues, by a few steps of inverse iteration; false if A is not
/// finite.
template <std::size_t K, std::size_t N, Real T>
[[nodiscard]] bool smallest_directions(const T (&a)[N][N], T (&x)[K][N]) noexcept {
  using std::sqrt;
  T regular[N * N], trace(0);
  for (std::size_t i = 0; i < N; ++i) trace = trace + a[i][i];
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) regular[i * N + j] = a[i][j];
  for (std::size_t i = 0; i < N; ++i)
    regular[i * N + i] = regular[i * N + i] + T(64) * std::numeric_limits<T>::epsilon() * trace;
  const math::Ldlt<N, T> factors(regular);
  for (std::size_t k = 0; k < K; ++k)
    for (std::size_t i = 0; i < N; ++i) x[k][i] = T(1) + T(static_cast<int>(i * (2 * k + 1) % 5)) * T(0.37);
  for (int step = 0; step < 4; ++step)
    for (std::size_t k = 0; k < K; ++k) {
      factors.solve(x[k], x[k]);
      for (int pass = 0; pass < 2; ++pass) {  // the second pass removes the rounding error of the first
        T along(0), square(0);
        for (std::size_t i = 0; k > 0 && i < N; ++i) along = along + x[0][i] * x[k][i];
        for (std::size_t i = 0; k > 0 && i < N; ++i) x[k][i] = x[k][i] - along * x[0][i];
        for (const T& e : x[k]) square = square + e * e;
        if (!(square > T(0)) || !(square - square == T(0))) return false;
        const T scale = T(1) / sqrt(square);
        for (T& e : x[k]) e = scale * e;
      }
    }
  return true;
}

/// Singular value decomposition `s = U diag(sigma) V'` of a 2 x 2 matrix, the smaller singular value first;
/// the rows of `u` and `v` are its vectors. By one rotation that makes the columns of s orthogonal.
template <Real T>
void singular_values(const T (&s)[2][2], T (&u)[2][2], T (&v)[2][2], T (&sigma)[2]) noexcept {
  using std::sqrt;
  const T p = s[0][0] * s[0][0] + s[1][0] * s[1][0], q = s[0][1] * s[0][1] + s[1][1] * s[1][1];
  const T r = s[0][0] * s[0][1] + s[1][0] * s[1][1];
  const T half = T(0.5) * (q - p), size = half < T(0) ? T(-half) : half;
  const T whole = size + sqrt(half * half + r * r);
  const T t = whole > T(0) ? T((half < T(0) ? T(-r) : r) / whole) : T(0);
  const T c = T(1) / sqrt(T(1) + t * t), n = c * t;
  const T turned[2][2] = {{c, T(-n)}, {n, c}};
  T image[2][2], size_of[2];
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < 2; ++i) image[k][i] = s[i][0] * turned[k][0] + s[i][1] * turned[k][1];
    size_of[k] = sqrt(image[k][0] * image[k][0] + image[k][1] * image[k][1]);
  }
  const std::size_t low = size_of[0] > size_of[1] ? 1 : 0, high = 1 - low;
  for (std::size_t i = 0; i < 2; ++i) v[0][i] = turned[low][i], v[1][i] = turned[high][i];
  sigma[1] = size_of[high];
  for (std::size_t i = 0; i < 2; ++i) u[1][i] = sigma[1] > T(0) ? T(image[high][i] / sigma[1]) : T(i == 1);
  sigma[0] = u[1][1] * image[low][0] - u[1][0] * image[low][1];
  const T side = sigma[0] < T(0) ? T(-1) : T(1);
  sigma[0] = side * sigma[0], u[0][0] = side * u[1][1], u[0][1] = -side * u[1][0];
}
}  // namespace detail

/// The two directions of a frame with the smallest singular values, the smallest first, near a singularity:
/// their relative error is (sigma / the third singular value)^8. Where two singularities meet, both are
/// needed; their axes within the common plane then depend on rounding. Does not divide by zero; all is 0 if
/// `J` is not finite, and the second is 0 if only one joint moves the frame.
template <TaskSpace What = TaskSpace::pose, Topology M, LinkMask Columns, Frame Body, Real T>
[[nodiscard]] SKINCTL_COLD auto singular_directions(
    const Jacobian<M, Columns, Body, Body, Base, T>& J) noexcept {
  using Of = Jacobian<M, Columns, Body, Body, Base, T>;
  constexpr std::size_t R = What == TaskSpace::pose ? 6 : 3;
  constexpr auto C = static_cast<std::size_t>(std::popcount(Columns));
  constexpr std::size_t K = C < 2 ? C : 2;
  std::array<SingularDirection<Of, What>, 2> d;
  T columns[C][R], outer[R][R] = {}, inner[C][C] = {}, u[K][R], v[K][C];
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
  if (!detail::smallest_directions(outer, u) || !detail::smallest_directions(inner, v)) return d;
  // In these two planes J is 2 x 2: it pairs each u with its v, however small both sigma are.
  T small[K][K] = {}, U[K][K], V[K][K], sigma[K];
  for (std::size_t a = 0; a < K; ++a)
    for (std::size_t b = 0; b < K; ++b)
      for (std::size_t r = 0; r < R; ++r)
        for (std::size_t i = 0; i < C; ++i) small[a][b] = small[a][b] + u[a][r] * columns[i][r] * v[b][i];
  if constexpr (K == 2)
    detail::singular_values(small, U, V, sigma);
  else
    sigma[0] = detail::magnitude(small[0][0]), U[0][0] = T(1), V[0][0] = small[0][0] < T(0) ? T(-1) : T(1);
  for (std::size_t n = 0; n < K; ++n) {
    T x[6] = {};
    for (std::size_t b = 0; b < K; ++b) {
      for (std::size_t r = 0; r < R; ++r) x[r] = x[r] + U[n][b] * u[b][r];
      k = 0;
      J.for_each([&](auto i, const auto&) { d[n].v[i.value] = d[n].v[i.value] + V[n][b] * v[b][k++]; });
    }
    d[n].u = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
    d[n].sigma = sigma[n];
  }
  return d;
}

SKINCTL_END_NAMESPACE
