#include "skinctl/math/ldlt.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/math/detail/block_ldlt.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/math/matrices.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Works while compiling.
constexpr double solved_at_compile_time() {
  const double a[4] = {4, 0, 2, 5};  // the upper triangle is not read
  double x[2] = {8, 12};
  const math::Ldlt<2> factors(a);
  factors.solve(x, x);
  return factors.positive_definite() && factors.min_pivot() == 4.0 ? x[0] + x[1] : -1;
}
static_assert(solved_at_compile_time() == 3.0);
static_assert(std::is_trivially_copyable_v<math::Ldlt<6>>);

template <std::size_t N, class T>
void solves_random_matrices(int runs) {
  Random random = seeded(N);
  double worst = 0;
  for (int k = 0; k < runs; ++k) {
    T a[N * N], b[N], x[N];
    fill_definite<N>(random, k % 2 == 0 ? 1 : 1e-3, k % 3 == 0 ? 1e4 : 1, a);
    for (T& v : b) v = static_cast<T>(uniform(random, -1.0, 1.0) * std::exp2(k % 40 - 20));
    const math::Ldlt<N, T> factors(a);
    REQUIRE(factors.positive_definite());
    CHECK(factors.min_pivot() > T(0));
    factors.solve(b, x);
    worst = std::max(worst, backward_error<N>(a, x, b));
    T in_place[N];
    std::copy_n(b, N, in_place);
    factors.solve(in_place, in_place);
    for (std::size_t i = 0; i < N; ++i) CHECK(in_place[i] == x[i]);
  }
  CAPTURE(N);
  // Row by row and whatever the units of the rows: scaling by powers of two changes nothing but exponents.
  CHECK(worst <= 4.0 * N);
}

}  // namespace

TEST_CASE_TEMPLATE("Ldlt: solves to rounding, from 1 to 22 unknowns, also where units differ by 1e8", T,
                   float, double) {
  solves_random_matrices<1, T>(200);
  solves_random_matrices<2, T>(300);
  solves_random_matrices<6, T>(500);
  solves_random_matrices<7, T>(200);
  solves_random_matrices<16, T>(50);
  solves_random_matrices<22, T>(30);  // beyond the straight line
}

TEST_CASE_TEMPLATE("Ldlt: the error of the solution is that of the matrix times its condition", T, float,
                   double) {
  // Hilbert's matrices of 3 and 6 rows: conditions of 5e2 and 1.5e7; a solution of ones.
  const auto error = []<std::size_t N>(std::integral_constant<std::size_t, N>) {
    T a[N * N], b[N], x[N];
    fill_hilbert<N>(a);
    Eigen::Matrix<Digits50, int(N), 1> right, exact;
    Eigen::Matrix<Digits50, int(N), int(N)> m;
    for (std::size_t i = 0; i < N; ++i) {
      b[i] = T(1);
      right(int(i)) = Digits50(1);
      for (std::size_t j = 0; j < N; ++j) m(int(i), int(j)) = Digits50(a[i * N + j]);
    }
    // The oracle solves the same rounded matrix in 50 digits, by Eigen.
    exact = m.llt().solve(right);
    const math::Ldlt<N, T> factors(a);
    CHECK(factors.positive_definite());
    factors.solve(b, x);
    double worst = 0, size = 0;
    for (std::size_t i = 0; i < N; ++i) {
      worst = std::max(worst, size_of(Digits50(Digits50(x[i]) - exact(int(i)))));
      size = std::max(size, size_of(exact(int(i))));
    }
    CHECK(backward_error<N>(a, x, b) <= 4.0 * N);
    return worst / size;
  };
  const double epsilon = static_cast<double>(std::numeric_limits<T>::epsilon());
  CHECK(error(std::integral_constant<std::size_t, 3>{}) <= 1e3 * epsilon);
  if (sizeof(T) == 8) CHECK(error(std::integral_constant<std::size_t, 6>{}) <= 3e7 * epsilon);
}

TEST_CASE_TEMPLATE("Ldlt: extreme scales", T, float, double) {
  for (const T scale : {T(1e-8), T(1), T(1e6), T(1e-30), T(1e30)}) {
    const T a[9] = {T(4) * scale, T(0), T(0),         T(1) * scale, T(3) * scale,
                    T(0),         T(0), T(1) * scale, T(2) * scale};
    const T b[3] = {scale, scale, scale};
    T x[3];
    const math::Ldlt<3, T> factors(a);
    REQUIRE(factors.positive_definite());
    factors.solve(b, x);
    // (4 1 0; 1 3 1; 0 1 2) x = 1 has x = (4, 2, 8) / 18.
    const double expected[3] = {4.0 / 18, 2.0 / 18, 8.0 / 18};
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(std::abs(double(x[i]) - expected[i]) <= 4 * double(std::numeric_limits<T>::epsilon()));
  }
}

