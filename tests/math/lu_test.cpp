#include "skinctl/math/lu.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "skinctl/testing/allocation_guard.hpp"
#include "tests/math/matrices.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double solved_at_compile_time() {
  const double a[4] = {0, 2, 4, 1};  // no first pivot without an exchange
  double x[2] = {4, 10};
  const math::Lu<2> factors(a);
  factors.solve(x, x);
  return factors.regular() ? 10 * x[0] + x[1] : -1;
}
static_assert(solved_at_compile_time() == 22.0);
static_assert(std::is_trivially_copyable_v<math::Lu<6>>);

template <std::size_t N, class T>
void fill_random(Random& random, T (&a)[N * N]) {
  for (T& x : a) x = static_cast<T>(uniform(random, -1.0, 1.0));
}

template <std::size_t N, class T>
void solves_random_matrices(int runs) {
  Random random = seeded(N);
  double worst = 0;
  int singular = 0;
  for (int k = 0; k < runs; ++k) {
    T a[N * N], b[N], x[N];
    fill_random<N>(random, a);
    if (k % 4 == 1)  // rows in different units
      for (std::size_t i = 0; i < N * N; ++i) a[i] *= static_cast<T>(std::exp2((i / N) % 5 * 6));
    if (k % 4 == 2)  // columns in different units
      for (std::size_t i = 0; i < N * N; ++i) a[i] *= static_cast<T>(std::exp2(i % N % 5 * 6));
    if (k % 4 == 3)
      for (std::size_t i = 0; i < N; ++i) a[i * N + i] = T(0);
    for (T& v : b) v = static_cast<T>(uniform(random, -1.0, 1.0));
    const math::Lu<N, T> factors(a);
    if (!factors.regular()) {
      ++singular;
      continue;
    }
    factors.solve(b, x);
    worst = std::max(worst, backward_error_by_norm<N>(a, x, b));
    factors.solve(b, b);
    for (std::size_t i = 0; i < N; ++i) CHECK(b[i] == x[i]);
  }
  CAPTURE(N);
  CHECK(worst <= 4.0 * N);
  CHECK(singular <= (N == 1 ? runs / 4 : 1));
}

}  // namespace

TEST_CASE_TEMPLATE("Lu: solves to rounding, from 1 to 22 unknowns", T, float, double) {
  solves_random_matrices<1, T>(200);
  solves_random_matrices<2, T>(400);
  solves_random_matrices<6, T>(800);
  solves_random_matrices<16, T>(100);
  solves_random_matrices<22, T>(40);
}

TEST_CASE_TEMPLATE("Lu: agrees with Eigen in 50 digits as far as the condition allows", T, float, double) {
  Random random = seeded(1);
  for (int k = 0; k < 200; ++k) {
    T a[36], b[6], x[6];
    if (k == 0)
      fill_hilbert<6>(a);
    else
      fill_random<6>(random, a);
    Eigen::Matrix<Digits50, 6, 6> m;
    Eigen::Matrix<Digits50, 6, 1> right;
    for (std::size_t i = 0; i < 6; ++i) {
      b[i] = static_cast<T>(uniform(random, -1.0, 1.0));
      right(int(i)) = Digits50(b[i]);
      for (std::size_t j = 0; j < 6; ++j) m(int(i), int(j)) = Digits50(a[6 * i + j]);
    }
    const Eigen::Matrix<Digits50, 6, 6> inverse = m.fullPivLu().inverse();
    const Eigen::Matrix<Digits50, 6, 1> exact = inverse * right;
    const double condition = static_cast<double>(
        Digits50(inverse.cwiseAbs().rowwise().sum().maxCoeff() * m.cwiseAbs().rowwise().sum().maxCoeff()));
    const double epsilon = static_cast<double>(std::numeric_limits<T>::epsilon());
    const math::Lu<6, T> factors(a);
    if (condition * epsilon > 0.01) continue;  // Hilbert in float
    CAPTURE(condition);
    CHECK(factors.regular());
    factors.solve(b, x);
    double worst = 0, size = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      worst = std::max(worst, size_of(Digits50(Digits50(x[i]) - exact(int(i)))));
      size = std::max(size, size_of(exact(int(i))));
    }
    CHECK(worst <= 6 * condition * epsilon * size);
  }
}

