#include "skinctl/frames/acceleration.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <type_traits>

using namespace skinctl;

using A_BC = Acceleration<Cell, Base>;
static_assert(std::is_trivially_copyable_v<A_BC> && sizeof(A_BC) == 6 * sizeof(double));
template <class A, class B>
concept addable = requires(const A& a, const B& b) { a + b; };
static_assert(addable<A_BC, A_BC>);
static_assert(!addable<A_BC, Twist<Cell, Base>> && !addable<A_BC, Acceleration<Tool, Base>>);

TEST_CASE("Acceleration: a vector space, component by component") {
  const A_BC a{{1, 2, 3}, {4, 5, 6}}, b{{-2, 7, 1}, {0.5, 3, -1}};
  const A_BC c = 2.0 * (a + b) - a - b - (-a);
  CHECK(as_eigen(c) == 2 * as_eigen(a) + as_eigen(b));
  CHECK(as_eigen(A_BC{}).norm() == 0);
}

TEST_CASE_TEMPLATE("Acceleration: to Eigen and back is the same", T, float, double) {
  using Q = Acceleration<Tool, Base, Tool, Base, T>;
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
