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
/// The matrix with these eigenvalues, of the axes of `R`.
template <class T>
Symmetric<T> with_eigenvalues(const Xyz<T>& d, const Rotation<T>& R) {
  Symmetric<T> S;
  const auto add = [&](const T& s, const Xyz<T>& v) {
    S.xx += s * v.x * v.x, S.yy += s * v.y * v.y, S.zz += s * v.z * v.z;
    S.xy += s * v.x * v.y, S.xz += s * v.x * v.z, S.yz += s * v.y * v.z;
  };
  add(d.z, R.x), add(d.x, R.y), add(d.y, R.z);
  return S;
}
}  // namespace

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
      const Xyz<T> found = eigenvalues(with_eigenvalues(expected, R));
      CAPTURE(as_code(R));
      CAPTURE(as_code(expected));
      CHECK(largest(found - expected) <= tolerance<T> * largest(expected));
    }
  }
}
