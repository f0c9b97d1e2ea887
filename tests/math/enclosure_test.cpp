// by night: rounding proofs
#include "bench/studies/proofs/enclosure.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "bench/studies/proofs/lane_form.hpp"
#include "tests/support/digits50.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;
namespace {

bool holds(const math::Enclosure& e, const Digits50& x) {
  return Digits50(e.low) <= x && x <= Digits50(e.high);
}
math::Enclosure around(oracle::Random& random, double reach) {
  const double middle = random.uniform(-reach, reach), half = std::pow(10, random.uniform(-17, 1));
  return {middle - half, middle + half};
}
double inside(oracle::Random& random, const math::Enclosure& e) {
  return std::fmin(std::fmax(e.low + random.uniform(0, 1) * e.width(), e.low), e.high);
}

}  // namespace

TEST_CASE("Enclosure: contains the exact result of every operation for numbers of its operands") {
  oracle::Random random(4);
  for (int k = 0; k < 4000; ++k) {
    const auto a = around(random, k % 3 == 0 ? 1e-3 : 3), b = around(random, 3);
    const double x = inside(random, a), y = inside(random, b);
    const Digits50 u(x), v(y);
    CHECK(holds(a + b, u + v));
    CHECK(holds(a - b, u - v));
    CHECK(holds(a * b, u * v));
    if (!b.contains(0)) CHECK(holds(a / b, u / v));
    CHECK(holds(square(a), u * u));
    CHECK(holds(abs(a), abs(u)));
    CHECK(holds(exp(a), exp(u)));
    CHECK(holds(tanh(a), tanh(u)));
    CHECK(holds(sin(a), sin(u)));
    CHECK(holds(cos(a), cos(u)));
    if (x > 0) CHECK(holds(sqrt(a), sqrt(u)));
  }
}

TEST_CASE(
    "Enclosure: exact results stay points, inexact ones are one unit wide, quotients by zero are endless") {
  using math::Enclosure;
  CHECK((Enclosure(0.1) + Enclosure(0)).is_point());
  CHECK((Enclosure(0.1) * Enclosure(0.5)).is_point());
  CHECK((Enclosure(3) / Enclosure(4)).is_point());
  CHECK((Enclosure(1) - Enclosure(1)).is_point());
  CHECK(sqrt(Enclosure(9)).is_point());
  const Enclosure third = Enclosure(1) / Enclosure(3);
  CHECK(third.high == std::nextafter(third.low, 1.0));
  CHECK(std::isinf((Enclosure(1) / Enclosure(-1, 1)).high));
  CHECK(sin(Enclosure(0, 7)).width() == 2);
}

TEST_CASE("Affine forms in lanes: contain what products of sines and cosines are anywhere in a box") {
  using L = Lane<double, native_lanes<double>>;
  using F = math::detail::LaneForm<L>;
  const std::uint16_t places[] = {0, 1};
  const math::detail::InputSet both{places, 2};
  oracle::Random random(9);
  for (int k = 0; k < 400; ++k) {
    // sin(a) cos(b) (cos(a) - sin(b)) in a box of a and b.
    const double half = k % 2 == 0 ? random.uniform(0, 0.4) : random.uniform(0, 3);
    const double a = random.uniform(-3, 3), b = random.uniform(-3, 3);
    std::array<std::array<L, 2>, 9> slopes{};
    std::array<F, 9> f;
    for (std::size_t i = 0; i < f.size(); ++i) f[i].slope = slopes[i].data();
    const auto input = [&](F& x, double middle, std::size_t at) {
      x.set({L(middle - half), L(middle + half)}, both);
      x.slope[at] = x.rest;
      x.rest = L(0.0);
    };
    input(f[0], a, 0), input(f[1], b, 1);
    sine_or_cosine(f[0], true, 0, f[2], both);
    sine_or_cosine(f[1], false, 1, f[3], both);
    sine_or_cosine(f[0], false, 0, f[4], both);
    sine_or_cosine(f[1], true, 1, f[5], both);
    multiply(f[2], f[3], f[6], both);
    add(f[4], -1, f[5], f[7], both);
    multiply(f[6], f[7], f[8], both);
    for (int n = 0; n < 50; ++n) {
      const double s = random.uniform(-1, 1), t = random.uniform(-1, 1);
      const long double x = static_cast<long double>(a) + s * half,
                        y = static_cast<long double>(b) + t * half;
      const auto value = static_cast<double>(std::sin(x) * std::cos(y) * (std::cos(x) - std::sin(y)));
      CHECK(value >= f[8].range.low[0] - 1e-15);
      CHECK(value <= f[8].range.high[0] + 1e-15);
      // The form itself, not only the enclosure beside it.
      const double middle = f[8].centre[0] + s * f[8].slope[0][0] + t * f[8].slope[1][0];
      CHECK(std::abs(value - middle) <= f[8].rest[0] + 1e-15);
    }
  }
}
