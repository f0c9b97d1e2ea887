// Seeded rotations, poses and vectors, made independently of skinctl's own formulas.
#pragma once

#include <cmath>
#include <string>

#include "skinctl/frames/transform.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

template <class T>
Xyz<T> random_xyz(Random& rng, const T& reach) {
  const T x = uniform<T>(rng), y = uniform<T>(rng), z = uniform<T>(rng);
  return {reach * x, reach * y, reach * z};
}
template <class T>
Xyz<T> random_direction(Random& rng) {
  for (;;) {
    const Xyz<T> v = random_xyz(rng, T(1));
    const T length = norm(v);
    if (length > T(0.1) && length < T(1)) return (T(1) / length) * v;
  }
}
/// The turn by `angle` about the unit vector `n`, computed through its quaternion.
template <class T>
Rotation<T> rotation_about(const Xyz<T>& n, const T& angle) {
  using std::cos;
  using std::sin;
  const T half = angle / T(2);
  const T w = cos(half), x = sin(half) * n.x, y = sin(half) * n.y, z = sin(half) * n.z, two(2);
  return {{T(1) - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)},
          {two * (x * y - w * z), T(1) - two * (x * x + z * z), two * (y * z + w * x)},
          {two * (x * z + w * y), two * (y * z - w * x), T(1) - two * (x * x + y * y)}};
}
template <class T>
Rotation<T> random_rotation(Random& rng) {
  const Xyz<T> n = random_direction<T>(rng);
  return rotation_about(n, T(pi<T>() * uniform<T>(rng)));
}
/// A pose whose origin is up to `reach` metres away along each axis.
template <class A, class B, class T>
Transform<A, B, T> random_transform(Random& rng, const T& reach) {
  const Rotation<T> R = random_rotation<T>(rng);
  return Transform<A, B, T>::trusted(R, random_xyz(rng, reach));
}

template <class T>
T largest(const Xyz<T>& v) {
  using std::abs;
  T worst(0);
  for (const T& c : {v.x, v.y, v.z})
    if (!(abs(c) <= worst)) worst = abs(c);
  return worst;
}
template <class T>
T largest(const Rotation<T>& R, const Rotation<T>& S) {
  T worst(0);
  for (const T& c : {largest(R.x - S.x), largest(R.y - S.y), largest(R.z - S.z)})
    if (!(c <= worst)) worst = c;
  return worst;
}
template <class U, class T>
Rotation<U> cast(const Rotation<T>& R) {
  return {skinctl::cast<U>(R.x), skinctl::cast<U>(R.y), skinctl::cast<U>(R.z)};
}

/// A value as C++ source, so that a failing case can be pasted into a test of its own.
template <class T>
std::string as_code(const Rotation<T>& R) {
  return "Rotation<T>{" + as_code(R.x) + ", " + as_code(R.y) + ", " + as_code(R.z) + "}";
}
template <class A, class B, class T>
std::string as_code(const Transform<A, B, T>& X) {
  return "Transform<A, B, T>::trusted(" + as_code(X.axes()) + ", " + as_code(X.origin()) + ")";
}

}  // namespace skinctl::testing
