#include "skinctl/kinematics/singularity_damping.hpp"

#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "skinctl/kinematics/detail/determinant_rate.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using Wide = boost::multiprecision::cpp_bin_float_50;

TEST_CASE("SingularityDamping: settings that cannot work are refused") {
  CHECK_THROWS_AS(SingularityDamping<double>(0), ConfigurationError);
  CHECK_THROWS_AS(SingularityDamping<double>(0.01, -1), ConfigurationError);
  CHECK_THROWS_AS(SingularityDamping<double>(std::nan("")), ConfigurationError);
}

TEST_CASE_TEMPLATE("SingularityDamping: none outside of the zone, most at the singularity, smooth between", T,
                   float, double) {
  const double zone = 0.004, most = 0.08;
  const SingularityDamping<T> damping{T(zone), T(most)};
  const double ulps = 32 * double(std::numeric_limits<T>::epsilon());
  CHECK(damping.nearness(T(0)) == T(1));
  CHECK(double(damping.squared(T(0))) == doctest::Approx(most * most).epsilon(ulps));
  CHECK(damping.squared(T(zone * zone) * T(1.001)) == T(0));
  CHECK(damping.squared_rate(T(zone * zone) * T(1.001), T(1)) == T(0));
  CHECK(std::isnan(damping.squared(std::numeric_limits<T>::quiet_NaN())));
  for (int k = 0; k <= 1000; ++k) {
    const T w2 = T(zone * zone * k / 1000);
    // The equation again, in 50 digits of the numbers that the damping has.
    const Wide z = T(zone), m = T(most), r = 1 - Wide(w2) / (z * z);
    const Wide l2 = m * m * r * r, rate = -2 * m * m * r / (z * z);
    CHECK(std::abs(double(damping.squared(w2) - l2)) <= ulps * most * most);
    CHECK(std::abs(double(damping.squared_rate(w2, T(1)) - rate)) <= ulps * 2 * most * most / (zone * zone));
  }
}

TEST_CASE("SingularityDamping: what a requested speed needs, so that no joint exceeds its own") {
  const double most = 0.08, least = 0.01, fastest = 2;
  const SingularityDamping<double> damping(0.004, most);
  double before = 0;
  for (int k = 0; k <= 400; ++k) {
    const double speed = 0.002 * k;
    const auto now = damping.scaled(least, speed * speed, 0, fastest);
    const double l = std::sqrt(now.squared(0));
    CHECK(l >= before);
    before = l;
    CHECK(l >= least * (1 - 1e-12));
    CHECK(l <= std::sqrt(least * least + most * most));
    // A singular direction of singular value s moves at s / (s^2 + l^2), at most 1 / (2 l), times the speed.
    const double x = std::pow(speed / (2 * fastest), 2);
    CHECK(speed / (2 * l) <= fastest * std::sqrt(1 + x / (most * most)) * (1 + 1e-12));
    // Its rate is the slope over the square of the speed.
    const double h = 1e-6;
    const double slope = (damping.scaled(least, speed * speed + h, 0, fastest).squared(0) -
                          damping.scaled(least, speed * speed, 0, fastest).squared(0)) /
                         h;
    CHECK(damping.scaled(least, speed * speed, 1, fastest).squared_rate(0, 0) ==
          doctest::Approx(slope).epsilon(1e-4));
  }
}

TEST_CASE("determinant: value and rate of a symmetric matrix, singular ones as well") {
  oracle::Random random(3);
  for (int k = 0; k < 200; ++k) {
    constexpr int n = 4;
    // A = B'B with B of rank 3 or 4, dA = B'C + C'B: the rate of the determinant by a difference in 50
    // digits.
    double b[n][n], c[n][n];
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) b[i][j] = random.uniform(-1, 1), c[i][j] = random.uniform(-1, 1);
    if (k % 4 == 0)
      for (int j = 0; j < n; ++j) b[3][j] = b[0][j];
    double a[n][n], da[n][n];
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        a[i][j] = da[i][j] = 0;
        for (int r = 0; r < n; ++r)
          a[i][j] += b[r][i] * b[r][j], da[i][j] += b[r][i] * c[r][j] + c[r][i] * b[r][j];
      }
    const auto det = [&](const Wide& t) {  // by minors of the first row, again and again: no elimination
      const auto minors = [&](const auto& self, unsigned columns, int row) -> Wide {
        if (row == n) return 1;
        Wide sum = 0;
        int sign = 1;
        for (int j = 0; j < n; ++j) {
          if ((columns >> j) & 1u) continue;
          sum += sign * (Wide(a[row][j]) + t * Wide(da[row][j])) * self(self, columns | (1u << j), row + 1);
          sign = -sign;
        }
        return sum;
      };
      return minors(minors, 0, 0);
    };
    const Wide h("1e-20"), value = det(0), rate = (det(h) - det(-h)) / (2 * h);
    const auto found = detail::determinant(a, da);
    CHECK(std::abs(found.value - double(value)) < 1e-13);
    CHECK(std::abs(found.rate - double(rate)) < 1e-12);
  }
}