TEST_CASE_TEMPLATE("Ldlt: nearly singular is solved, singular to rounding is told", T, float, double) {
  const T epsilon = std::numeric_limits<T>::epsilon();
  for (const T gap : {T(1e-3), T(1000) * epsilon, T(16) * epsilon}) {
    const T a[4] = {T(1), T(1), T(1), T(1) + gap}, b[2] = {T(1), T(1) + gap};
    T x[2];
    const math::Ldlt<2, T> factors(a);
    CHECK(factors.positive_definite());
    factors.solve(b, x);
    CHECK(x[0] == T(0));
    CHECK(x[1] == T(1));
  }
  for (const T gap : {T(4) * epsilon, T(0), -epsilon}) {
    const T a[4] = {T(1), T(1), T(1), T(1) + gap};
    CHECK_FALSE(math::Ldlt<2, T>(a).positive_definite());
  }
}

TEST_CASE_TEMPLATE("Ldlt: an unknown without a pivot is 0, and the others solve their equations", T, float,
                   double) {
  Random random = seeded(3);
  for (int k = 0; k < 100; ++k) {
    T a[36], b[6], x[6];
    fill_definite<6>(random, 1, 1, a);
    const auto out = static_cast<std::size_t>(k % 6);
    if (k % 2 == 0) {
      for (std::size_t i = 0; i < 6; ++i) a[6 * i + out] = a[6 * out + i] = T(0);  // semi-definite
    } else {
      a[7 * out] = T(-3);  // indefinite
    }
    for (T& v : b) v = static_cast<T>(uniform(random, -1.0, 1.0));
    const math::Ldlt<6, T> factors(a);
    CHECK_FALSE(factors.positive_definite());
    CHECK(factors.min_pivot() <= T(0));
    factors.solve(b, x);
    CHECK(x[out] == T(0));
    for (std::size_t i = 0; i < 6; ++i) a[6 * i + out] = a[6 * out + i] = T(0);
    b[out] = T(0);
    CHECK(backward_error<6>(a, x, b) <= 24);
  }
}

TEST_CASE_TEMPLATE("Ldlt: NaN and infinity anywhere in the lower triangle are told", T, float, double) {
  for (const T bad : {nan_of<T>, infinity_of<T>, -infinity_of<T>})
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t column = 0; column < 6; ++column) {
        Random random = seeded(1);
        T a[36];
        fill_definite<6>(random, 1, 1, a);
        a[6 * row + column] = bad;
        CHECK(math::Ldlt<6, T>(a).positive_definite() == (column > row));
      }
  const T zero[9] = {};
  T x[3] = {T(1), T(2), T(3)};
  CHECK_FALSE(math::Ldlt<3, T>(zero).positive_definite());
  math::Ldlt<3, T>(zero).solve(x, x);
  for (const T v : x) CHECK(v == T(0));
}

TEST_CASE_TEMPLATE("Ldlt: a lane is a matrix of its own", T, float, double) {
  using L = Lane<T>;
  Random random = seeded(4);
  T a[L::lanes][9], b[L::lanes][3];
  L lanes_a[9], lanes_b[3], lanes_x[3];
  for (std::size_t w = 0; w < L::lanes; ++w) {
    fill_definite<3>(random, 1, 1, a[w]);
    for (T& v : b[w]) v = static_cast<T>(uniform(random, -1.0, 1.0));
  }
  if (L::lanes > 1) a[1][8] = nan_of<T>;
  for (std::size_t i = 0; i < 9; ++i) {
    T row[L::lanes];
    for (std::size_t w = 0; w < L::lanes; ++w) row[w] = a[w][i];
    lanes_a[i] = L::load(row);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    T row[L::lanes];
    for (std::size_t w = 0; w < L::lanes; ++w) row[w] = b[w][i];
    lanes_b[i] = L::load(row);
  }
  const math::Ldlt<3, L> factors(lanes_a);
  CHECK(factors.positive_definite() == (L::lanes == 1));
  factors.solve(lanes_b, lanes_x);
  for (std::size_t w = 0; w < L::lanes; ++w) {
    T x[3];
    math::Ldlt<3, T>(a[w]).solve(b[w], x);
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(std::abs(lanes_x[i][w] - x[i]) <= tolerance<T> * (T(1) + std::abs(x[i])));
  }
}

