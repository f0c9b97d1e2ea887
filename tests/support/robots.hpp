// The robots of the tests: each as a model of skinctl and as the table for the oracles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "skinctl/core/joint.hpp"
#include "skinctl/model/placement.hpp"
#include "skinctl/robots/allegro.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/digits50.hpp"
#include "tests/support/robot_table.hpp"

namespace skinctl::testing {

template <class M>
struct TabledRobot {
  using Model = M;
  static constexpr std::size_t joints = M::joints;
  const char* name;
  M model;
  oracle::Robot table;
  std::array<double, M::joints>
      turn;  ///< the table's frame of link i is the model's, turned by -turn[i] about z
};

/// A tree with two branches at the base, one branch within a branch, and three prismatic joints.
struct MixedTree {
  static constexpr std::size_t joints = 9;
  static constexpr std::array<int, 9> parents = {-1, 0, 1, 1, 3, -1, 5, 5, 7};
  static constexpr std::array<JointKind, 9> kinds = {
      JointKind::revolute, JointKind::prismatic, JointKind::revolute,
      JointKind::revolute, JointKind::prismatic, JointKind::revolute,
      JointKind::revolute, JointKind::prismatic, JointKind::revolute};
};

inline PlacedLink placed(const oracle::Body& b) {
  const auto& R = b.R;
  return {{{R[0], R[3], R[6]}, {R[1], R[4], R[7]}, {R[2], R[5], R[8]}},
          {b.p[0], b.p[1], b.p[2]},
          {b.mass,
           {b.com[0], b.com[1], b.com[2]},
           b.inertia[0],
           b.inertia[4],
           b.inertia[8],
           b.inertia[1],
           b.inertia[2],
           b.inertia[5]}};
}

/// A random robot of a given shape, the same numbers for the model and for the oracles.
template <class Tree, class T = double>
TabledRobot<CalibratedModel<Tree, T>> random_robot(const char* name, std::uint64_t seed) {
  oracle::Random random(seed);
  oracle::Robot table;
  std::array<PlacedLink, Tree::joints> links;
  for (std::size_t i = 0; i < Tree::joints; ++i) {
    const auto motion =
        Tree::kinds[i] == JointKind::revolute ? oracle::Motion::revolute : oracle::Motion::prismatic;
    table.bodies.push_back(oracle::random_body(random, Tree::parents[i], motion));
    links[i] = placed(table.bodies.back());
  }
  for (double& g : table.gravity) g = random.uniform(-9.81, 9.81);
  const auto canonical = canonical_links<Tree>(links);
  typename CalibratedModel<Tree, T>::Links numbers;
  for (std::size_t i = 0; i < Tree::joints; ++i) numbers[i] = canonical.links[i].template cast<T>();
  return {name,
          CalibratedModel<Tree, T>(numbers, {T(table.gravity[0]), T(table.gravity[1]), T(table.gravity[2])}),
          table, canonical.turn};
}

inline auto ur5_robot() {
  return TabledRobot<ur5::Model>{"ur5", {}, oracle::ur5(), {}};
}
template <class T = double>
auto ur5_calibrated_robot() {
  return TabledRobot<ur5::Calibrated<T>>{
      "ur5 calibrated", calibrated_from<ur5::Description, T>(), oracle::ur5(), {}};
}
inline auto allegro_robot() {
  TabledRobot<CalibratedModel<allegro::Tree>> robot{
      "allegro", allegro::right_hand(), oracle::allegro_right(), {}};
  for (std::size_t f = 0; f < 4; ++f) {
    const auto canonical = canonical_links<Chain<4>>(allegro::finger_links(f));
    for (std::size_t i = 0; i < 4; ++i) robot.turn[4 * f + i] = canonical.turn[i];
  }
  return robot;
}

/// Calls `f(robot)` for every robot: by day for a known one and for the tree that has everything, by night for
/// one with calibrated numbers, a hand and a long chain as well.
template <class F>
void for_each_robot(F&& f) {
  f(ur5_robot());
  f(random_robot<MixedTree>("mixed tree", 11));
#ifndef SKINCTL_GATE
  f(ur5_calibrated_robot());
  f(allegro_robot());
  f(random_robot<Chain<7>>("chain of 7", 7));
#endif
}

/// A random motion: positions up to `reach`, velocities and accelerations up to 3.
template <std::size_t N, class T = double>
struct Motion {
  JointPosition<N, T> q;
  JointVelocity<N, T> dq, dq_r;
  JointAcceleration<N, T> ddq;

  explicit Motion(oracle::Random& random, double reach = 3.2) {
    for (std::size_t i = 0; i < N; ++i) {
      q[i] = static_cast<T>(random.uniform(-reach, reach));
      dq[i] = static_cast<T>(random.uniform(-3, 3));
      dq_r[i] = static_cast<T>(random.uniform(-3, 3));
      ddq[i] = static_cast<T>(random.uniform(-3, 3));
    }
  }
};

template <class V>
std::vector<Digits50> wide(const V& v) {
  std::vector<Digits50> out;
  for (const auto& x : v) out.push_back(Digits50(x));
  return out;
}

/// Largest difference of two rows of numbers, relative to the largest number in the second.
template <class A, class B>
double relative_error(const A& a, const B& b, std::size_t n) {
  Digits50 error(0), scale(0);
  for (std::size_t i = 0; i < n; ++i) {
    const Digits50 difference = abs(Digits50(a[i]) - Digits50(b[i]));
    if (!(difference <= error)) error = difference;
    if (const Digits50 size = abs(Digits50(b[i])); size > scale) scale = size;
  }
  return scale == 0 ? static_cast<double>(error) : static_cast<double>(error / scale);
}

}  // namespace skinctl::testing
