// by night: rounding proofs
#include "bench/studies/proofs/bound.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "bench/studies/proofs/traced.hpp"
#include "bench/studies/proofs/traced_output.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/math/sincos.hpp"
#include "skinctl/math/tanh.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/digits50.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;
namespace {

/// Some of everything, in any scalar.
template <class T>
T program(const T& x, const T& y) {
  using std::exp, std::sqrt;
  const auto turn = math::sincos(x);
  const T a = turn.sin * y + T(0.1) * turn.cos;
  const T b = (a * a + T(2) * y * y) / (T(3) + a);
  return math::tanh(T(b - x)) * sqrt(T(T(1) + b * b)) - exp(T(T(-0.3) * b)) / T(7);
}
template <class T>
T solved(const T& x, const T& y) {
  const T a[] = {T(2) + x * x, x * y, T(0.25), x * y, T(3), y, T(0.25), y, T(4) + y};
  const T b[] = {x, y, T(1)};
  T out[3];
  math::Ldlt<3, T>(a).solve(b, out);
  return out[0] + out[1] * out[2];
}

template <class R>
double error_of(R (*f)(const R&, const R&), Digits50 (*exact)(const Digits50&, const Digits50&), R x, R y) {
  return static_cast<double>(abs(Digits50(f(x, y)) - exact(Digits50(x), Digits50(y))));
}

}  // namespace

TEST_CASE_TEMPLATE("Bound: no program's error is above its bound, and the exact value is in the enclosure", R,
                   float, double) {
  oracle::Random random(1);
  math::undecided() = 0;
  double tightest = 1e300;
  for (int k = 0; k < (skinctl::testing::sanitized ? 300 : 3000); ++k) {
    const R x = static_cast<R>(random.uniform(-2, 2)), y = static_cast<R>(random.uniform(-2, 2));
    const auto check = [&](const math::Bound<R>& bound, const Digits50& exact, double error) {
      CHECK(Digits50(bound.value().low) <= exact);
      CHECK(exact <= Digits50(bound.value().high));
      CHECK(error <= bound.error());
      if (error > 0) tightest = std::min(tightest, bound.error() / error);
    };
    check(program<math::Bound<R>>(x, y), program<Digits50>(Digits50(x), Digits50(y)),
          error_of<R>(program<R>, program<Digits50>, x, y));
    check(solved<math::Bound<R>>(x, y), solved<Digits50>(Digits50(x), Digits50(y)),
          error_of<R>(solved<R>, solved<Digits50>, x, y));
  }
  CHECK(math::undecided() == 0);
  CHECK(tightest < 3);  // it is no use if it is too wide
}

TEST_CASE("Bound: a comparison that rounding could turn is counted, copies and constants are equal") {
  using B = math::Bound<float>;
  math::undecided() = 0;
  const B x = B(1) / B(3), y = B(1) / B(3), copy = x;
  CHECK(copy == x);
  CHECK_FALSE(copy < x);
  CHECK(B(0.1) == B(0.1));
  CHECK(x < B(0.5));
  CHECK(math::undecided() == 0);
  CHECK(x - y < B(1e-6));
  CHECK(math::undecided() == 0);
  static_cast<void>(x - y > B(1e-9));
  CHECK(math::undecided() == 1);
  CHECK(std::isinf((B(1) / (x - y)).error()));
}

TEST_CASE(
    "Traced: no error in a box is above its bound, and the bound falls to a few times the largest found") {
  const math::Enclosure range(0.4, 0.6), other(-1.1, -0.9);
  const auto record = [&]<class R>(math::Tape& tape, R) {
    const math::Tape::Recording recording(tape);
    const auto x = math::Traced<R>::input(range), y = math::Traced<R>::input(other);
    return std::pair(program(x, y).node(), solved(x, y).node());
  };
  math::Tape tape, in_double;
  math::undecided() = 0;
  const auto nodes = record(tape, 0.0f), nodes_in_double = record(in_double, 0.0);
  CHECK(math::undecided() == 0);
  CHECK_FALSE(
      math::same_program(tape, in_double));  // a pivot is compared with 8 epsilon, another number in double
  using L = math::TracedOutput::L;
  for (const bool first : {true, false}) {
    math::TracedOutput output(tape, first ? nodes.first : nodes.second);
    math::TracedOutput other_output(in_double, first ? nodes_in_double.first : nodes_in_double.second);
    REQUIRE(output.inputs().size() == 2);
    const L low[] = {L(range.low), L(other.low)}, high[] = {L(range.high), L(other.high)};
    const auto box = output(low, high), box_in_double = other_output(low, high);
    oracle::Random random(3);
    double found = 0, found_double = 0;
    for (int k = 0; k < (skinctl::testing::sanitized ? 200 : 2000); ++k) {
      const auto x = static_cast<float>(random.uniform(0.4, 0.6)),
                 y = static_cast<float>(random.uniform(-1.1, -0.9));
      const double u = random.uniform(0.4, 0.6), v = random.uniform(-1.1, -0.9);
      found = std::max(found, first ? error_of<float>(program<float>, program<Digits50>, x, y)
                                    : error_of<float>(solved<float>, solved<Digits50>, x, y));
      found_double = std::max(found_double, first ? error_of<double>(program<double>, program<Digits50>, u, v)
                                                  : error_of<double>(solved<double>, solved<Digits50>, u, v));
      // At a point the bound holds for that point.
      const L at[] = {L(static_cast<double>(x)), L(static_cast<double>(y))};
      CHECK((first ? error_of<float>(program<float>, program<Digits50>, x, y)
                   : error_of<float>(solved<float>, solved<Digits50>, x, y)) <= output(at, at).in_float[0]);
    }
    CAPTURE(found);
    CHECK(found <= box.in_float[0]);
    CHECK(found_double <= box_in_double.in_double[0]);
    CHECK(box.in_float[0] < 6 * found);
    CHECK(box_in_double.in_double[0] < 6 * found_double);
  }
}

TEST_CASE("Traced: a box in which a comparison may come out differently has no bound") {
  math::Tape tape;
  math::undecided() = 0;
  std::int32_t node = 0;
  {
    const math::Tape::Recording recording(tape);
    const auto x = math::Traced<float>::input({0.5, 1});
    node = (x < math::Traced<float>(0.25) ? x * x : x / math::Traced<float>(3)).node();
  }
  CHECK(math::undecided() == 0);
  math::TracedOutput output(tape, node);
  using L = math::TracedOutput::L;
  const auto at = [&](double low, double high) {
    const L from[] = {L(low)}, to[] = {L(high)};
    return output(from, to).in_float[0];
  };
  CHECK(at(0.3, 0.4) < 1e-7);
  CHECK(std::isinf(at(0.2, 0.3)));
  CHECK(std::isinf(at(0.1, 0.2)));
  {
    math::Tape other;
    const math::Tape::Recording recording(other);
    const auto x = math::Traced<float>::input({0, 1});
    static_cast<void>(x < math::Traced<float>(0.25));
  }
  CHECK(math::undecided() == 1);
}
