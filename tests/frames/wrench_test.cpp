#include "skinctl/frames/wrench.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "tests/support/digits50.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = Link<2>;

template <class F, class G>
concept has_sum = requires(F f, G g) { f + g; };
template <class F, class G>
concept has_difference = requires(F f, G g) { f - g; };
template <class F, class V>
concept has_power = requires(F f, V v) { power(f, v); };
template <class X, class F>
concept transforms = requires(X x, F f) { x* f; };
template <class X, class F>
concept expresses = requires(X x, F f) { express(x, f); };

template <class F>
auto difference(const F& a, const F& b) {
  const auto force = largest(a.force - b.force), moment = largest(a.moment - b.moment);
  return force > moment ? force : moment;
}
template <class P, class T>
Wrench<Arm, P, P, T> random_wrench(Random& rng, const T& size) {
  return {random_xyz(rng, size), random_xyz(rng, size)};
}
}  // namespace

static_assert(std::is_trivially_copyable_v<Wrench<Arm>> && sizeof(Wrench<Arm>) == 6 * sizeof(double));
static_assert(std::is_same_v<Wrench<Arm>, Wrench<Arm, Arm, Arm, double>>);
static_assert(has_sum<Wrench<Arm, Cell>, Wrench<Arm, Cell>> &&
              has_difference<Wrench<Arm, Cell>, Wrench<Arm, Cell>>);
static_assert(!has_sum<Wrench<Arm, Cell>, Wrench<Link<3>, Cell>>, "on two bodies");
static_assert(!has_sum<Wrench<Arm, Cell, World>, Wrench<Arm, Root, World>>, "about two points");
static_assert(!has_sum<Wrench<Arm, Cell, World>, Wrench<Arm, Cell, Base>>, "along two axes");
static_assert(!has_sum<Wrench<Arm, Cell, World, float>, Wrench<Arm, Cell, World, double>>);
static_assert(!has_difference<Wrench<Arm, Cell, World>, Wrench<Arm, Cell, Base>>);
static_assert(!has_sum<Twist<Arm, World, Arm, Arm>, Wrench<Arm>> &&
              !has_sum<Wrench<Arm>, Twist<Arm, World, Arm, Arm>>);
static_assert(has_power<Wrench<Arm>, Twist<Arm, World, Arm, Arm>>);
static_assert(!has_power<Wrench<Arm>, Twist<Link<3>, World, Arm, Arm>>, "of another body");
static_assert(!has_power<Wrench<Arm>, Twist<Arm, World, Cell, Arm>>, "of another point");
static_assert(!has_power<Wrench<Arm>, Twist<Arm, World, Arm, World>>, "along other axes");
static_assert(transforms<Transform<Arm, Cell>, Wrench<Arm, Cell>> &&
              !transforms<Transform<Cell, Arm>, Wrench<Arm, Cell>>);
static_assert(!transforms<Transform<Arm, Cell>, Wrench<Arm, Cell, World>>);
static_assert(expresses<Transform<World, Cell>, Wrench<Arm, Cell>> &&
              !expresses<Transform<Cell, World>, Wrench<Arm, Cell>>);

TEST_CASE_TEMPLATE("Wrench: a cell carries no moment about its own origin, about any other point it does", T,
                   float, double, Digits50) {
  auto rng = seeded(1);
  for (int i = 0; i < 100; ++i) {
    const auto X_AC = random_transform<Arm, Cell>(rng, T(0.3));
    const T newton = T(5);
    const Wrench<Arm, Cell, Cell, T> F_C{{T(0), T(0), -newton},
                                         {}};  // the world pushes against the outward normal
    const Wrench<Arm, Arm, Arm, T> F_A = X_AC * F_C;
    CAPTURE(as_code(X_AC));
    // The unit wrench of the cell on its link, u = -[z ; p x z], times the force.
    const Xyz<T> z = X_AC.axis_z(), p = X_AC.origin();
    CHECK(largest(F_A.force + newton * z) <= T(8) * epsilon<T>());
    CHECK(largest(F_A.moment + newton * cross(p, z)) <= T(8) * epsilon<T>());
    const auto back = X_AC.inverse() * F_A;
    CHECK(largest(back.moment) <= T(32) * epsilon<T>());
    // Along its line of action there is none either, elsewhere it is force times distance.
    using X_RC = Transform<Root, Cell, T>;
    CHECK(largest((X_RC::translation_xyz(T(0), T(0), T(-2)) * F_C).moment) == T(0));
    CHECK((X_RC::translation_xyz(T(-2), T(0), T(0)) * F_C).moment == Xyz<T>{T(0), T(-2) * newton, T(0)});
  }
}

