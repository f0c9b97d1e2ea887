#include "skinctl/frames/transform.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "skinctl/core/lane.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/digits50.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
struct Table : FrameTag {};

template <class X, class Y>
concept composable = requires(X x, Y y) { x* y; };
template <class X>
concept transform_of = requires { typename Transform<X, World>; };
template <class T>
concept has_no_cost =
    std::is_trivially_copyable_v<Transform<World, Cell, T>> &&
    sizeof(Transform<World, Cell, T>) == 12 * sizeof(T) && alignof(Transform<World, Cell, T>) == alignof(T) &&
    std::is_standard_layout_v<Transform<World, Cell, T>>;
}  // namespace

static_assert(composable<Transform<World, Table>, Transform<Table, Cell>>);
static_assert(!composable<Transform<World, Table>, Transform<Cell, Table>>);
static_assert(!composable<Transform<World, Table>, Transform<World, Table>>);
static_assert(!composable<Transform<World, Table>, Transform<Table, Cell, float>>,
              "one scalar in one product");
static_assert(
    std::is_same_v<decltype(Transform<World, Table>{} * Transform<Table, Cell>{}), Transform<World, Cell>>);
static_assert(std::is_same_v<decltype(Transform<World, Table>{}.inverse()), Transform<Table, World>>);
static_assert(!std::is_convertible_v<Transform<World, Table>, Transform<Table, World>>);
static_assert(!std::is_constructible_v<Transform<World, Table>, Transform<Table, World>>);
static_assert(!std::is_constructible_v<Transform<World, Table>, Transform<World, Table, float>>);
static_assert(!transform_of<int>);
static_assert(has_no_cost<float> && has_no_cost<double>);
static_assert((Transform<World, Table>::translation_xyz(1, 2, 3) *
               Transform<Table, Cell>::translation_xyz(1, 1, 1))
                      .origin()
                      .z == 4.0,
              "usable in constant expressions");

TEST_CASE_TEMPLATE("Transform: times its inverse is identity", T, float, double, Digits50) {
  auto rng = seeded(42);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
    for (int i = 0; i < 100; ++i) {
      const auto X_WC = random_transform<World, Cell>(rng, reach);
      CAPTURE(as_code(X_WC));
      const Transform<World, World, T> X_WW = X_WC * X_WC.inverse();
      const Transform<Cell, Cell, T> X_CC = X_WC.inverse() * X_WC;
      CHECK(largest(X_WW.axes(), Rotation<T>{}) <= tolerance<T>);
      CHECK(largest(X_CC.axes(), Rotation<T>{}) <= tolerance<T>);
      CHECK(largest(X_WW.origin()) <= tolerance<T> * reach);
      CHECK(largest(X_CC.origin()) <= tolerance<T> * reach);
      CHECK(X_WC.inverse().inverse().axes() == X_WC.axes());
    }
  }
}

TEST_CASE_TEMPLATE("Transform: composition is associative", T, float, double, Digits50) {
  auto rng = seeded(43);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
    for (int i = 0; i < 100; ++i) {
      const auto X_WB = random_transform<World, Base>(rng, reach);
      const auto X_BT = random_transform<Base, Table>(rng, reach);
      const auto X_TC = random_transform<Table, Cell>(rng, reach);
      CAPTURE(as_code(X_WB));
      CAPTURE(as_code(X_BT));
      CAPTURE(as_code(X_TC));
      const Transform<World, Cell, T> left = (X_WB * X_BT) * X_TC;
      const Transform<World, Cell, T> right = X_WB * (X_BT * X_TC);
      CHECK(largest(left.axes(), right.axes()) <= tolerance<T>);
      CHECK(largest(left.origin() - right.origin()) <= tolerance<T> * reach);
    }
  }
}

TEST_CASE_TEMPLATE("Transform: a product of 6 rounds no more than a dozen times the last place", T, float,
                   double) {
  auto rng = seeded(45);
  for (int i = 0; i < 200; ++i) {
    Transform<World, World, T> X;
    Transform<World, World, Digits50> exact;
    for (int k = 0; k < 6; ++k) {
      const auto step = random_transform<World, World>(rng, T(1));
      X = X * step;
      exact = exact * step.template cast<Digits50>();
    }
    const auto wide = X.template cast<Digits50>();
    CHECK(largest(wide.axes(), exact.axes()) <= Digits50(T(12) * epsilon<T>()));
    CHECK(largest(wide.origin() - exact.origin()) <= Digits50(T(36) * epsilon<T>()));
  }
}

