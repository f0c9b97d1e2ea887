#include "skinctl/frames/inertia.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <type_traits>
#include <vector>

#include "skinctl/testing/digits50.hpp"
#include "skinctl/testing/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = Link<2>;
template <class T>
using ArmInertia = Inertia<Arm, Arm, T>;

template <class M, class N>
concept has_sum = requires(M m, N n) { m + n; };
template <class X, class M>
concept multiplies = requires(X x, M m) { x* m; };
template <class M, class V>
concept has_energy = requires(M m, V v) { kinetic_energy(m, v); };

/// A body by definition: a cloud of point masses.
template <class T>
struct Mass {
  T kilogram;
  Xyz<T> at;
};
template <class T>
using Cloud = std::vector<Mass<T>>;

template <class T>
Cloud<T> random_cloud(Random& rng, const T& reach) {
  Cloud<T> cloud;
  for (int i = 0; i < 12; ++i) cloud.push_back({T(1.5) + uniform<T>(rng), random_xyz(rng, reach)});
  return cloud;
}
template <class T>
ArmInertia<T> inertia_of(const Cloud<T>& cloud) {
  ArmInertia<T> sum;
  for (const auto& part : cloud) sum = sum + ArmInertia<T>::point(part.kilogram, part.at);
  return sum;
}
template <class T>
Twist<Arm, World, Arm, Arm, T> random_twist(Random& rng) {
  return {random_xyz(rng, T(1)), random_xyz(rng, T(1))};
}
template <class M>
auto difference(const M& a, const M& b) {
  using T = typename M::scalar;
  using std::abs;
  T worst(0);
  const auto p = a.parameters(), q = b.parameters();
  for (std::size_t i = 0; i < 10; ++i)
    if (!(abs(T(p[i] - q[i])) <= worst)) worst = abs(T(p[i] - q[i]));
  return worst;
}
}  // namespace

static_assert(std::is_trivially_copyable_v<Inertia<Arm>> && sizeof(Inertia<Arm>) == 10 * sizeof(double));
static_assert(has_sum<Inertia<Arm>, Inertia<Arm>> && !has_sum<Inertia<Arm>, Inertia<Tool, Arm>>,
              "of two bodies");
static_assert(!has_sum<Inertia<Arm>, Inertia<Arm, Tool>>, "as seen from two frames");
static_assert(multiplies<Transform<Arm, Tool>, Inertia<Tool>> &&
              !multiplies<Transform<Tool, Arm>, Inertia<Tool>>);
static_assert(multiplies<Inertia<Arm>, Twist<Arm, World, Arm, Arm>> &&
              !multiplies<Inertia<Arm>, Twist<Arm, World>>);
static_assert(!multiplies<Inertia<Arm>, Twist<Tool, World, Arm, Arm>>);
static_assert(has_energy<Inertia<Arm>, Twist<Arm, World, Arm, Arm>> &&
              !has_energy<Inertia<Arm>, Twist<Arm, World>>);

TEST_CASE_TEMPLATE("Inertia: energy and momentum are those of its particles", T, float, double, Digits50) {
  using std::abs;
  auto rng = seeded(1);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e3)}) {
    for (int i = 0; i < 20; ++i) {
      const auto cloud = random_cloud(rng, reach);
      const auto M = inertia_of(cloud);
      const auto V = random_twist<T>(rng);
      T energy(0);
      Xyz<T> linear{}, angular{};
      for (const auto& part : cloud) {
        const Xyz<T> v = V.linear + cross(V.angular, part.at);
        energy = energy + part.kilogram * dot(v, v) / T(2);
        linear = linear + part.kilogram * v;
        angular = angular + part.kilogram * cross(part.at, v);
      }
      const T size = (T(1) + reach) * (T(1) + reach) * T(12);
      const auto h = M * V;
      CAPTURE(reach);
      CHECK(abs(kinetic_energy(M, V) - energy) <= tolerance<T> * size);
      CHECK(largest(h.linear - linear) <= tolerance<T> * size);
      CHECK(largest(h.angular - angular) <= tolerance<T> * size);
      CHECK(abs(dot(V, h) / T(2) - energy) <= tolerance<T> * size);
    }
  }
}

