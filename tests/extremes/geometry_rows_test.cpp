// Vectors, frames, sums and bounds at the ends of what a number holds: a row each, see rows.hpp.
//
// Promise: vectors, frames, enclosures, an arm's kinematics and dynamics, references, surfaces, sensors
// and contacts: finite up to a stated power of the largest number, and what a NaN or an infinity makes of
// the result
// Tried: 125 rows at 0, denormal numbers, 21 steps of the exponents, the largest number, both signs, NaN
// and infinities; float and double. Also: `extremes/dynamics_rows_test.cpp`,
// `extremes/motion_rows_test.cpp`

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "bench/studies/proofs/bound.hpp"
#include "bench/studies/proofs/traced.hpp"
#include "bench/studies/proofs/traced_output.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/extremes/rows.hpp"

using namespace skinctl;
using namespace skinctl::extremes;

namespace {

struct A : FrameTag {};
struct B : FrameTag {};
struct C : FrameTag {};

template <class T>
Xyz<T> along(T s) {
  return {T(0.3) * s, T(-0.7) * s, T(0.5) * s};
}
template <class T>
Rotation<T> turned() {
  return exp_so3(Xyz<T>{T(0.3), T(-1.2), T(0.5)});
}
template <class T>
Transform<A, B, T> pose(T far = T(1)) {
  return {turned<T>(), along(far)};
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: vectors, frames and inertias", T, SKINCTL_EXTREME_SCALARS) {
  using enum Wrong;
  using P = JointPosition<3, T>;
  using V = JointVelocity<3, T>;
  using Q = JointAcceleration<3, T>;
  using Six = Eigen::Matrix<T, 6, 1>;
  static const Row<T> rows[] = {
      {"by_component", 0, shows, shows, [](T x) { return Results<T>(by_component(Xyz<T>{x, T(1), x})); }},
      {"assign", 0, shows, shows,
       [](T x) {
         Xyz<T> to;
         assign(to, Xyz<T>{x, T(1), x});
         return Results<T>(to);
       }},
      {"turn_z", 0, shows, shows,
       [](T x) { return Results<T>(turn_z(Turn{T(0.6), T(0.8)}, Xyz<T>{x, T(0), x})); }},
      {"turn_x", 0, shows, shows,
       [](T x) { return Results<T>(turn_x(Turn{T(0.6), T(0.8)}, Xyz<T>{x, T(0), x})); }},
      {"turn_back_z", 0, shows, shows,
       [](T x) { return Results<T>(turn_back_z(Turn{T(0.6), T(0.8)}, Xyz<T>{x, T(0), x})); }},
      {"turn_back_x", 0, shows, shows,
       [](T x) { return Results<T>(turn_back_x(Turn{T(0.6), T(0.8)}, Xyz<T>{x, T(0), x})); }},
      {"turn_back", 1, shows, shows, [](T x) { return Results<T>(turn_back(turned<T>(), along(x))); }},
      {"as_eigen, as_xyz", 0, shows, shows,
       [](T x) { return Results<T>(as_xyz(as_eigen(Xyz<T>{x, T(1), x}))); }},
      {"select", 0, shows, shows, [](T x) { return Results<T>(select(true, x, T(1))); }},
      {"select of the other", 0, safe, safe, [](T x) { return Results<T>(select(false, x, T(1))); }},
      {"Lane, LaneMask", 0, safe, shows,  // NaN is chosen away
       [](T x) {
         using L2 = Lane<T, 2>;
         T two[2] = {x, T(1)}, out[2];
         const L2 lanes = L2::load(two);
         select(lanes == lanes, lanes, L2(T(3))).store(out);
         CHECK(all(lanes == lanes) == (x == x));
         return Results<T>(out);
       }},
      {"JointVector::constant, generate", 0, shows, shows, [](T x) { return Results<T>(V::constant(x)); }},
      {"JointSubset::of, put", 0, shows, shows,
       [](T x) {
         V whole = V::constant(x);
         JointSubset<3, 0b101>::put(JointSubset<3, 0b101>::of(whole), whole);
         return Results<T>(whole);
       }},
      {"integrate a speed", 1, shows, shows,
       [](T x) { return Results<T>(integrate(P::constant(T(1)), V::constant(x), T(0.008))); }},
      {"integrate an acceleration", 1, shows, shows,
       [](T x) { return Results<T>(integrate(V::constant(T(1)), Q::constant(x), T(0.008))); }},
      {"power", 2, shows, shows,
       [](T x) { return Results<T>(power(JointTorque<3, T>::constant(x), V::constant(x))); }},
      {"AnyState::believes", 0, safe, safe,
       [](T x) {
         State<3, T> s;
         s.q[1] = x;
         return Results<T>(AnyState{}.believes(s) ? 1 : 0);
       }},
      {"transformed: a pose", 1, shows, shows,
       [](T x) {
         return Results<T>(transformed(pose<T>(), Transform<B, C, T>(turned<T>(), along(x))).origin());
       }},
      {"Twist: its numbers", 1, shows, shows,
       [](T x) {
         return Results<T>(transformed(pose<T>(), Twist<B, A, B, B, T>::from_eigen(Six::Constant(x).eval())));
       }},
      {"Twist: the place", 1, shows, shows,
       [](T x) {
         return Results<T>(transformed(pose<T>(x), Twist<B, A, B, B, T>{along(T(1)), along(T(2))}));
       }},
      {"Wrench: its numbers", 1, shows, shows,
       [](T x) {
         return Results<T>(transformed(pose<T>(), Wrench<B, B, B, T>::from_eigen(Six::Constant(x).eval())));
       }},
      {"Wrench: the place", 1, shows, shows,
       [](T x) { return Results<T>(transformed(pose<T>(x), Wrench<B, B, B, T>{along(T(1)), along(T(2))})); }},
      {"Acceleration", 0, shows, shows,
       [](T x) { return Results<T>(Acceleration<B, A, B, B, T>::from_eigen(Six::Constant(x).eval())); }},
      {"Transform: a translation", 1, shows, shows,
       [](T x) { return Results<T>(pose<T>().translated(x, x, x).origin()); }},
      {"Transform: a turn, and turned", 0, shows, shows,
       [](T x) {
         const auto X = Transform<A, B, T>::rotation_x(x).rotated_y(x).rotated_z(x);
         if (std::isfinite(x)) CHECK(rotation_error(X.axes()) <= 16 * std::numeric_limits<T>::epsilon());
         return Results<T>(X.axes());
       }},
      {"gravity_in_base", 1, shows, shows, [](T x) { return Results<T>(gravity_in_base(turned<T>(), x)); }},
      {"add_compensated", 1, shows, shows,
       [](T x) {
         T value(1), rest(0);
         math::add_compensated(value, rest, x);
         return Results<T>(value, rest);
       }},
  };
  check_rows(rows);
}

TEST_CASE("extremes: numbers of a gripper, of a link and of a table of joints") {
  using enum Wrong;
  static constexpr GripperRange range{0.08, 5, 50, 0.01, 0.1};
  static const Row<double> rows[] = {
      {"open_goal", 0, shows, shows,
       [](double x) {
         const auto g = open_goal({x, 0, x, 0, x});
         return Results<double>(g.opening, g.force, g.speed);
       }},
      {"close_goal", 0, shows, shows, [](double x) { return Results<double>(close_goal(range, x).force); }},
      {"combined", 4, shows, shows,
       [](double x) {
         const LinkInertia a{std::abs(x), {x, 0, 0}, 1, 1, 1}, b{2, {0, x, 0}, 1, 1, 1};
         const auto sum = combined(a, b);
         return Results<double>(sum.mass, std::array{sum.c[0], sum.c[1], sum.c[2]}, sum.xx, sum.zz);
       }},
      {"turned_back_z", 1, shows, shows,
       [](double x) {
         const auto in = turned_back_z({1, {x, x, 0}, x, 1, 1, x}, Angle::radians(0.3));
         return Results<double>(in.c[0], in.xx, in.xy);
       }},
      {"Angle::radians", 0, shows, shows,
       [](double x) { return Results<double>(Angle::radians(x).cos, Angle::radians(x).sin); }},
      {"inertia_of", 1, shows, shows,
       [](double x) { return Results<double>(inertia_of(make_link({}, {1, {x, 0, 0}, x, x, x})).xx); }},
      {"density_defect", 0, shows, shows,
       [](double x) {
         const double found = density_defect(make_link({}, {1, {0, 0, 0}, x, x, x}));
         return Results<double>(
             std::isfinite(x) && x < 0 && std::isinf(found) ? 0 : found);  // infinite for no body at all
       }},
      {"seen_from", 1, shows, shows,
       [](double x) {
         const auto in = seen_from(turned<double>(), along(x), {1, {x, 0, 0}, x, x, x});
         return Results<double>(in.c[0], in.xx, in.yz);
       }},
      {"placed_at", 1, shows, shows,
       [](double x) {
         return Results<double>(
             placed_at(make_link({}, {1}), JointKind::revolute, turned<double>(), along(x)).numbers);
       }},
      {"row_end", 0, shows, shows, [](double x) { return Results<double>(row_end({0, x, x, {}}).p[0]); }},
      {"moved_out, links_from_standard_dh", 1, shows, shows,
       [](double x) {
         const auto in = moved_out({.p = {x, 0, 0}}, {1, {x, 0, 0}, 1, 1, 1});
         return Results<double>(in.c[0],
                                links_from_standard_dh<1>({DhRow{x, x, 0, {}}}, {LinkInertia{}})[0].numbers);
       }},
  };
  check_rows(rows);

  // A goal's numbers are brought into the range; a NaN stays one, and is what drivers refuse.
  for (const double x : {-1e308, -1.0, 0.0, 1e-320, 1.0, 1e308, HUGE_VAL}) {
    const auto g = limited({x, x, x}, range);
    CHECK((g.opening >= 0 && g.opening <= 0.08 && g.force >= 5 && g.force <= 50 && g.speed <= 0.1));
    CHECK(finite(g));
    CHECK(finite(GripperGoal{x, 0, 0}) == std::isfinite(x));
  }
  CHECK_FALSE(finite(limited({std::nan(""), 10, 0.05}, range)));

  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    CHECK(refused([&] { require(wrong - wrong == 0, "x", wrong, "finite"); }));
    std::array<PlacedLink, 1> placed{};
    placed[0].R.x.x = wrong;
    CHECK(refused([&] { static_cast<void>(canonical_links<Chain<1>>(placed)); }));
    CHECK(refused([&] { check_link(make_link({.p = {wrong, 0, 0}}, {1})); }));
    CHECK(refused([&] { check_link(make_link({}, {wrong, {0, 0, 0}, 1, 1, 1})); }));
    using X = Transform<A, B, double>;
    CHECK(refused([&] { static_cast<void>(X::nearest({{wrong, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0})); }));
    CHECK(refused([&] { static_cast<void>(X::nearest({}, {wrong, 0, 0})); }));
  }
  static_assert(std::string_view(FrameName("gripper").view()) == "gripper");
}

TEST_CASE("extremes: enclosures hold every result, and say so where nothing is known") {
  using math::Bound;
  using math::Enclosure;
  using math::Traced;
  const double inf = HUGE_VAL;
  for (const double size : sizes<double>())
    for (const double x : {size, -size}) {
      CAPTURE(x);
      const Enclosure e(x);
      CHECK(e.contains(x));
      CHECK(square(e).contains(x * x));
      CHECK(exp(e).contains(std::exp(x)));
      CHECK(tanh(e).contains(std::tanh(x)));
      CHECK(abs(e).contains(std::abs(x)));
      CHECK(sin(e).contains(std::sin(x)));
      CHECK(cos(e).contains(std::cos(x)));
      if (x >= 0) CHECK(sqrt(e).contains(std::sqrt(x)));
      CHECK(sin(Enclosure(-std::abs(x), std::abs(x))).contains(std::sin(x / 3)));
      // A bound is a number, or infinite: never less than what is there.
      const Bound<float> b(x), y = b * b + Bound<float>(1.0f);
      CHECK(y.error() >= 0);
    }
  CHECK(Enclosure(-inf, inf).contains(1e308));
  CHECK_FALSE(Enclosure(std::nan("")).contains(0));
  math::Tape tape, other;
  {
    const math::Tape::Recording recording(tape);
    const auto x = Traced<float>::input({-1e30, 1e30});
    const auto y = x * x;
    math::TracedOutput output(tape, y.node());
    const math::TracedOutput::L low[] = {math::TracedOutput::L(-1e30)},
                                high[] = {math::TracedOutput::L(1e30)};
    static_cast<void>(output(low, high));
    CHECK(output.highest()[0] >= 1e60);
  }
  CHECK_FALSE(math::same_program(tape, other));
}