TEST_CASE_TEMPLATE("Transform: is Eigen's isometry, there and back", T, float, double, Digits50) {
  using Isometry = Eigen::Transform<T, 3, Eigen::Isometry>;
  auto rng = seeded(46);
  for (int i = 0; i < 100; ++i) {
    const auto X_WB = random_transform<World, Base>(rng, T(1));
    const auto X_BC = random_transform<Base, Cell>(rng, T(1));
    const Isometry E_WB = as_eigen(X_WB), E_BC = as_eigen(X_BC);
    CHECK(Transform<World, Base, T>(E_WB) == X_WB);
    CHECK(Transform<World, Base, T>(X_WB.rotation(), X_WB.translation()) == X_WB);
    const Isometry E_WC = E_WB * E_BC;
    const auto X_WC = X_WB * X_BC;
    CHECK((X_WC.rotation() - E_WC.linear()).norm() <= tolerance<T>);
    CHECK((X_WC.translation() - E_WC.translation()).norm() <= tolerance<T>);
    const Isometry inverse = E_WC.inverse();
    CHECK((X_WC.inverse().translation() - inverse.translation()).norm() <= tolerance<T>);
    CHECK((X_WC.inverse().rotation() - inverse.linear()).norm() <= tolerance<T>);
  }
}

TEST_CASE_TEMPLATE("Transform: takes Eigen expressions without naming them", T, float, double) {
  const Mat3<T> R = Eigen::AngleAxis<T>(T(0.3), Vec3<T>::UnitY()).toRotationMatrix();
  const Transform<World, Cell, T> X(R.transpose(), T(2) * Vec3<T>::UnitX());
  CHECK((X.rotation() - R.transpose()).norm() == T(0));
  CHECK(X.origin() == Xyz<T>{T(2), T(0), T(0)});
}

TEST_CASE_TEMPLATE("Transform: turns about x, y and z by the right hand", T, float, double, Digits50) {
  const T o(0), l(1), quarter = pi<T>() / T(2);
  using X = Transform<World, Cell, T>;
  const auto check = [](const Xyz<T>& got, const Xyz<T>& wanted) {
    CHECK(largest(got - wanted) <= epsilon<T>());
  };
  check(X::rotation_x(quarter).axis_y(), {o, o, l});
  check(X::rotation_x(quarter).axis_z(), {o, -l, o});
  check(X::rotation_y(quarter).axis_z(), {l, o, o});
  check(X::rotation_y(quarter).axis_x(), {o, o, -l});
  check(X::rotation_z(quarter).axis_x(), {o, l, o});
  check(X::rotation_z(quarter).axis_y(), {-l, o, o});
  for (const T& angle : {T(0), T(1e-8), T(1), T(3), T(-2)}) {
    const auto same = [&](const X& got, const Xyz<T>& axis) {
      CHECK(largest(got.axes(), rotation_about(axis, angle)) <= T(4) * epsilon<T>());
      CHECK(got.origin() == Xyz<T>{o, o, o});
    };
    same(X::rotation_x(angle), {l, o, o});
    same(X::rotation_y(angle), {o, l, o});
    same(X::rotation_z(angle), {o, o, l});
  }
}

TEST_CASE("Transform: default is identity, in both scalars") {
  const Transform<World, Cell> X;
  CHECK(X.rotation() == Mat3<double>::Identity());
  CHECK(X.translation() == Vec3<double>::Zero());
  CHECK(X.cast<float>() == Transform<World, Cell, float>());
  CHECK(X.renamed<Table, Tool>() == Transform<Table, Tool>());
}

TEST_CASE_TEMPLATE("Transform: a thousand products drift apart, normalised brings them back", T, float,
                   double) {
  auto rng = seeded(47);
  Transform<World, World, T> X;
  for (int i = 0; i < 1000; ++i) X = X * random_transform<World, World>(rng, T(0.1));
  CHECK(rotation_error(X.axes()) > T(8) * epsilon<T>());
  CHECK(rotation_error(X.normalised().axes()) <= T(8) * epsilon<T>());
  CHECK(X.normalised().origin() == X.origin());
}