TEST_CASE_TEMPLATE("Lu: pivots are exchanged: a tiny one costs no digits", T, float, double) {
  for (const T tiny : {T(0), T(1e-8), T(1e-30)}) {
    const T a[4] = {tiny, T(1), T(1), T(1)}, b[2] = {T(1), T(2)};
    T x[2];
    const math::Lu<2, T> factors(a);
    REQUIRE(factors.regular());
    factors.solve(b, x);
    const double expected = 1 / (1 - double(tiny));
    CHECK(std::abs(double(x[0]) - expected) <= 2 * double(std::numeric_limits<T>::epsilon()));
    CHECK(std::abs(double(x[1]) - (2 - expected)) <= 2 * double(std::numeric_limits<T>::epsilon()));
  }
}

TEST_CASE_TEMPLATE("Lu: extreme scales", T, float, double) {
  for (const T scale : {T(1e-30), T(1e-8), T(1), T(1e6), T(1e30)}) {
    const T a[9] = {T(0), scale, T(2) * scale, T(3) * scale, T(0), scale, scale, T(2) * scale, T(0)};
    const T b[3] = {T(3) * scale, T(4) * scale, T(3) * scale};
    T x[3];
    const math::Lu<3, T> factors(a);
    REQUIRE(factors.regular());
    factors.solve(b, x);
    for (const T v : x) CHECK(std::abs(v - T(1)) <= T(8) * std::numeric_limits<T>::epsilon());
  }
}

TEST_CASE_TEMPLATE("Lu: a singular matrix is told, and nothing is divided by zero", T, float, double) {
  Random random = seeded(2);
  for (int k = 0; k < 200; ++k) {
    T a[36], x[6];
    fill_random<6>(random, a);
    const auto one = static_cast<std::size_t>(k % 6),
               other = static_cast<std::size_t>((k + 1 + k / 6 % 5) % 6);
    for (std::size_t i = 0; i < 6; ++i) {
      if (k % 3 == 0) a[6 * i + one] = T(0);                     // an empty column
      if (k % 3 == 1) a[6 * one + i] = T(0);                     // an empty row
      if (k % 3 == 2) a[6 * one + i] = T(2) * a[6 * other + i];  // a row twice
      x[i] = T(1);
    }
    const math::Lu<6, T> factors(a);
    CHECK_FALSE(factors.regular());
    factors.solve(x, x);
    for (const T v : x) CHECK(v - v == T(0));
  }
}

TEST_CASE_TEMPLATE("Lu: NaN and infinity anywhere are told", T, float, double) {
  for (const T bad : {nan_of<T>, infinity_of<T>, -infinity_of<T>})
    for (std::size_t at = 0; at < 36; ++at) {
      Random random = seeded(3);
      T a[36];
      fill_random<6>(random, a);
      a[at] = bad;
      CAPTURE(at);
      CHECK_FALSE(math::Lu<6, T>(a).regular());
    }
  const T one[1] = {nan_of<T>};
  CHECK_FALSE(math::Lu<1, T>(one).regular());
}

TEST_CASE("Lu: in 50 digits, and without allocation") {
  Random random = seeded(5);
  double d[36];
  fill_random<6>(random, d);
  Digits50 a[36], b[6], x[6];
  for (std::size_t i = 0; i < 36; ++i) a[i] = Digits50(d[i]);
  for (Digits50& v : b) v = Digits50(1) / 3;
  const math::Lu<6, Digits50> factors(a);
  CHECK(factors.regular());
  factors.solve(b, x);
  CHECK(backward_error_by_norm<6>(a, x, b) <= 24);

  double y[6] = {1, 2, 3, 4, 5, 6};
  const AllocationGuard guard;
  math::Lu<6>(d).solve(y, y);
  CHECK(guard.count() == 0);
}
