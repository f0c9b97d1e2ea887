#include "skinctl/limits/detail/nearest_in_box.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Chains of light links on heavy ones: masses down to a millionth of the first, strongly coupled.
template <std::size_t N>
MassMatrix<N> random_mass(Random& random) {
  double A[N][N];
  MassMatrix<N> m;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j)
      A[i][j] = std::pow(10.0, -0.5 * uniform(random, 0.0, 6.0 / N) * static_cast<double>(i)) *
                uniform(random, -1.0, 1.0);
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) {
      m(i, j) = 0;
      for (std::size_t k = 0; k < N; ++k) m(i, j) += A[i][k] * A[j][k];
    }
  return m;
}

template <std::size_t N>
double energy(const MassMatrix<N>& m, const JointVelocity<N>& a, const JointVelocity<N>& b) {
  double e = 0;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) e += 0.5 * (a[i] - b[i]) * m(i, j) * (a[j] - b[j]);
  return e;
}

}  // namespace

TEST_CASE_TEMPLATE("nearest_in_box: velocities in the box, impulses at its bounds that only take energy",
                   Joints, std::integral_constant<std::size_t, 1>, std::integral_constant<std::size_t, 4>,
                   std::integral_constant<std::size_t, 7>, std::integral_constant<std::size_t, 16>) {
  constexpr std::size_t N = Joints::value;
  Random random = seeded(N);
  int ran_out = 0, bound = 0;
  for (int k = 0; k < 400; ++k) {
    CAPTURE(k);
    const auto mass = random_mass<N>(random);
    if (!math::Ldlt<N, double>(mass.data).positive_definite()) continue;
    JointVelocity<N> u, lower, upper;
    for (std::size_t i = 0; i < N; ++i) {
      u[i] = uniform(random, -5.0, 5.0) * (random() % 4 == 0 ? 1e3 : 1.0);
      upper[i] = random() % 3 == 0 ? 0 : uniform(random, 0.0, 3.0);
      lower[i] = random() % 3 == 0 ? 0 : uniform(random, -3.0, 0.0);
    }
    const auto out = detail::nearest_in_box(mass, u, lower, upper);
    ran_out += !out.exact;
    double size = 0;
    for (std::size_t i = 0; i < N; ++i) size = std::max(size, std::abs(u[i]));
    const double slack = 1e-9 * size;
    for (std::size_t i = 0; i < N; ++i) {
      if (out.exact) CHECK(out.u[i] <= upper[i] + slack);
      if (out.exact) CHECK(out.u[i] >= lower[i] - slack);
      if (out.impulse[i] > 0) CHECK(out.u[i] == upper[i]);
      if (out.impulse[i] < 0) CHECK(out.u[i] == lower[i]);
      bound += out.impulse[i] != 0;
    }
    if (!out.exact) continue;
    // No other velocity of the box is nearer: neither of many at random, nor a step along any joint.
    const double least = energy(mass, out.u, u);
    for (int trial = 0; trial < 40; ++trial) {
      JointVelocity<N> other = out.u;
      for (std::size_t i = 0; i < N; ++i)
        if (trial < 20 || i == static_cast<std::size_t>(trial) % N)
          other[i] =
              std::clamp(out.u[i] + uniform(random, -1.0, 1.0) * std::pow(10.0, uniform(random, -6.0, 1.0)),
                         lower[i], upper[i]);
      CHECK(energy(mass, other, u) >= least * (1 - 1e-9));
    }
  }
  CHECK(ran_out == 0);
  CHECK(bound > 100);
}

TEST_CASE("nearest_in_box: what is inside stays to the bit, and what is no number ends in time") {
  MassMatrix<3> m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m(i, j) = i == j ? 1 : 0.3;
  const JointVelocity<3> u{0.5, -0.5, 0.1}, upper = JointVelocity<3>::constant(1), lower = -1.0 * upper;
  const auto in = detail::nearest_in_box(m, u, lower, upper);
  CHECK(in.u == u);
  CHECK(in.impulse == JointTorque<3>{});
  // One joint too fast: the others go on as its impulse makes them, and none is pushed to help.
  const auto out = detail::nearest_in_box(m, JointVelocity<3>{3, 0, 0}, lower, upper);
  CHECK(out.u[0] == 1);
  CHECK(out.impulse[0] > 0);
  CHECK(out.impulse[1] == 0);
  const double nan = std::nan("");
  static_cast<void>(detail::nearest_in_box(m, JointVelocity<3>{nan, 2, -2}, lower, upper));
  m(1, 1) = nan;
  static_cast<void>(detail::nearest_in_box(m, JointVelocity<3>{3, 2, -2}, lower, upper));
}
