#include "skinctl/core/triple.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "tests/support/digits50.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;

namespace {
using X_axis = Triple<TypedConstant<1>, TypedConstant<0>, TypedConstant<0>>;
using Y_axis = Triple<TypedConstant<0>, TypedConstant<1>, TypedConstant<0>>;

template <class T>
Xyz<T> random_xyz(std::mt19937_64& rng, const T& reach) {
  std::uniform_real_distribution<double> draw(-1.0, 1.0);
  const T x(static_cast<T>(draw(rng))), y(static_cast<T>(draw(rng))), z(static_cast<T>(draw(rng)));
  return {reach * x, reach * y, reach * z};
}
template <class T>
T size(const Xyz<T>& v) {
  using std::sqrt;
  return sqrt(dot(v, v));
}
}  // namespace

static_assert(sizeof(Xyz<double>) == 3 * sizeof(double) && std::is_trivially_copyable_v<Xyz<double>>);
static_assert(sizeof(Triple<double, TypedConstant<0>, TypedConstant<1>>) == sizeof(double),
              "constants are not stored");
static_assert(std::is_same_v<decltype(cross(X_axis{}, Y_axis{})), UnitZ>, "x cross y is z, at compile time");
static_assert(std::is_same_v<decltype(dot(X_axis{}, Y_axis{})), TypedConstant<0>>);
static_assert(std::is_same_v<decltype(UnitZ{} - UnitZ{}), ZeroTriple>);
static_assert(std::is_same_v<decltype(TypedConstant<0>{} * Xyz<double>{}), ZeroTriple>);
static_assert(
    std::is_same_v<decltype(cross(UnitZ{}, Xyz<double>{})), Triple<double, double, TypedConstant<0>>>,
    "two products and no sum are left of a cross product with z");
static_assert(Xyz<double>{1, 2, 3} == dense<double>(Triple{TypedConstant<1>{}, 2.0, TypedConstant<3>{}}));

TEST_CASE_TEMPLATE("Triple: is a vector space with the products of the textbook", T, float, double,
                   Digits50) {
  using std::abs;
  std::mt19937_64 rng(1);
  const T eps = std::numeric_limits<T>::epsilon();
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
    for (int i = 0; i < 50; ++i) {
      const auto u = random_xyz(rng, reach), v = random_xyz(rng, reach), w = random_xyz(rng, T(1));
      CHECK((u + v) - v == (u + v) + -v);
      CHECK(T(2) * u == u + u);
      CHECK(dot(u, v) == dot(v, u));
      CHECK(cross(u, v) == -cross(v, u));
      CHECK(abs(dot(cross(u, v), u)) <= T(8) * eps * reach * reach * reach);
      // Lagrange: |u x w|^2 + (u . w)^2 = |u|^2 |w|^2
      const T lagrange = dot(cross(u, w), cross(u, w)) + dot(u, w) * dot(u, w) - dot(u, u) * dot(w, w);
      CHECK(abs(lagrange) <= T(64) * eps * reach * reach);
    }
  }
}

TEST_CASE_TEMPLATE("Triple: a constant component changes the cost of a product, not its value", T, float,
                   double) {
  std::mt19937_64 rng(2);
  const auto v = random_xyz(rng, T(1));
  const Xyz<T> z{T(0), T(0), T(1)};
  CHECK(dense<T>(cross(UnitZ{}, v)) == cross(z, v));
  CHECK(dense<T>(cross(v, UnitZ{})) == cross(v, z));
  CHECK(dot(UnitZ{}, v) == dot(z, v));
  CHECK(dense<T>(v + UnitZ{}) == v + z);
  CHECK(dense<T>(UnitZ{} - v) == z - v);
  CHECK(skinctl::cast<double>(v).x == double(v.x));
}

TEST_CASE_TEMPLATE("Turn: there and back is where it was, and keeps lengths", T, float, double, Digits50) {
  using std::abs;
  using std::cos;
  using std::sin;
  std::mt19937_64 rng(3);
  const T eps = std::numeric_limits<T>::epsilon();
  for (const T& angle : {T(0), T(1e-8), T(1), T(3.14159), T(-100)}) {
    const Turn turn{cos(angle), sin(angle)};
    const auto v = random_xyz(rng, T(1));
    CHECK(size(turn_back_z(turn, turn_z(turn, v)) - v) <= T(8) * eps);
    CHECK(size(turn_back_x(turn, turn_x(turn, v)) - v) <= T(8) * eps);
    CHECK(abs(T(size(turn_z(turn, v)) - size(v))) <= T(8) * eps);
  }
}

TEST_CASE("Turn: a quarter by constants is exact and by the right hand") {
  constexpr Turn quarter{TypedConstant<0>{}, TypedConstant<1>{}};
  constexpr Xyz<double> v{1, 2, 3};
  static_assert(turn_z(quarter, v) == Xyz<double>{-2, 1, 3});
  static_assert(turn_back_z(quarter, v) == Xyz<double>{2, -1, 3});
  static_assert(turn_x(quarter, v) == Xyz<double>{1, -3, 2});
  static_assert(turn_back_x(quarter, v) == Xyz<double>{1, 3, -2});
  CHECK(turn_z(quarter, v) == Xyz<double>{-2, 1, 3});
}

TEST_CASE_TEMPLATE("norm: the length, also where its square underflows or overflows", T, float, double) {
  CHECK(norm(Xyz<T>{T(3), T(-4), T(12)}) == T(13));
  CHECK(norm(Xyz<T>{}) == T(0));
  const T tiny = std::numeric_limits<T>::min(), huge = std::numeric_limits<T>::max() / T(16);
  CHECK(norm(Xyz<T>{T(3) * tiny, T(4) * tiny, T(0)}) == T(5) * tiny);
  CHECK(norm(Xyz<T>{T(0), T(3) * huge, T(4) * huge}) == T(5) * huge);
  const T nan = std::numeric_limits<T>::quiet_NaN();
  CHECK(std::isnan(norm(Xyz<T>{T(0), T(0), nan})));
  CHECK(std::isnan(norm(Xyz<T>{nan, T(0), T(0)})));
}