TEST_CASE_TEMPLATE("Wrench: a transform changes point and axes, and its inverse changes them back", T, float,
                   double, Digits50) {
  auto rng = seeded(2);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
    for (int i = 0; i < 50; ++i) {
      const auto X_RC = random_transform<Root, Cell>(rng, reach);
      const auto F = random_wrench<Cell>(rng, T(1));
      CAPTURE(as_code(X_RC));
      const Wrench<Arm, Root, Root, T> there = X_RC * F;
      const T rounding = tolerance<T> * (T(1) + reach);
      const Wrench<Arm, Root, Cell, T> about_root{F.force,
                                                  F.moment + cross(F.force, X_RC.inverse().origin())};
      CHECK(difference(express(X_RC, about_root), there) <= rounding);
      CHECK(difference(X_RC.inverse() * there, F) <= rounding);
    }
  }
}

TEST_CASE_TEMPLATE("Wrench: its power on a moving body is the same about every point and along all axes", T,
                   float, double, Digits50) {
  using std::abs;
  auto rng = seeded(3);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e3)}) {
    for (int i = 0; i < 50; ++i) {
      const auto F = random_wrench<Cell>(rng, T(1));
      const Twist<Arm, World, Cell, Cell, T> V{random_xyz(rng, T(1)), random_xyz(rng, T(1))};
      const auto X_RC = random_transform<Root, Cell>(rng, reach);
      const T watt = power(F, V), rounding = tolerance<T> * (T(1) + reach);
      CAPTURE(as_code(X_RC));
      CHECK(abs(power(express(X_RC, F), express(X_RC, V)) - watt) <= rounding);
      CHECK(abs(power(X_RC * F, X_RC * V) - watt) <= rounding);
    }
  }
}

TEST_CASE_TEMPLATE("Wrench: the sum of forces at points is one wrench with the same power", T, float,
                   double) {
  using std::abs;
  auto rng = seeded(4);
  Wrench<Arm, Arm, Arm, T> sum;
  T watt(0);
  const Twist<Arm, World, Arm, Arm, T> V{random_xyz(rng, T(1)), random_xyz(rng, T(1))};
  for (int i = 0; i < 64; ++i) {
    const Xyz<T> p = random_xyz(rng, T(1)), f = random_xyz(rng, T(1));
    sum = sum + Transform<Arm, Cell, T>::translation_xyz(p.x, p.y, p.z) * Wrench<Arm, Cell, Cell, T>{f, {}};
    watt = watt + dot(f, V.linear + cross(V.angular, p));
  }
  CHECK(abs(power(sum, V) - watt) <= T(64) * tolerance<T>);
}

TEST_CASE_TEMPLATE("Wrench: equal ones form a vector space, force first", T, float, double) {
  auto rng = seeded(5);
  const auto F = random_wrench<Cell>(rng, T(1));
  CHECK(difference(F + F, T(2) * F) == T(0));
  CHECK(difference((F - F) + -F, T(-1) * F) == T(0));
  CHECK(as_eigen(F)(2) == F.force.z);
  CHECK(as_eigen(F)(3) == F.moment.x);
  const Wrench<Tool, Cell, Cell, T> same = F.template on<Tool>();
  CHECK(same.force == F.force);
  CHECK(same.moment == F.moment);
  CHECK(difference(F.template cast<Digits50>().template cast<T>(), F) == T(0));
}

TEST_CASE_TEMPLATE("Wrench: to Eigen and back is the same", T, float, double) {
  using Q = Wrench<Tool, Tool, Base, T>;
  const Q x{{T(1), T(2), T(3)}, {T(-4), T(5), T(0.5)}};
  Vec6<T> v;
  v << T(1), T(2), T(3), T(-4), T(5), T(0.5);
  CHECK(as_eigen(x) == v);
  const Q back = Q::from_eigen(as_eigen(x));
  CHECK(back.force == x.force);
  CHECK(back.moment == x.moment);
  CHECK(as_eigen(Q::from_eigen(T(2) * v)) == T(2) * v);
  const Eigen::Matrix<T, Eigen::Dynamic, 1> any = v;
  CHECK(as_eigen(Q::from_eigen(any)) == v);
  static_assert(!std::is_assignable_v<Q&, Vec6<T>> && !std::is_convertible_v<Q, Vec6<T>>);
  static_assert(std::is_trivially_copyable_v<Q> && std::is_aggregate_v<Q>);
}