TEST_CASE("Transform: a file's six digits become a rotation, what is none is refused with its error") {
  auto rng = seeded(48);
  for (int i = 0; i < 100; ++i) {
    const auto R = random_rotation<double>(rng);
    const auto digits = [](double x) { return std::round(x * 1e6) / 1e6; };
    const auto rounded = [&](const Xyz<double>& v) {
      return Xyz<double>{digits(v.x), digits(v.y), digits(v.z)};
    };
    const auto X =
        Transform<World, Cell>::nearest({rounded(R.x), rounded(R.y), rounded(R.z)}, {0.0, 0.0, 1.0});
    CHECK(rotation_error(X.axes()) <= 8 * epsilon<double>());
    CHECK(largest(X.axes(), R) <= 1e-6);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](const Rotation<double>& R) {
    return Transform<World, Cell>::nearest(R, {0.0, 0.0, 0.0});
  };
  CHECK_THROWS_WITH_AS(make({{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
                       "skinctl: Transform: |R'R - 1| = 3, allowed: <= 0.1", ConfigurationError);
  CHECK_THROWS_AS(make({{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}), ConfigurationError);
  CHECK_THROWS_AS(make({{nan, 0, 0}, {0, 1, 0}, {0, 0, 1}}), ConfigurationError);
  for (const double no : {nan, std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(static_cast<void>(Transform<World, Cell>::nearest({}, {0.0, no, 0.0})),
                    ConfigurationError);
}

namespace {
/// As many poses as a register has lanes, in one pose of lanes.
template <class A, class B, class T>
Transform<A, B, Lane<T>> in_lanes(const std::vector<Transform<A, B, T>>& poses) {
  const auto row = [&poses](auto&& number_of) {
    std::vector<T> numbers;
    for (const auto& X : poses) numbers.push_back(number_of(X));
    return Lane<T>::load(numbers.data());
  };
  const auto triple = [&row](auto&& vector_of) {
    return Xyz<Lane<T>>{row([&](const auto& X) { return vector_of(X).x; }),
                        row([&](const auto& X) { return vector_of(X).y; }),
                        row([&](const auto& X) { return vector_of(X).z; })};
  };
  return {{triple([](const auto& X) { return X.axis_x(); }), triple([](const auto& X) { return X.axis_y(); }),
           triple([](const auto& X) { return X.axis_z(); })},
          triple([](const auto& X) { return X.origin(); })};
}
}  // namespace

TEST_CASE_TEMPLATE("Transform: lanes hold as many poses at once", T, float, double) {
  using std::abs;
  auto rng = seeded(49);
  std::vector<Transform<World, Base, T>> X_WB;
  std::vector<Transform<Base, Cell, T>> X_BC;
  for (std::size_t i = 0; i < native_lanes<T>; ++i) {
    X_WB.push_back(random_transform<World, Base>(rng, T(1)));
    X_BC.push_back(random_transform<Base, Cell>(rng, T(1)));
  }
  const auto X = in_lanes(X_WB) * in_lanes(X_BC);
  const auto X_inverse = X.inverse();
  for (std::size_t i = 0; i < native_lanes<T>; ++i) {
    const auto X_WC = X_WB[i] * X_BC[i];
    CHECK(abs(X.axis_x().y[i] - X_WC.axis_x().y) <= T(4) * epsilon<T>());
    CHECK(abs(X.axis_z().x[i] - X_WC.axis_z().x) <= T(4) * epsilon<T>());
    CHECK(abs(X.origin().z[i] - X_WC.origin().z) <= T(8) * epsilon<T>());
    CHECK(abs(X_inverse.origin().x[i] - X_WC.inverse().origin().x) <= T(8) * epsilon<T>());
  }
}

TEST_CASE("Transform: nothing of it allocates") {
  auto rng = seeded(50);
  const auto X_WB = random_transform<World, Base>(rng, 1.0);
  const auto X_BC = random_transform<Base, Cell>(rng, 1.0);
  const AllocationGuard guard;
  const auto X_WC = X_WB * X_BC;
  const auto E = as_eigen(X_WC);
  const auto back = Transform<World, Cell>(E).inverse().normalised();
  const auto phi = log_so3(exp_so3(log_so3(back.axes())));
  const auto count = guard.count();
  CHECK(count == 0);
  CHECK(std::isfinite(phi.x));
}

TEST_CASE_TEMPLATE("Transform: moved and turned on is the product with the step", T, float, double,
                   Digits50) {
  auto rng = seeded(51);
  for (int i = 0; i < 50; ++i) {
    const auto X = random_transform<World, Cell>(rng, T(1));
    const T a = T(3) * uniform<T>(rng);
    const Xyz<T> p = random_xyz(rng, T(1));
    using Step = Transform<Cell, Tool, T>;
    const auto same = [&](const Transform<World, Cell, T>& got, const Step& step) {
      const auto wanted = X * step;
      CHECK(largest(got.axes(), wanted.axes()) <= tolerance<T>);
      CHECK(largest(got.origin() - wanted.origin()) <= tolerance<T>);
    };
    same(X.translated(p.x, p.y, p.z), Step::translation_xyz(p.x, p.y, p.z));
    same(X.rotated_x(a), Step::rotation_x(a));
    same(X.rotated_y(a), Step::rotation_y(a));
    same(X.rotated_z(a), Step::rotation_z(a));
  }
}
