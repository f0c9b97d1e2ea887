// Seeded random numbers, states and robots.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/support/robot_table_types.hpp"

namespace oracle {

/// Seeded random numbers, the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {  // splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  }
  int index(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }
  std::vector<double> vector(int n, double reach) {
    std::vector<double> x;
    for (int i = 0; i < n; ++i) x.push_back(uniform(-reach, reach));
    return x;
  }
  /// Uniform on SO(3): a random unit quaternion.
  std::array<double, 9> rotation() {
    double w, x, y, z, n;
    do {
      w = uniform(-1, 1), x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
      n = w * w + x * x + y * y + z * z;
    } while (n > 1 || n < 0.01);
    n = std::sqrt(n);
    w /= n, x /= n, y /= n, z /= n;
    return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
            2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  }

 private:
  std::uint64_t state_;
};

/// A body with random placement, dense and physically consistent inertia; parent and motion as given.
inline Body random_body(Random& random, int parent, Motion motion) {
  using namespace table_detail;
  Body b;
  b.parent = parent;
  b.motion = motion;
  b.R = random.rotation();
  b.mass = random.uniform(0.2, 4);
  for (std::size_t k = 0; k < 3; ++k)
    b.p[k] = random.uniform(-0.4, 0.4), b.com[k] = random.uniform(-0.2, 0.2);
  std::array<double, 3> s{};  // second moments of the mass along its principal axes
  for (double& x : s) x = b.mass * random.uniform(0.0005, 0.01);
  const std::array<double, 9> A = random.rotation();
  const std::array<double, 9> I{s[1] + s[2], 0, 0, 0, s[0] + s[2], 0, 0, 0, s[0] + s[1]};
  b.inertia = product(product(A, I), transposed(A));
  b.inertia[3] = b.inertia[1], b.inertia[6] = b.inertia[2], b.inertia[7] = b.inertia[5];
  return b;
}

/// Tree of `count` bodies; one in five slides, one in eight is fixed unless `all_move`, one in three starts a
/// branch.
inline Robot random_tree(std::uint64_t seed, int count, bool all_move = false) {
  Random random(seed);
  Robot robot;
  for (int i = 0; i < count; ++i) {
    const int parent = random.index(3) == 0 ? random.index(i + 1) - 1 : i - 1;
    Motion motion = random.index(5) == 0 ? Motion::prismatic : Motion::revolute;
    if (!all_move && i > 0 && random.index(8) == 0) motion = Motion::fixed;
    robot.bodies.push_back(random_body(random, parent, motion));
  }
  for (double& g : robot.gravity) g = random.uniform(-9.81, 9.81);
  return robot;
}

/// Chain of `count` revolute joints with random placements.
inline Robot random_chain(std::uint64_t seed, int count) {
  Random random(seed);
  Robot robot;
  for (int i = 0; i < count; ++i) robot.bodies.push_back(random_body(random, i - 1, Motion::revolute));
  return robot;
}

}  // namespace oracle
