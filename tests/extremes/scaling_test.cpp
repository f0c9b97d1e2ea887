// Functions of lengths, speeds, forces and masses over the whole range of a scalar: what is multiplied by a
// power of two gives the same bits, multiplied by its power. Where that ends is each row's promise; beyond
// lies no NaN unless the row says so.
//
// Promise: functions of lengths, speeds, forces and masses keep every bit over the whole range of
// exponents
// Tried: 17 functions, every power of two: the same bits times its power, until squares, or fourth powers
// of capsules, leave the range; no NaN beyond where a result is one number

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

namespace {

struct A;
struct B;

/// What becomes of values beyond a row's range.
enum class Beyond { number, nan_too };

template <class T>
struct Row {
  const char* name;
  int degree;    ///< results of s times the arguments are s^degree times the results
  int internal;  ///< the highest power of the arguments inside
  Beyond beyond;
  std::function<std::vector<T>(T)> at;  ///< the results for arguments multiplied by this
};

template <class T>
Xyz<T> u(T s) {
  return {T(0.3) * s, T(-0.7) * s, T(0.5) * s};
}
template <class T>
Xyz<T> v(T s) {
  return {T(-0.2) * s, T(0.4) * s, T(0.9) * s};
}
template <class T>
std::vector<T> list(const Xyz<T>& x) {
  return {x.x, x.y, x.z};
}
template <class V>
auto list(const V& x) {
  return std::vector<typename V::scalar>(x.begin(), x.end());
}
template <class T>
Capsule<T> capsule(T s, const Xyz<T>& from, const Xyz<T>& way, T radius) {
  return {s * from, s * (from + way), s * radius};
}

template <class T>
std::vector<Row<T>> rows() {
  using V6 = JointVelocity<6, T>;
  static const ur5::Model arm;
  static const JointPosition<6, T> q{T(0.3), T(-1.2), T(1.4), T(0.2), T(-0.7), T(0.1)};
  static const JointAngles<ur5::Model, T> angles(arm, q);
  const auto dq = [](T s) {
    return V6{T(0.1) * s, T(-0.2) * s, T(0.3) * s, T(0.5) * s, T(-0.4) * s, T(0.6) * s};
  };
  static const auto poses = link_poses(arm, q);
  static const auto J = jacobian<5>(poses);
  static const auto X = poses.template get<5>();
  return {
      {"norm", 1, 2, Beyond::number, [](T s) { return std::vector<T>{norm(u(s))}; }},
      {"dot", 2, 2, Beyond::number, [](T s) { return std::vector<T>{dot(u(s), u(s))}; }},
      {"cross", 2, 2, Beyond::nan_too, [](T s) { return list(cross(u(s), v(s))); }},
      {"eigenvalues", 1, 1, Beyond::nan_too,
       [](T s) {
         return list(
             eigenvalues(Symmetric<T>{T(2) * s, T(3) * s, T(4) * s, T(0.5) * s, T(-0.3) * s, T(0.1) * s}));
       }},
      {"a point in another frame, one term", 1, 1, Beyond::nan_too,
       [](T s) { return list(X.axes() * u(s)); }},
      {"distance of capsules that cross", 1, 4, Beyond::nan_too,
       [](T s) {
         return std::vector<T>{distance(capsule<T>(s, {T(0), T(0), T(0)}, {T(1), T(0), T(0.25)}, T(0.125)),
                                        capsule<T>(s, {T(0.5), T(-1), T(1)}, {T(0), T(2), T(0)}, T(0.0625)))
                                   .distance};
       }},
      {"distance of a point and a capsule", 1, 2, Beyond::nan_too,
       [](T s) {
         return std::vector<T>{
             distance(Xyz<T>(u(s)), capsule<T>(s, {T(0), T(0), T(1)}, {T(1), T(0), T(0.25)}, T(0.125)))};
       }},
      {"shortest_spline_time, of the distance", 1, 1, Beyond::number,
       [](T s) { return std::vector<T>{shortest_spline_time(T(T(0.7) * s), T(1.5))}; }},
      {"shortest_spline_time, of the speed", -1, 1, Beyond::number,
       [](T s) { return std::vector<T>{shortest_spline_time(T(0.7), T(T(1.5) * s))}; }},
      {"quintic, speed, of the rate", 1, 1, Beyond::number,
       [](T s) { return std::vector<T>{quintic(T(0.4), s).a2}; }},
      {"quintic, acceleration, of the rate", 2, 2, Beyond::number,
       [](T s) { return std::vector<T>{quintic(T(0.4), s).a3}; }},
      {"reduced_mass", 1, 1, Beyond::number,
       [](T s) { return std::vector<T>{reduced_mass(T(T(40) * s), T(T(7) * s))}; }},
      {"C dq", 2, 2, Beyond::nan_too, [=](T s) { return list(coriolis_torque(arm, angles, dq(s))); }},
      {"kinetic energy", 2, 2, Beyond::number,
       [=](T s) { return std::vector<T>{kinetic_energy(arm, angles, dq(s))}; }},
      {"twist of the tool", 1, 1, Beyond::nan_too,
       [=](T s) {
         const auto V = J * dq(s);
         auto out = list(Xyz<T>{V.linear.x, V.linear.y, V.linear.z});
         for (const T x : {V.angular.x, V.angular.y, V.angular.z}) out.push_back(x);
         return out;
       }},
      {"bias acceleration of the tool", 2, 2, Beyond::nan_too,
       [=](T s) {
         const auto a = bias_acceleration(J, dq(s));
         return std::vector<T>{a.linear.x, a.linear.y, a.linear.z};
       }},
  };
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: powers of two pass through functions of lengths, speeds and masses", T, float,
                   double) {
  using L = std::numeric_limits<T>;
  for (const Row<T>& row : rows<T>()) {
    CAPTURE(std::string(row.name));
    const std::vector<T> one = row.at(T(1));
    // Below, the least terms of a sum lose digits; above, a sum of some squares is larger than each.
    const int low = (L::min_exponent + L::digits + 12) / row.internal,
              high = (L::max_exponent - 12) / row.internal;
    for (int k = L::min_exponent - L::digits; k < L::max_exponent; ++k) {
      CAPTURE(k);
      const std::vector<T> found = row.at(std::ldexp(T(1), k));
      REQUIRE(found.size() == one.size());
      for (std::size_t i = 0; i < one.size(); ++i) {
        CAPTURE(i);
        if (k >= low && k <= high) CHECK(found[i] == std::ldexp(one[i], k * row.degree));
        if (row.beyond == Beyond::number) CHECK_FALSE(std::isnan(found[i]));
      }
    }
  }
}
