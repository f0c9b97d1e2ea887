#include "skinctl/frames/momentum.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/testing/digits50.hpp"
#include "skinctl/testing/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class H, class K>
concept has_sum = requires(H h, K k) { h + k; };
template <class V, class H>
concept has_dot = requires(V v, H h) { dot(v, h); };
template <class X, class H>
concept transforms = requires(X x, H h) { x* h; };
using h_C = Momentum<Cell, World>;

template <class H>
auto difference(const H& a, const H& b) {
  const auto linear = largest(a.linear - b.linear), angular = largest(a.angular - b.angular);
  return linear > angular ? linear : angular;
}
}  // namespace

static_assert(std::is_trivially_copyable_v<h_C> && sizeof(h_C) == 6 * sizeof(double));
static_assert(has_sum<h_C, h_C> && !has_sum<h_C, Momentum<Cell, Base>> &&
              !has_sum<h_C, Momentum<Tool, World, Cell, Cell>>);
static_assert(has_dot<Twist<Cell, World, Cell, Cell>, h_C> && !has_dot<Twist<Cell, World>, h_C>);
static_assert(transforms<Transform<Root, Cell>, h_C> && !transforms<Transform<Cell, Root>, h_C>);

TEST_CASE_TEMPLATE("Momentum: v . p + omega . l is the same about every point and along all axes", T, float,
                   double, Digits50) {
  using std::abs;
  auto rng = seeded(1);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e3)}) {
    for (int i = 0; i < 50; ++i) {
      const Momentum<Cell, World, Cell, Cell, T> h{random_xyz(rng, T(1)), random_xyz(rng, T(1))};
      const Twist<Cell, World, Cell, Cell, T> V{random_xyz(rng, T(1)), random_xyz(rng, T(1))};
      const auto X_RC = random_transform<Root, Cell>(rng, reach);
      const auto p_CR_C = X_RC.inverse().offset();
      const T twice_energy = dot(V, h), rounding = tolerance<T> * (T(1) + reach);
      CAPTURE(as_code(X_RC));
      CHECK(abs(dot(X_RC * V, X_RC * h) - twice_energy) <= rounding);
      CHECK(abs(dot(shift(V, p_CR_C), shift(h, p_CR_C)) - twice_energy) <= rounding);
      CHECK(difference(express(X_RC, shift(h, p_CR_C)), X_RC * h) <= rounding);
      CHECK(difference((h + h) - T(2) * h, -(h - h)) == T(0));
    }
  }
}

TEST_CASE_TEMPLATE("Momentum: to Eigen and back is the same", T, float, double) {
  using Q = Momentum<Tool, Base, Tool, Base, T>;
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
