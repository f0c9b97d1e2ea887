#include "skinctl/frames/twist.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <type_traits>

#include "tests/support/digits50.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
struct Hand : FrameTag {};
struct Fingertip : FrameTag {};

template <class V, class W>
concept has_sum = requires(V v, W w) { v + w; };
template <class V, class W>
concept has_difference = requires(V v, W w) { v - w; };
template <class X, class V>
concept transforms = requires(X x, V v) { x* v; };
template <class X, class V>
concept expresses = requires(X x, V v) { express(x, v); };

// V of Hand relative to World, at Hand's origin, along World's axes: V_WH_W.
using V_WH = Twist<Hand, World>;

template <class T>
Twist<Hand, World, Hand, Hand, T> random_twist(Random& rng, const T& size) {
  return {random_xyz(rng, size), random_xyz(rng, size)};
}
/// The velocity of another point of the same body, which is `p_PQ_E` away.
template <class Q, class B, class A, class P, class E, class T>
Twist<B, A, Q, E, T> at(const Twist<B, A, P, E, T>& V, const Xyz<T>& p_PQ_E) {
  return {V.linear + cross(V.angular, p_PQ_E), V.angular};
}
template <class V>
auto difference(const V& a, const V& b) {
  const auto linear = largest(a.linear - b.linear), angular = largest(a.angular - b.angular);
  return linear > angular ? linear : angular;
}

/// A body that turns and moves: `X_AB(t) = X_0 exp(t w) + t v + t^2 a`, with its exact velocity from
/// difference quotients.
struct Motion {
  Rotation<Digits50> R;
  Xyz<Digits50> w, p, v, a;
  explicit Motion(Random& rng)
      : R(random_rotation<Digits50>(rng)),
        w(random_xyz(rng, Digits50(2))),
        p(random_xyz(rng, Digits50(1))),
        v(random_xyz(rng, Digits50(1))),
        a(random_xyz(rng, Digits50(1))) {}
  template <class A, class B>
  Transform<A, B, Digits50> at(const Digits50& t) const {
    const Digits50 speed = norm(w);
    return Transform<A, B, Digits50>::trusted(rotation_about((1 / speed) * w, Digits50(speed * t)) * R,
                                              p + t * v + (t * t) * a);
  }
};
const Digits50 h("1e-16");
/// Velocity of B relative to A at B's origin along A's axes, from the poses a moment before and after.
template <class A, class B>
Twist<B, A, B, A, Digits50> velocity(const Transform<A, B, Digits50>& before,
                                     const Transform<A, B, Digits50>& after) {
  const Rotation<Digits50> D = after.axes() * before.axes().transpose();
  const Digits50 s = 1 / (4 * h);
  return {(1 / (2 * h)) * (after.origin() - before.origin()),
          {s * (D.y.z - D.z.y), s * (D.z.x - D.x.z), s * (D.x.y - D.y.x)}};
}
}  // namespace

static_assert(std::is_same_v<V_WH, Twist<Hand, World, Hand, World, double>>);
static_assert(std::is_trivially_copyable_v<V_WH> && sizeof(V_WH) == 6 * sizeof(double));
static_assert(has_sum<V_WH, V_WH> && has_difference<V_WH, V_WH>);
static_assert(has_sum<Twist<Base, World, Cell, World>, Twist<Hand, Base, Cell, World>>, "V_WB + V_BH = V_WH");
static_assert(std::is_same_v<decltype(Twist<Base, World, Cell, World>{} + Twist<Hand, Base, Cell, World>{}),
                             Twist<Hand, World, Cell, World>>);
static_assert(!has_sum<Twist<Base, World, Cell, World>, Twist<Hand, Base, Hand, World>>, "of two points");
static_assert(!has_sum<Twist<Base, World, Cell, World>, Twist<Hand, Base, Cell, Base>>, "along two axes");
static_assert(!has_sum<Twist<Hand, Base, Cell, World>, Twist<Base, World, Cell, World>>, "a chain backwards");
static_assert(!has_sum<V_WH, Twist<Hand, World, Hand, World, float>>);
static_assert(!has_difference<V_WH, Twist<Base, World>>);
static_assert(transforms<Transform<World, Hand>, Twist<Hand, World, Hand, Hand>>);
static_assert(!transforms<Transform<World, Hand>, V_WH>, "its axes are World's, its point Hand's");
static_assert(expresses<Transform<Hand, World>, V_WH> && !expresses<Transform<World, Hand>, V_WH>);