TEST_CASE_TEMPLATE("Inertia: is the same matter from every frame", T, float, double, Digits50) {
  using std::abs;
  auto rng = seeded(2);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e2)}) {
    for (int i = 0; i < 20; ++i) {
      const auto cloud = random_cloud(rng, T(1));
      const auto X_TA = random_transform<Tool, Arm>(rng, reach);
      const auto M = inertia_of(cloud);
      const Inertia<Arm, Tool, T> seen = X_TA * M;
      CAPTURE(as_code(X_TA));
      Inertia<Arm, Tool, T> moved;
      for (const auto& part : cloud)
        moved = moved + Inertia<Arm, Tool, T>::point(part.kilogram, (X_TA * Point<Arm, T>{part.at}).xyz);
      const T size = (T(1) + reach) * (T(1) + reach) * T(12);
      CHECK(difference(seen, moved) <= tolerance<T> * size);
      const auto V = random_twist<T>(rng);
      CHECK(abs(kinetic_energy(seen, X_TA * V) - kinetic_energy(M, V)) <= tolerance<T> * size);
      const auto h = X_TA * (M * V), k = seen * (X_TA * V);
      CHECK(largest(h.linear - k.linear) <= tolerance<T> * size);
      CHECK(largest(h.angular - k.angular) <= tolerance<T> * size);
      CHECK(difference(X_TA.inverse() * seen, M) <= tolerance<T> * size);
    }
  }
}

TEST_CASE_TEMPLATE("Inertia: ten parameters make it, and add up as its parts do", T, float, double,
                   Digits50) {
  auto rng = seeded(3);
  for (int i = 0; i < 50; ++i) {
    const auto M = inertia_of(random_cloud(rng, T(1))), N = inertia_of(random_cloud(rng, T(1)));
    const auto p = M.parameters(), q = N.parameters();
    CHECK(difference(ArmInertia<T>::from_parameters(p), M) <= T(24) * tolerance<T>);
    typename ArmInertia<T>::Parameters sum;
    for (std::size_t k = 0; k < 10; ++k) sum[k] = p[k] + q[k];
    CHECK(difference(ArmInertia<T>::from_parameters(sum), M + N) <= T(48) * tolerance<T>);
  }
  // The documented order: m, m c, then row by row of the upper triangle about the origin.
  const auto p = ArmInertia<T>::point(T(2), {T(1), T(10), T(100)}).parameters();
  const double expected[10] = {2, 2, 20, 200, 20200, -20, -200, 20002, -2000, 202};
  for (std::size_t k = 0; k < 10; ++k) CHECK(double(p[k]) == doctest::Approx(expected[k]).epsilon(1e-6));
}

TEST_CASE_TEMPLATE("Inertia: massless parts add nothing, and weigh nothing", T, float, double, Digits50) {
  auto rng = seeded(4);
  const auto M = inertia_of(random_cloud(rng, T(1)));
  const ArmInertia<T> none;
  CHECK(difference(M + none, M) <= T(8) * tolerance<T>);
  CHECK(difference(none + M, M) <= T(8) * tolerance<T>);
  CHECK(difference(none + none, none) == T(0));
  CHECK(kinetic_energy(none, random_twist<T>(rng)) == T(0));
  CHECK(difference(ArmInertia<T>::from_parameters({}), none) == T(0));
}

TEST_CASE_TEMPLATE("Inertia: a box is its eight octants", T, float, double, Digits50) {
  const T x = T(0.1), y = T(0.2), z = T(0.7), mass = T(3), half = T(0.5);
  ArmInertia<T> sum;
  for (const T& sx : {T(-1), T(1)})
    for (const T& sy : {T(-1), T(1)})
      for (const T& sz : {T(-1), T(1)})
        sum = sum + Transform<Arm, Tool, T>::translation_xyz(sx * x / T(4), sy * y / T(4), sz * z / T(4)) *
                        Inertia<Arm, Tool, T>::box(mass / T(8), x * half, y * half, z * half);
  CHECK(difference(sum, ArmInertia<T>::box(mass, x, y, z)) <= tolerance<T>);
}

