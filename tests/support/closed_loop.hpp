// A resolver with simulated joints, pushed by torques that a test gives as functions of time.
#pragma once

#include <functional>
#include <random>
#include <span>

#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/simulated_joints.hpp"

namespace skinctl::testing {

/// Mean torques over a sub-step, in place of a skin.
template <std::size_t N, class T>
struct Pushed {
  JointTorque<N, T> torque;
  friend Pushed led_by(const Pushed& touch, const T& share, const Pushed& change) noexcept {
    return {touch.torque + share * change.torque};
  }
};

/// The pushing torques and gravity compensation: a robot that only yields.
struct Yield {
  struct Memory {
    std::uint64_t evaluations = 0;
  };
  static constexpr Needs needs{.gravity = true, .touch = true};
  static constexpr LawRole role = LawRole::reactive;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  auto torque(const Memory&, const K& known) const noexcept {
    return known.touch().torque + known.gravity();
  }
  template <class K>
  Memory advance(const Memory& m, const K&, typename K::scalar, Opposition) const noexcept {
    return {m.evaluations + 1};
  }
};

/// The anti-derivative of a torque: means over any interval are exact.
using Impulse = std::function<std::array<double, 6>(double)>;

template <Interface I, class T = double, class Integrator = CrankNicolson, class M = ur5::Model>
class ClosedLoop {
 public:
  using Robot = ResolverBy<I, M, T, Integrator, 128>;
  static constexpr auto kind =
      I == Interface::position ? SimulatedJoints<6>::Kind::position : SimulatedJoints<6>::Kind::velocity;

  ClosedLoop(const typename Robot::Configuration& c, const std::array<double, 6>& q, double real_delay,
             double real_lag)
      : robot(M{}, c), joints(kind, real_delay, real_lag, q), memory(robot.start(measure(0ns))) {}

  State<6, T> measure(Nanoseconds now) {
    State<6, T> s;
    s.time = now;
    for (std::size_t i = 0; i < 6; ++i) {
      s.q[i] = static_cast<T>(joints.q()[i] + noise * normal(rng));
      s.dq[i] = static_cast<T>(joints.dq()[i]);
    }
    return s;
  }

  /// One cycle at `now`.
  auto step(Nanoseconds now, const Impulse& impulse) {
    joints.advance(seconds<double>(now));
    const auto interval = robot.interval(memory, now);
    Pushed<6, T> pushes[max_substeps];
    for (unsigned j = 0; j < interval.substeps; ++j) {
      const double a = seconds<double>(interval.at(j)), b = seconds<double>(interval.at(j + 1));
      const auto from = impulse(a), to = impulse(b);
      for (std::size_t i = 0; i < 6; ++i) pushes[j].torque[i] = static_cast<T>((to[i] - from[i]) / (b - a));
    }
    measured = measure(now);
    const auto out = robot.step(memory, law, law_memory, measured, interval,
                                std::span<const Pushed<6, T>>(pushes, interval.substeps));
    typename SimulatedJoints<6>::Row row;
    for (std::size_t i = 0; i < 6; ++i)
      row[i] =
          static_cast<double>(I == Interface::position ? out.command.position[i] : out.command.velocity[i]);
    joints.command(seconds<double>(now), row);
    return out;
  }

  Robot robot;
  SimulatedJoints<6> joints;
  State<6, T> measured;  ///< input of the last cycle
  double noise = 0;
  std::mt19937_64 rng{7};
  std::normal_distribution<double> normal{0, 1};
  Yield law;
  Yield::Memory law_memory;
  typename Robot::Memory memory;
};

}  // namespace skinctl::testing
