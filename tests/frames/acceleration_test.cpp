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
