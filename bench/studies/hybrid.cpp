// An arm by velocity and a hand by torque: a UR5 with an Allegro hand in one hybrid cycle, beside what it is
// made of. The arm's commands against those of a velocity interface alone, on a UR5 that carries the hand as
// one body in the same pose; the hand's torques against those of a torque interface alone, for all 22 joints.
// And what a cycle costs.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5_allegro.hpp"

using namespace skinctl;

namespace {

template <std::size_t N>
struct Pushes {
  JointTorque<N> torque;
};

// Yields to what pushes; soft springs to where it began.
template <std::size_t N>
struct Springs {
  struct Memory {};
  static constexpr Needs needs{.gravity = true, .touch = true};
  static constexpr LawRole role = LawRole::reactive;
  JointPosition<N> goal;

  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<N> torque(const Memory&, const K& known) const noexcept {
    auto tau = known.touch().torque + known.gravity();
    for (std::size_t i = 0; i < N; ++i) tau[i] += 0.2 * (goal[i] - known.q()[i]);
    return tau;
  }
  template <class K>
  Memory advance(const Memory&, const K&, double, Opposition) const noexcept {
    return {};
  }
};

template <std::size_t N>
JointLimits<N> wide(double torque) {
  return JointLimits<N>({.lower = JointPosition<N>::constant(-3),
                         .upper = JointPosition<N>::constant(3),
                         .velocity = JointVelocity<N>::constant(3),
                         .acceleration = JointAcceleration<N>::constant(40),
                         .torque = JointTorque<N>::constant(torque)});
}

using Whole = ur5_allegro::Model<>;
using Robot = Resolver<Whole, double,
                       JointGroups<22, JointGroup<Interface::velocity, joints_between(0, 6)>,
                                   JointGroup<Interface::torque, joints_between(6, 22)>>>;
constexpr std::array<double, 6> pose{0.1, -1.5, 1.2, -1.0, -1.5, 0.3};

/// The hand as one body in the frame of link 5.
LinkInertia frozen(const Whole& model, const JointPosition<22>& q) {
  const Stand& s = ur5_allegro::on_flange;
  LinkInertia load = seen_from(s.R, {s.p[0], s.p[1], s.p[2]}, allegro::palm);
  const Poses<Whole, all_links(22), double> poses(model, q);
  [&]<std::size_t... K>(std::index_sequence<K...>) {
    const auto add = [&](auto k) {
      const auto X = poses.get<5>().inverse() * poses.get<k.value>();
      load = combined(load, seen_from(X.axes(), X.origin(), inertia_of(numbers_of<k.value, double>(model))));
    };
    (add(std::integral_constant<std::size_t, K + 6>{}), ...);
  }(std::make_index_sequence<16>{});
  return load;
}

}  // namespace

int main() {
  const auto model = ur5_allegro::arm_with_hand();
  RobotConfiguration<6> arm{
      .limits = limits_of<ur5::Description>(), .period = 4ms, .delay = 8ms, .virtual_damping = 0};
  arm.viscous_friction = {20, 20, 10, 2, 1, 0.5};
  const Robot robot = resolver_of(
      by_velocity_and_torque<joints_between(6, 22)>(model, {.stiff = arm, .limits = wide<16>(0.7)}));
  State<22> measured;
  for (std::size_t i = 0; i < 22; ++i) measured.q[i] = i < 6 ? pose[i] : 0.2 + 0.03 * double(i % 5);
  const Loaded<ur5::Model, 5> loaded(ur5::Model{}, frozen(model, measured.q));
  const ResolverBy<Interface::velocity, Loaded<ur5::Model, 5>> alone(loaded, arm);
  const ResolverBy<Interface::torque, Whole> torques(model, {.limits = wide<22>(1e3), .period = 4ms});

  const Springs<22> law{measured.q};
  const Springs<6> arm_law{Robot::Stiff::of(measured.q)};
  Springs<22>::Memory law_memory, torque_law_memory;
  Springs<6>::Memory arm_memory;
  auto memory = robot.start(measured);
  auto alone_memory = alone.start(part_of<Robot::Stiff>(measured));
  double travel = 0, velocity_off = 0, torque_off = 0;
  std::vector<double> cost;
  for (Nanoseconds now = 4ms; now < 4s; now += 4ms) {
    const double t = seconds<double>(now), s = t < 2 ? std::sin(4 * t) : 0;
    Pushes<22> touches[2];
    Pushes<6> arm_touches[2];
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t i = 0; i < 22; ++i)
        touches[j].torque[i] = i < 6 ? s * std::array{15.0, 20.0, -8.0, 2.0, 1.0, 0.2}[i] : 0.05 * s;
      arm_touches[j].torque = Robot::Stiff::of(touches[j].torque);
    }
    measured.time = now;
    Robot::Stiff::put(memory.group().under_way.reached, measured.q);
    const auto begin = std::chrono::steady_clock::now();
    const auto out = robot.step(memory, law, law_memory, measured, robot.interval(memory, now),
                                std::span<const Pushes<22>>(touches));
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    cost.push_back(took.count());
    const auto want =
        alone.step(alone_memory, arm_law, arm_memory, {now, alone_memory.group().under_way.reached, {}},
                   alone.interval(alone_memory, now), std::span<const Pushes<6>>(arm_touches));
    const auto state = robot.state(memory);
    auto torque_memory = torques.start({now - 4ms, state.q, state.dq});
    const auto torque =
        torques.step(torque_memory, law, torque_law_memory, state, torques.interval(torque_memory, now),
                     std::span<const Pushes<22>>(touches + 1, 1));
    for (std::size_t i = 0; i < 22; ++i) {
      if (i < 6) {
        velocity_off = std::max(velocity_off, std::abs(out.command.velocity[i] - want.command.velocity[i]));
        travel = std::max(travel, std::abs(out.command.position[i] - pose[i]));
      } else {
        torque_off = std::max(torque_off, std::abs(out.command.torque[i] - torque.command.torque[i]));
      }
    }
  }
  std::sort(cost.begin(), cost.end());
  std::printf(
      "UR5 by velocity and Allegro hand by torque, 250 Hz, two sub-steps a cycle, 4 s of pushes\n"
      "the arm moves by %.2f rad; velocities are those of a velocity interface alone to %.1e rad/s\n"
      "the hand's torques are those of a torque interface alone to %.1e N m\n"
      "a cycle takes %.1f us (median; most %.1f us)\n",
      travel, velocity_off, torque_off, 1e-3 * cost[cost.size() / 2], 1e-3 * cost.back());
  return velocity_off < 1e-9 && torque_off < 1e-12 ? 0 : 1;
}
