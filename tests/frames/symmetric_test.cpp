#include "skinctl/frames/symmetric.hpp"

#include <doctest/doctest.h>

#include <array>
#include <type_traits>

#include "tests/support/digits50.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<Symmetric<double>> &&
              sizeof(Symmetric<double>) == 6 * sizeof(double));

namespace {
template <class T>
Symmetric<T> random_symmetric(Random& rng) {
  const auto d = random_xyz(rng, T(1)), o = random_xyz(rng, T(1));
  return {d.x, d.y, d.z, o.x, o.y, o.z};
}
template <class T>
T largest_of(const Symmetric<T>& S) {
  const T d = largest(Xyz<T>{S.xx, S.yy, S.zz}), o = largest(Xyz<T>{S.xy, S.xz, S.yz});
  return d > o ? d : o;
}
}  // namespace

TEST_CASE_TEMPLATE("Symmetric: is the Eigen matrix it converts to", T, float, double, Digits50) {
  auto rng = seeded(1);
  for (int i = 0; i < 100; ++i) {
    const auto S = random_symmetric<T>(rng), Q = random_symmetric<T>(rng);
    const auto v = random_xyz(rng, T(1));
    const auto R = random_rotation<T>(rng);
    const Mat3<T> M = as_eigen(S);
    CHECK((M - M.transpose()).norm() == T(0));
    CHECK((as_eigen(S * v) - M * as_eigen(v)).norm() <= tolerance<T>);
    CHECK((as_eigen(T(2) * S + Q - S) - M - as_eigen(Q)).norm() <= tolerance<T>);
    Mat3<T> E;
    E.col(0) = as_eigen(R.x);
    E.col(1) = as_eigen(R.y);
    E.col(2) = as_eigen(R.z);
    CHECK((as_eigen(rotated(R, S)) - E * M * E.transpose()).norm() <= tolerance<T>);
    CHECK(largest_of(as_symmetric(M) - S) == T(0));
    CHECK(S.trace() == M(0, 0) + M(1, 1) + M(2, 2));
    // w . U w = |v x w|^2
    const auto w = random_xyz(rng, T(1));
    const T square = dot(cross(v, w), cross(v, w));
    const T error = dot(w, unit_mass_at(v) * w) - square;
    CHECK(error * error <= tolerance<T> * tolerance<T>);
  }
}

TEST_CASE_TEMPLATE(
    "Symmetric: eigenvalues are those it was made of, in order, however close and however far apart", T,
    float, double, Digits50) {
  auto rng = seeded(2);
  const std::array<Xyz<T>, 8> made_of{{{T(1), T(2), T(3)},
                                       {T(-3), T(0), T(3)},
                                       {T(1), T(1), T(1)},
                                       {T(0), T(0), T(0)},
                                       {T(1), T(1), T(1) + T(4) * epsilon<T>()},
                                       {T(0), T(1e-12), T(1)},
                                       {T(1e-20), T(1e-10), T(1e10)},
                                       {T(-1e-6), T(-1e-8), T(0)}}};
  for (const auto& expected : made_of) {
    for (int i = 0; i < 50; ++i) {
      const auto R = random_rotation<T>(rng);
      const Xyz<T> found =
          eigenvalues(rotated(R, Symmetric<T>{expected.z, expected.x, expected.y, T(0), T(0), T(0)}));
      CAPTURE(as_code(R));
      CAPTURE(as_code(expected));
      CHECK(largest(found - expected) <= tolerance<T> * largest(expected));
    }
  }
}