namespace {
/// Nodes on (0, 1) of the three-point Gauss formula: it integrates what these bodies need exactly.
template <class T>
std::array<std::pair<T, T>, 3> gauss() {
  using std::sqrt;
  const T r = sqrt(T(3) / T(5)) / T(2);
  return {{{T(0.5) - r, T(5) / T(18)}, {T(0.5), T(8) / T(18)}, {T(0.5) + r, T(5) / T(18)}}};
}
}  // namespace

TEST_CASE_TEMPLATE("Inertia: ball and cylinder are the integrals over their volume", T, float, double,
                   Digits50) {
  const T mass = T(3), radius = T(0.4), length = T(1.1);
  ArmInertia<T> ball, cylinder;
  for (const auto& [s, weight] : gauss<T>()) {
    const T r = radius * s;
    const T shell = T(3) * s * s * weight * mass;  // density 3 s^2 ds of a ball
    for (const T& side : {T(-1), T(1)}) {
      ball = ball + ArmInertia<T>::point(shell / T(6), {side * r, T(0), T(0)});
      ball = ball + ArmInertia<T>::point(shell / T(6), {T(0), side * r, T(0)});
      ball = ball + ArmInertia<T>::point(shell / T(6), {T(0), T(0), side * r});
    }
    const T ring = T(2) * s * weight * mass;  // density 2 s ds of a disc
    for (const auto& [u, share] : gauss<T>()) {
      const T z = length * (u - T(0.5));
      for (const T& side : {T(-1), T(1)}) {
        cylinder = cylinder + ArmInertia<T>::point(ring * share / T(4), {side * r, T(0), z});
        cylinder = cylinder + ArmInertia<T>::point(ring * share / T(4), {T(0), side * r, z});
      }
    }
  }
  CHECK(difference(ball, ArmInertia<T>::sphere(mass, radius)) <= tolerance<T>);
  CHECK(difference(cylinder, ArmInertia<T>::cylinder_z(mass, radius, length)) <= tolerance<T>);
}

TEST_CASE_TEMPLATE("Inertia: a payload becomes part of the link that carries it", T, float, double) {
  const auto tool = Inertia<Tool, Tool, T>::sphere(T(1), T(0.1));
  const auto X_AT = Transform<Arm, Tool, T>::translation_xyz(T(0), T(0), T(0.2));
  const ArmInertia<T> both = ArmInertia<T>::sphere(T(1), T(0.1)) + (X_AT * tool).template part_of<Arm>();
  CHECK(both.mass() == T(2));
  CHECK(largest(both.centre() - Xyz<T>{T(0), T(0), T(0.1)}) <= epsilon<T>());
  CHECK(difference(both.template cast<Digits50>().template cast<T>(), both) <= T(4) * epsilon<T>());
}