TEST_CASE("Ldlt: in 50 digits, and without allocation") {
  Random random = seeded(5);
  double d[36];
  fill_definite<6>(random, 1, 1, d);
  Digits50 a[36], b[6], x[6];
  for (std::size_t i = 0; i < 36; ++i) a[i] = Digits50(d[i]);
  for (Digits50& v : b) v = Digits50(1) / 3;
  const math::Ldlt<6, Digits50> factors(a);
  CHECK(factors.positive_definite());
  factors.solve(b, x);
  CHECK(backward_error<6>(a, x, b) <= 24);

  double y[6] = {1, 2, 3, 4, 5, 6};
  const AllocationGuard guard;
  math::Ldlt<6>(d).solve(y, y);
  CHECK(guard.count() == 0);
}

TEST_CASE_TEMPLATE(
    "BlockLdlt: as exact as Ldlt, also where units differ by 1e8, for several right sides at once", T, float,
    double) {
  Random random = seeded(61);
  double worst = 0, worst_of_ldlt = 0;
  for (int k = 0; k < 500; ++k) {
    T a[36], b[6], x[6], y[6];
    fill_definite<6>(random, k % 2 == 0 ? 1 : 1e-3, k % 3 == 0 ? 1e4 : 1, a);
    for (T& v : b) v = static_cast<T>(uniform(random, -1.0, 1.0) * std::exp2(k % 40 - 20));
    const math::detail::BlockLdlt<T> factors(a);
    REQUIRE(factors.positive_definite());
    factors.solve(b, x);
    math::Ldlt<6, T>(a).solve(b, y);
    Digits50 m[36], exact[6], right[6];
    for (std::size_t i = 0; i < 36; ++i) m[i] = Digits50(a[i]);
    for (std::size_t i = 0; i < 6; ++i) right[i] = Digits50(b[i]);
    math::Ldlt<6, Digits50>(m).solve(right, exact);
    // In the units of each unknown: sqrt of the diagonal.
    const auto error = [&](const T(&of)[6]) {
      Digits50 size = 0, wrong = 0;
      for (std::size_t i = 0; i < 6; ++i) {
        size += exact[i] * exact[i] * m[7 * i];
        wrong += (of[i] - exact[i]) * (of[i] - exact[i]) * m[7 * i];
      }
      return static_cast<double>(Digits50(sqrt(wrong / size))) / double(std::numeric_limits<T>::epsilon());
    };
    worst = std::max(worst, error(x));
    worst_of_ldlt = std::max(worst_of_ldlt, error(y));

    using Row = skinctl::detail::Row<3, T>;
    Row rows[6];
    for (std::size_t i = 0; i < 6; ++i) rows[i] = Row::of([&](auto n) { return T(n == 1 ? b[i] : T(0)); });
    factors.solve(rows, rows);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(rows[i][0] == T(0));
      CHECK(size_of(T(rows[i][1] - x[i])) <=
            16 * double(std::numeric_limits<T>::epsilon()) * (size_of(x[i]) + size_of(rows[i][1])) * 64);
    }
    factors.solve(b, b);
    for (std::size_t i = 0; i < 6; ++i) CHECK(b[i] == x[i]);
  }
  CAPTURE(worst);
  CHECK(worst <= 4 * worst_of_ldlt);
}

TEST_CASE_TEMPLATE("BlockLdlt: a matrix that is not positive definite is told, whichever pivot fails", T,
                   float, double) {
  Random random = seeded(62);
  for (std::size_t dead = 0; dead < 6; ++dead)
    for (const T& spoil : {T(0), T(-1), nan_of<T>}) {
      T a[36], b[6] = {T(1), T(2), T(3), T(4), T(5), T(6)};
      fill_definite<6>(random, 1, 1, a);
      CHECK(math::detail::BlockLdlt<T>(a).positive_definite());
      a[7 * dead] = spoil;
      const math::detail::BlockLdlt<T> factors(a);
      CHECK_FALSE(factors.positive_definite());
      factors.solve(b, b);  // defined or not: nothing traps
    }
  // Twice the same row: semi-definite to rounding.
  T a[36];
  fill_definite<6>(random, 1, 1, a);
  for (std::size_t i = 0; i < 6; ++i) a[6 + i] = a[i];
  for (std::size_t i = 0; i < 6; ++i) a[6 * i + 1] = a[6 * i];
  CHECK_FALSE(math::detail::BlockLdlt<T>(a).positive_definite());
}
