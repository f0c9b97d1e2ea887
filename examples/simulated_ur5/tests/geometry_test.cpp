#include "examples/simulated_ur5/geometry.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "examples/simulated_ur5/random.hpp"

using namespace simulated_ur5;

namespace {

using Matrix = std::array<std::array<double, 4>, 4>;

Matrix times(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

/// The maker's table, row by row: Rz(theta) Tz(d) Tx(a) Rx(alpha).
Matrix row(double theta, double d, double a, double alpha) {
  const double ct = std::cos(theta), st = std::sin(theta), ca = std::cos(alpha), sa = std::sin(alpha);
  return {{{ct, -st * ca, st * sa, a * ct}, {st, ct * ca, -ct * sa, a * st}, {0, sa, ca, d}, {0, 0, 0, 1}}};
}

Joints random_joints(Random& random, double reach) {
  Joints q{};
  for (double& x : q) x = reach * (2 * random.uniform() - 1);
  return q;
}

void check_near(Vec3 a, double x, double y, double z, double tolerance = 1e-12) {
  CHECK(std::abs(a.x - x) < tolerance);
  CHECK(std::abs(a.y - y) < tolerance);
  CHECK(std::abs(a.z - z) < tolerance);
}

}  // namespace

TEST_CASE("Links: stand where the maker's Denavit-Hartenberg table puts them") {
  const double a[6] = {0, -0.425, -0.39225, 0, 0, 0}, d[6] = {0.089159, 0, 0, 0.10915, 0.09465, 0.0823};
  const double alpha[6] = {pi / 2, 0, 0, pi / 2, -pi / 2, 0};
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    const Joints q = random_joints(random, n == 0 ? 0 : 2 * pi);
    const Links links = forward_kinematics(q);
    Matrix before = row(0, 0, 0, 0);
    for (std::size_t i = 0; i < joint_count; ++i) {
      const Matrix turned = times(before, row(q[i], 0, 0, 0));
      check_near(links.link[i].origin, turned[0][3], turned[1][3], turned[2][3]);
      check_near(links.link[i].x, turned[0][0], turned[1][0], turned[2][0]);
      check_near(links.link[i].z, turned[0][2], turned[1][2], turned[2][2]);
      before = times(before, row(q[i], d[i], a[i], alpha[i]));
    }
    check_near(links.flange.origin, before[0][3], before[1][3], before[2][3]);
    check_near(links.flange.y, before[0][1], before[1][1], before[2][1]);
  }
}

TEST_CASE("Links: a point's speed is the difference of its places, and torque times speed is power") {
  Random random(2);
  const double h = 1e-6;
  for (int n = 0; n < 100; ++n) {
    const Joints q = random_joints(random, pi), dq = random_joints(random, 2);
    const auto link = static_cast<std::size_t>(random.uniform() * 6);
    const Vec3 local{0.1 * random.normal(), 0.1 * random.normal(), 0.1 * random.normal()};
    Joints ahead{}, behind{};
    for (std::size_t i = 0; i < joint_count; ++i) {
      ahead[i] = q[i] + h * dq[i];
      behind[i] = q[i] - h * dq[i];
    }
    const Links links = forward_kinematics(q);
    const Vec3 point = links.link[link].point(local);
    const Vec3 v = point_velocity(links, link, point, dq);
    const Vec3 difference = (0.5 / h) * (forward_kinematics(ahead).link[link].point(local) -
                                         forward_kinematics(behind).link[link].point(local));
    check_near(v, difference.x, difference.y, difference.z, 1e-8);
    const Vec3 force{random.normal(), random.normal(), random.normal()};
    const Joints torque = torque_of_force(links, link, point, force);
    double power = 0;
    for (std::size_t i = 0; i < joint_count; ++i) power += torque[i] * dq[i];
    CHECK(power == doctest::Approx(dot(force, v)).epsilon(1e-10));
    const Vec3 w = angular_velocity(links, link, dq);
    const Vec3 axis = forward_kinematics(ahead).link[link].x - forward_kinematics(behind).link[link].x;
    const Vec3 turned = cross(w, links.link[link].x);
    check_near((0.5 / h) * axis, turned.x, turned.y, turned.z, 1e-8);
  }
}

TEST_CASE("Gravity: the torque is the slope of the potential energy") {
  const double mass[6] = {3.7, 8.393, 2.33, 1.219, 1.219, 0.1879};
  const Vec3 centre[6] = {{0, -0.02561, 0.00193}, {0.2125, 0, 0.11336}, {0.15, 0, 0.0265},
                          {0, -0.0018, 0.01634},  {0, 0.0018, 0.01634}, {0, 0, -0.001159}};
  const double a[6] = {0, -0.425, -0.39225, 0, 0, 0}, d[6] = {0.089159, 0, 0, 0.10915, 0.09465, 0.0823};
  const double alpha[6] = {pi / 2, 0, 0, pi / 2, -pi / 2, 0};
  const auto energy = [&](const Joints& q) {
    Matrix T = row(0, 0, 0, 0);
    double sum = 0;
    for (std::size_t i = 0; i < joint_count; ++i) {
      T = times(T, row(q[i], d[i], a[i], alpha[i]));
      sum +=
          9.81 * mass[i] * (T[2][0] * centre[i].x + T[2][1] * centre[i].y + T[2][2] * centre[i].z + T[2][3]);
    }
    return sum;
  };
  Random random(3);
  for (int n = 0; n < 50; ++n) {
    const Joints q = random_joints(random, pi);
    const Joints torque = gravity_torque(forward_kinematics(q));
    for (std::size_t i = 0; i < joint_count; ++i) {
      Joints up = q, down = q;
      up[i] += 1e-5;
      down[i] -= 1e-5;
      CHECK(std::abs(torque[i] - (energy(up) - energy(down)) / 2e-5) < 1e-7);
    }
  }
}

TEST_CASE("Rotation vector: gives the rotation back, up to half a turn") {
  Random random(4);
  for (const double angle : {0.0, 1e-9, 1e-4, 1.0, 3.0, pi - 1e-9, pi}) {
    for (int n = 0; n < 20; ++n) {
      const Vec3 k = normalised({random.normal(), random.normal(), random.normal()});
      // Rodrigues, axis by axis.
      const auto turned = [&](Vec3 v) {
        return std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k;
      };
      const Pose pose{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {}};
      const Vec3 r = rotation_vector(pose);
      const double near_half = pi - angle < 1e-6 ? 1 : 0;
      // At half a turn the axis may point either way.
      const double sign = near_half > 0 && dot(r, k) < 0 ? -1 : 1;
      check_near(sign * r, angle * k.x, angle * k.y, angle * k.z, 1e-6);
    }
  }
}