TEST_CASE_TEMPLATE("Inertia: what no density can make is refused with its number", T, float, double,
                   Digits50) {
  const T nan = std::numeric_limits<T>::quiet_NaN(), inf = std::numeric_limits<T>::infinity();
  const auto made = [](T mass, Xyz<T> centre, Symmetric<T> moments) {
    return ArmInertia<T>(mass, centre, moments);
  };
  const Xyz<T> o{T(0), T(0), T(0)};
  const Symmetric<T> unit{T(1), T(1), T(1), T(0), T(0), T(0)};
  CHECK_THROWS_WITH_AS(made(T(-1), o, unit), "skinctl: Inertia: mass = -1, allowed: >= 0 kg",
                       ConfigurationError);
  CHECK_THROWS_WITH_AS(made(T(1), o, {T(1), T(1), T(3), T(0), T(0), T(0)}),
                       "skinctl: Inertia: I_1 + I_2 - I_3 = -1, allowed: >= 0 kg m^2 (I_1 <= I_2 <= I_3, the "
                       "principal moments)",
                       ConfigurationError);
  CHECK_THROWS_AS(made(T(1), o, {T(-1), T(-1), T(-1), T(0), T(0), T(0)}), ConfigurationError);
  CHECK_THROWS_AS(made(T(1), o, {T(1), T(1), T(1), T(0.6), T(0), T(0)}), ConfigurationError);
  CHECK_THROWS_AS(made(nan, o, unit), ConfigurationError);
  CHECK_THROWS_AS(made(inf, o, unit), ConfigurationError);
  CHECK_THROWS_AS(made(T(1), {nan, T(0), T(0)}, unit), ConfigurationError);
  CHECK_THROWS_AS(made(T(1), {T(0), inf, T(0)}, unit), ConfigurationError);
  for (int i = 0; i < 6; ++i) {
    Symmetric<T> moments = unit;
    T* const all[6] = {&moments.xx, &moments.yy, &moments.zz, &moments.xy, &moments.xz, &moments.yz};
    *all[i] = nan;
    CAPTURE(i);
    CHECK_THROWS_AS(made(T(1), o, moments), ConfigurationError);
    *all[i] = inf;
    CHECK_THROWS_AS(made(T(1), o, moments), ConfigurationError);
  }
  CHECK_THROWS_AS(static_cast<void>(ArmInertia<T>::from_parameters({T(0), T(1)})), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(ArmInertia<T>::from_parameters({T(1), T(1)})), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(ArmInertia<T>::sphere(T(-1), T(1))), ConfigurationError);
  CHECK_NOTHROW(made(T(0), o, {}));
  CHECK_NOTHROW(made(T(1), o, {T(1), T(1), T(2), T(0), T(0), T(0)}));  // a flat disc
  CHECK(ArmInertia<T>::unchecked(T(1), o, {T(0), T(0), T(1), T(0), T(0), T(0)}).about_centre().zz == T(1));
}

TEST_CASE_TEMPLATE("Inertia: flat and thin bodies pass from every side, in spite of rounding", T, float,
                   double, Digits50) {
  auto rng = seeded(5);
  for (int i = 0; i < 200; ++i) {
    const auto X = random_transform<Arm, Arm>(rng, T(1));
    const auto rebuilt = [](const ArmInertia<T>& M) {
      return ArmInertia<T>(M.mass(), M.centre(), M.about_centre());
    };
    CHECK_NOTHROW(rebuilt(X * ArmInertia<T>::box(T(1), T(1), T(2), T(0))));
    CHECK_NOTHROW(rebuilt(X * ArmInertia<T>::box(T(1), T(0), T(2), T(0))));
    CHECK_NOTHROW(static_cast<void>(
        ArmInertia<T>::from_parameters((X * ArmInertia<T>::box(T(1), T(0.01), T(0), T(0))).parameters())));
  }
}

TEST_CASE_TEMPLATE("Inertia: as a 6x6 matrix takes twists to momenta, and comes back", T, float, double) {
  auto rng = seeded(9);
  for (int i = 0; i < 50; ++i) {
    const auto M = random_transform<Arm, Arm>(rng, T(1)) * ArmInertia<T>::box(T(2), T(0.3), T(0.2), T(0.5));
    const Mat6<T> E = as_eigen(M);
    CHECK(E == E.transpose());
    const Twist<Arm, World, Arm, Arm, T> V{random_xyz(rng, T(1)), random_xyz(rng, T(1))};
    CHECK((E * as_eigen(V) - as_eigen(M * V)).norm() <= tolerance<T>);
    const auto back = ArmInertia<T>::from_eigen(E);
    CHECK((as_eigen(back) - E).norm() <= tolerance<T>);
    const ArmInertia<T> same(M.mass(), as_eigen(M.centre()), as_eigen(M.about_centre()));
    CHECK(as_eigen(same) == E);
  }
  Mat6<T> hollow = Mat6<T>::Identity();
  hollow(5, 5) = T(9);  // more than the other two moments together
  CHECK_THROWS_AS(static_cast<void>(ArmInertia<T>::from_eigen(hollow)), ConfigurationError);
}
