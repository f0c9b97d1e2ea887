// A resolver against a spring: whether its oscillation decays or grows.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/support/contact_scene.hpp"

namespace skinctl::testing {

/// A law of touch and gravity only.
struct Touched : StatelessLaw<Touched> {
  static constexpr Needs needs{.angles = true, .gravity = true, .touch = true};
  template <class K>
  auto torque(const K& known) const noexcept {
    return skin_torque(known.model(), known.angles(), known.touch()) + known.gravity();
  }
};

/// The displacement [m] along the first of `rows`, cycle by cycle, of a robot at `q0` that is tied to one or
/// two springs of `stiffness` which push and pull, after an initial displacement `kick` [m]. The springs'
/// forces are linear between cycles. The robot takes its commands `late` [s] after the declared delay: where
/// that is whole periods, the cycle in which they arrive has just missed them.
template <std::size_t K>
std::vector<double> tied_to_springs(const RobotConfiguration<6>& c, const JointPosition<6>& q0,
                                    const double (&rows)[K][6], double stiffness, double seconds_long,
                                    double kick = 1e-7, double late = 1e-9) {
  static_assert(K <= 2);
  const ResolverBy<Interface::position, ur5::Model, double, CrankNicolson, 64> robot(ur5::Model{}, c);
  SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, seconds<double>(c.delay) + late,
                            seconds<double>(c.lag), {q0[0], q0[1], q0[2], q0[3], q0[4], q0[5]});
  State<6> measured;
  measured.q = q0;
  auto memory = robot.start(measured);
  Touched law;
  Touched::Memory law_memory;
  TouchChange<SceneTouch>::Memory touch{};
  std::vector<double> path;
  double last[K];
  for (double& f : last) f = -stiffness * kick;
  for (Nanoseconds now = c.period; now < nanoseconds(seconds_long); now += c.period) {
    joints.advance(seconds<double>(now));
    const auto interval = robot.interval(memory, now);
    SceneTouch parts[max_substeps];
    for (std::size_t k = 0; k < K; ++k) {
      double x = -kick;
      for (std::size_t i = 0; i < 6; ++i) x += rows[k][i] * (joints.q()[i] - q0[i]);
      if (k == 0) path.push_back(x);
      const double force = stiffness * x;
      for (unsigned j = 0; j < interval.substeps; ++j) {
        parts[j].contacts.count = K;
        auto& contact = parts[j].contacts.list[k];
        contact.link = k;
        std::copy(std::begin(rows[k]), std::end(rows[k]), contact.row);
        contact.force = last[k] + (force - last[k]) * (j + 0.5) / interval.substeps;
      }
      last[k] = force;
    }
    measured.time = now;
    measured.q = JointPosition<6>(joints.q());
    SceneTouch changes[max_substeps];
    for (unsigned j = 0; j < interval.substeps; ++j)
      changes[j] = TouchChange<SceneTouch>::next(touch, parts[j]);
    const auto out = robot.step(memory, law, law_memory, measured, interval,
                                std::span<const SceneTouch>(parts, interval.substeps), AnyState{},
                                PressedUnknown{}, std::span<const SceneTouch>(changes, interval.substeps));
    SimulatedJoints<6>::Row command;
    for (std::size_t i = 0; i < 6; ++i) command[i] = out.command.position[i];
    joints.command(seconds<double>(now), command);
  }
  return path;
}

/// Whether the oscillation decays.
template <std::size_t K>
bool swings_out(const RobotConfiguration<6>& c, const JointPosition<6>& q0, const double (&rows)[K][6],
                double stiffness, double late = 1e-9) {
  const double kick = 1e-7;
  const auto path = tied_to_springs(c, q0, rows, stiffness, 8, kick, late);
  const auto largest = [&](std::size_t from, std::size_t to) {
    double most = 0;
    for (std::size_t k = from; k < to; ++k) most = std::max(most, std::abs(path[k]));
    return most;
  };
  const std::size_t n = path.size();
  const double first = largest(n / 4, n / 2), last = largest(3 * n / 4, n);
  // An oscillation at the limits no longer grows, one that has decayed to rounding no longer decays.
  return last < 1e-3 * kick || (last < first && last < 10 * kick);
}

inline bool swings_out(const RobotConfiguration<6>& c, const JointPosition<6>& q0, const double (&row)[6],
                       double stiffness, double late = 1e-9) {
  double rows[1][6];
  std::copy(std::begin(row), std::end(row), rows[0]);
  return swings_out(c, q0, rows, stiffness, late);
}

}  // namespace skinctl::testing
