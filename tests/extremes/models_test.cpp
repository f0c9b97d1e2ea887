// Kinematics and dynamics at the ends of what a number holds: a bound, a status, or NaN where the docstring
// says so.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;
namespace {

/// Zero, denormal numbers, multiples of right angles and their neighbours, every tenth of the exponents, the
/// largest.
template <class T>
std::vector<T> numbers() {
  using L = std::numeric_limits<T>;
  std::vector<T> out{T(0), L::denorm_min(), L::min(), T(1), T(800), T(1e6), L::max()};
  const T right = std::atan2(T(1), T(0));
  for (const int k : {1, 2, 3, 4, 1000, 4000000})
    for (const T at :
         {T(k) * right, std::nextafter(T(k) * right, T(0)), std::nextafter(T(k) * right, L::max())})
      out.push_back(at);
  for (int e = L::min_exponent10; e <= L::max_exponent10; e += L::max_exponent10 / 10)
    out.push_back(std::pow(T(10), T(e)));
  const std::size_t n = out.size();
  for (std::size_t i = 0; i < n; ++i) out.push_back(-out[i]);
  return out;
}
template <class V>
bool all_finite(const V& v) {
  for (const auto& x : v)
    if (!std::isfinite(x)) return false;
  return true;
}

/// A chain whose links weigh 1 kg and `ratio` kg in turn.
template <class T>
CalibratedModel<Chain<6>, T> uneven(double ratio) {
  typename CalibratedModel<Chain<6>, T>::Links links;
  for (std::size_t i = 0; i < 6; ++i) {
    const double m = i % 2 == 0 ? 1 : ratio;
    links[i] = make_link({.p = {0.3, 0, 0.1}, .alpha = Angle::quarter(i % 2 == 0 ? 1 : 0)},
                         {m, {0.1, 0.02, 0}, 0.01 * m, 0.02 * m, 0.02 * m})
                   .template cast<T>();
  }
  return CalibratedModel<Chain<6>, T>(links);
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: poses, Jacobian, G and M are those of a robot for every finite angle", T,
                   SKINCTL_EXTREME_SCALARS) {
  const T eps = std::numeric_limits<T>::epsilon();
  const ur5::Model model;
  for (const T x : numbers<T>())
    for (std::size_t joint = 0; joint < 6; ++joint) {
      JointPosition<6, T> q{T(0.3), T(-1.2), T(1.4), T(0.2), T(-0.7), T(0.1)};
      q[joint] = x;
      CAPTURE(x);
      CAPTURE(joint);
      const auto poses = link_poses(model, q);
      const auto tool = poses.template get<5>();
      const auto place = poses.template place<5>();
      CHECK(rotation_error(Rotation<T>{dense<T>(place.x), dense<T>(place.y), dense<T>(place.z)}) <= 32 * eps);
      CHECK(norm(tool.origin()) <= T(1.2));
      jacobian<5>(poses).for_each([&](auto, const auto& column) {
        CHECK(norm(column.linear) <= T(1.2));
        CHECK(std::abs(norm(column.angular) - T(1)) <= 32 * eps);
      });
      for (const T& tau : gravity_torque(model, q)) CHECK(std::abs(tau) <= T(60));
      const auto mass = mass_matrix(model, q);
      const MassFactors<ur5::Model, T> factors(mass);
      CHECK(factors.positive_definite());
      for (std::size_t i = 0; i < 6; ++i) CHECK((mass(i, i) > T(0) && mass(i, i) < T(5)));
    }
}

TEST_CASE_TEMPLATE(
    "extremes: an angle that is no number makes what the joint carries NaN, and nothing before it", T,
    SKINCTL_EXTREME_SCALARS) {
  const ur5::Model model;
  for (const T wrong : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    JointPosition<6, T> q;
    q[3] = wrong;
    const auto poses = link_poses(model, q);
    CHECK(std::isfinite(poses.template get<2>().origin().x));
    CHECK(std::isnan(poses.template get<5>().origin().x));
    const auto moved = forward_dynamics(model, q, {}, {});
    CHECK_FALSE(moved.positive_definite);
  }
}

TEST_CASE_TEMPLATE(
    "extremes: torques of any rates are finite until their squares overflow, and not finite beyond", T,
    SKINCTL_EXTREME_SCALARS) {
  using L = std::numeric_limits<T>;
  const ur5::Model model;
  const JointPosition<6, T> q{T(0.3), T(-1.2), T(1.4), T(0.2), T(-0.7), T(0.1)};
  for (const T x : numbers<T>()) {
    CAPTURE(x);
    const auto dq = JointVelocity<6, T>::constant(x);
    const auto ddq = JointAcceleration<6, T>::constant(x);
    const auto by_rate = inverse_dynamics(model, q, dq, {}),
               by_acceleration = inverse_dynamics(model, q, {}, ddq);
    const T root = std::sqrt(L::max());
    if (std::abs(x) < root / 100) CHECK(all_finite(by_rate));
    if (std::abs(x) > root * 100) CHECK_FALSE(all_finite(by_rate));
    if (std::abs(x) < L::max() / 100) CHECK(all_finite(by_acceleration));
    const auto moved = forward_dynamics(model, q, dq, {});
    CHECK(moved.positive_definite);
    if (std::abs(x) < root / 1000) CHECK(all_finite(moved.acceleration));
    const auto pushed = forward_dynamics(model, q, {}, JointTorque<6, T>::constant(x));
    if (std::abs(x) < L::max() / T(1e6)) CHECK(all_finite(pushed.acceleration));
  }
}

TEST_CASE_TEMPLATE(
    "extremes: links of 1e-30 times their neighbours' mass: a finite acceleration, or a status", T,
    SKINCTL_EXTREME_SCALARS) {
  for (const double ratio : {1e-30, 1e-20, 1e-10, 1e-5, 1.0, 1e5, 1e10, 1e20, 1e30}) {
    CAPTURE(ratio);
    const auto model = uneven<T>(ratio);
    const JointPosition<6, T> q{T(0.3), T(-1.2), T(1.4), T(0.2), T(-0.7), T(0.1)};
    const auto moved =
        forward_dynamics(model, q, JointVelocity<6, T>::constant(T(0.5)), JointTorque<6, T>::constant(T(1)));
    CHECK((!moved.positive_definite || all_finite(moved.acceleration)));
    for (const T& a : moved.acceleration) CHECK_FALSE(std::isnan(a));
    if (ratio > 1e-3 && ratio < 1e3) CHECK(moved.positive_definite);
  }
}