TEST_CASE_TEMPLATE("Twist: a transform changes point and axes, and its inverse changes them back", T, float,
                   double, Digits50) {
  auto rng = seeded(1);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
    for (int i = 0; i < 50; ++i) {
      const auto X_FH = random_transform<Fingertip, Hand>(rng, reach);
      const auto V = random_twist(rng, T(1));
      CAPTURE(as_code(X_FH));
      const Twist<Hand, World, Fingertip, Fingertip, T> there = X_FH * V;
      const T rounding = tolerance<T> * (T(1) + reach);
      CHECK(difference(express(X_FH, at<Fingertip>(V, X_FH.inverse().origin())), there) <= rounding);
      CHECK(difference(X_FH.inverse() * there, V) <= rounding);
    }
  }
}

TEST_CASE("Twist: is what the poses of a moving body say, at every point of it") {
  auto rng = seeded(2);
  for (int i = 0; i < 20; ++i) {
    const Motion motion(rng);
    const Digits50 t = uniform<Digits50>(rng);
    const auto V_WH_W = velocity(motion.at<World, Hand>(t - h), motion.at<World, Hand>(t + h));
    const auto X_WH = motion.at<World, Hand>(t);
    const auto X_HF = random_transform<Hand, Fingertip>(rng, Digits50(1));
    const auto V_WF_W = velocity(motion.at<World, Hand>(t - h) * X_HF, motion.at<World, Hand>(t + h) * X_HF);
    const auto shifted = at<Fingertip>(V_WH_W, X_WH.axes() * X_HF.origin());
    CHECK(largest(shifted.linear - V_WF_W.linear) <= Digits50("1e-29"));
    CHECK(largest(shifted.angular - V_WF_W.angular) <= Digits50("1e-29"));
  }
}

TEST_CASE("Twist: velocities add up along a chain of moving bodies, at one point along the same axes") {
  auto rng = seeded(3);
  for (int i = 0; i < 20; ++i) {
    const Motion base(rng), hand(rng);
    const Digits50 t = uniform<Digits50>(rng);
    const auto X_WB = base.at<World, Base>(t);
    const auto X_BH = hand.at<Base, Hand>(t);
    const auto V_WB_W = velocity(base.at<World, Base>(t - h), base.at<World, Base>(t + h));
    const auto V_BH_B = velocity(hand.at<Base, Hand>(t - h), hand.at<Base, Hand>(t + h));
    const auto V_WH_W = velocity(base.at<World, Base>(t - h) * hand.at<Base, Hand>(t - h),
                                 base.at<World, Base>(t + h) * hand.at<Base, Hand>(t + h));
    const auto sum = at<Hand>(V_WB_W, X_WB.axes() * X_BH.origin()) + express(X_WB, V_BH_B);
    CHECK(difference(sum, V_WH_W) <= Digits50("1e-29"));
    // And backwards: what the base sees of the world.
    const auto V_BW = velocity(base.at<World, Base>(t - h).inverse(), base.at<World, Base>(t + h).inverse());
    const auto reversed = at<World>(express(X_WB.inverse(), V_WB_W.reversed()), X_WB.inverse().origin());
    CHECK(difference(reversed, V_BW) <= Digits50("1e-29"));
  }
}

TEST_CASE_TEMPLATE("Twist: equal ones form a vector space, linear part first", T, float, double) {
  auto rng = seeded(4);
  const auto V = random_twist(rng, T(1));
  CHECK(difference(V + V, T(2) * V) == T(0));
  CHECK(difference((V - V) + -V, T(-1) * V) == T(0));
  const Vec6<T> v = as_eigen(V);
  CHECK(v(2) == V.linear.z);
  CHECK(v(3) == V.angular.x);
  CHECK(difference(V.template cast<Digits50>().template cast<T>(), V) == T(0));
}

TEST_CASE_TEMPLATE("Twist: to Eigen and back is the same", T, float, double) {
  using Q = Twist<Tool, Base, Tool, Base, T>;
  const Q x{{T(1), T(2), T(3)}, {T(-4), T(5), T(0.5)}};
  Vec6<T> v;
  v << T(1), T(2), T(3), T(-4), T(5), T(0.5);
  CHECK(as_eigen(x) == v);
  const Q back = Q::from_eigen(as_eigen(x));
  CHECK(back.linear == x.linear);
  CHECK(back.angular == x.angular);
  CHECK(as_eigen(Q::from_eigen(T(2) * v)) == T(2) * v);
  const Eigen::Matrix<T, Eigen::Dynamic, 1> any = v;
  CHECK(as_eigen(Q::from_eigen(any)) == v);
  static_assert(!std::is_assignable_v<Q&, Vec6<T>> && !std::is_convertible_v<Q, Vec6<T>>);
  static_assert(std::is_trivially_copyable_v<Q> && std::is_aggregate_v<Q>);
}
