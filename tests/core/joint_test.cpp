// Promise: durations, frames, joint quantities cost nothing
// Tried: size and instructions of the bare types. Also: `frames/`, `bench/core/joint_bench.cpp`

#include "skinctl/core/joint.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <type_traits>

#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;

namespace {
using q6 = JointPosition<6>;

template <class A, class B>
concept has_sum = requires(A a, B b) { a + b; };
template <class A, class B>
concept has_difference = requires(A a, B b) { a - b; };
template <class A, class B>
concept has_product = requires(A a, B b) { a* b; };
template <class A, class B>
concept has_power = requires(A a, B b) { power(a, b); };

template <class V>
V random_joints(std::mt19937_64& rng, double reach) {
  std::uniform_real_distribution<double> draw(-reach, reach);
  V v;
  for (auto& x : v) x = static_cast<typename V::scalar>(draw(rng));
  return v;
}
template <class T>
constexpr bool has_no_cost =
    sizeof(JointPosition<6, T>) == 6 * sizeof(T) && alignof(JointPosition<6, T>) == alignof(T) &&
    std::is_trivially_copyable_v<JointPosition<6, T>> && std::is_standard_layout_v<JointPosition<6, T>>;
}  // namespace

static_assert(has_no_cost<float> && has_no_cost<double>);
static_assert(has_sum<q6, q6> && has_difference<q6, q6>);
static_assert(!has_sum<q6, JointTorque<6>> && !has_difference<q6, JointTorque<6>>);
static_assert(!has_sum<q6, JointVelocity<6>> && !has_sum<JointVelocity<6>, JointAcceleration<6>>);
static_assert(!has_sum<q6, JointPosition<7>> && !has_difference<q6, JointPosition<7>>);
static_assert(!has_sum<q6, JointPosition<6, float>>);
static_assert(has_product<double, q6> && has_product<q6, double>);
static_assert(!has_product<JointTorque<6>, JointVelocity<6>>, "the scalar product is power(tau, dq)");
static_assert(has_power<JointTorque<6>, JointVelocity<6>> && !has_power<JointTorque<6>, q6> &&
              !has_power<JointTorque<6>, JointVelocity<7>>);
static_assert(!std::is_constructible_v<q6, JointTorque<6>> && !std::is_convertible_v<JointTorque<6>, q6>);
static_assert(!std::is_constructible_v<JointPosition<3>, double, double>, "one number per joint");
static_assert(!std::is_convertible_v<double, q6> && !std::is_constructible_v<q6, double>);
static_assert(!std::is_convertible_v<Eigen::Matrix<double, 6, 1>, q6>, "from Eigen only on purpose");
static_assert(q6::size() == 6 && q6{}[5] == 0.0, "zero by default");
static_assert((JointPosition<2>{1.0, 2.0} + JointPosition<2>{3.0, 4.0})[1] == 6.0,
              "usable in constant expressions");

TEST_CASE_TEMPLATE("JointVector: equal kinds form a vector space", T, float, double, Digits50) {
  using V = JointVelocity<6, T>;
  std::mt19937_64 rng(1);
  for (double reach : {0.0, 1e-8, 1.0, 1e6}) {
    const V a = random_joints<V>(rng, reach), b = random_joints<V>(rng, reach);
    CHECK(a + b == b + a);
    CHECK(a - b == a + -b);
    CHECK(T(2) * a == a + a);
    CHECK(a * T(2) == T(2) * a);
    V c = a;
    c += b;
    CHECK(c == a + b);
    c -= b;
    CHECK(c == (a + b) - b);
    c *= T(2);
    CHECK(c == T(2) * ((a + b) - b));
    CHECK(a - a == V{});
    CHECK((reach == 0.0 || !(a == b)));
  }
}

TEST_CASE_TEMPLATE("JointVector: a step of constant velocity and its way back meet", T, float, double) {
  std::mt19937_64 rng(2);
  const auto q = random_joints<JointPosition<6, T>>(rng, 3.0);
  const auto dq = random_joints<JointVelocity<6, T>>(rng, 3.0);
  const auto ddq = random_joints<JointAcceleration<6, T>>(rng, 10.0);
  const T h = T(0.125);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(integrate(integrate(q, dq, h), dq, -h)[i] - q[i]) <= tolerance<T>);
    CHECK(integrate(dq, ddq, h)[i] == dq[i] + h * ddq[i]);
  }
}

TEST_CASE_TEMPLATE("JointVector: power is the scalar product", T, float, double, Digits50) {
  std::mt19937_64 rng(3);
  const auto tau = random_joints<JointTorque<6, T>>(rng, 100.0);
  const auto dq = random_joints<JointVelocity<6, T>>(rng, 3.0);
  using std::abs;
  const T expected = std::inner_product(tau.begin(), tau.end(), dq.begin(), T(0));
  CHECK(abs(T(power(tau, dq) - expected)) <= T(600) * tolerance<T>);
  CHECK(power(-tau, dq) == -power(tau, dq));
}

TEST_CASE_TEMPLATE("JointVector: takes arrays, Eigen vectors and expressions of them", T, float, double) {
  using Eigen3 = Eigen::Matrix<T, 3, 1>;
  const Eigen3 e(T(1), T(2), T(3));
  const JointTorque<3, T> expected{T(2), T(4), T(6)};
  CHECK(JointTorque<3, T>(T(2) * e) == expected);
  CHECK(JointTorque<3, T>(Eigen::Matrix<T, Eigen::Dynamic, 1>(T(2) * e)) == expected);
  CHECK(JointTorque<3, T>(std::array<T, 3>{T(2), T(4), T(6)}) == expected);
  CHECK(JointTorque<3, T>::constant(T(2)) == JointTorque<3, T>{T(2), T(2), T(2)});
  CHECK(JointTorque<3, T>::generate([](std::size_t i) { return T(2) * T(i + 1); }) == expected);
  CHECK(expected.template cast<double>()[2] == 6.0);
}

TEST_CASE("JointVector: its algebra does not allocate") {
  std::mt19937_64 rng(4);
  const auto a = random_joints<JointTorque<22>>(rng, 1.0), b = random_joints<JointTorque<22>>(rng, 1.0);
  const testing::AllocationGuard guard;
  const auto c = 2.0 * a - b;
  const auto count = guard.count();
  CHECK(count == 0);
  CHECK(c[0] == 2.0 * a[0] - b[0]);
}
