// Arms by torque in a closed loop: held commands, a delay, dry friction, and a payload that is not as told.
#pragma once

#include <cmath>
#include <deque>
#include <memory>
#include <string>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/plant.hpp"

namespace skinctl::testing {

// A 7-joint arm with the joints of an FR3; masses are made up.
struct SevenDescription {
  static constexpr std::size_t joints = 7;
  static constexpr auto parents = chain_parents<7>();
  static constexpr auto kinds = all_of_kind<7>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 7> links = {
      make_link({.p = {0, 0, 0.333}}, {3, {0, -0.03, -0.07}, 0.02, 0.02, 0.01}),
      make_link({.alpha = Angle::quarter(-1)}, {3, {0, -0.07, 0.03}, 0.02, 0.01, 0.02}),
      make_link({.p = {0, -0.316, 0}, .alpha = Angle::quarter(1)},
                {2.5, {0.04, 0.03, -0.05}, 0.01, 0.01, 0.01}),
      make_link({.p = {0.0825, 0, 0}, .alpha = Angle::quarter(1)},
                {2.5, {-0.04, 0.05, 0.03}, 0.01, 0.01, 0.01}),
      make_link({.p = {-0.0825, 0.384, 0}, .alpha = Angle::quarter(-1)},
                {2, {0, 0.04, -0.1}, 0.02, 0.02, 0.005}),
      make_link({.alpha = Angle::quarter(1)}, {1.5, {0.05, 0, 0}, 0.003, 0.005, 0.005}),
      make_link({.p = {0.088, 0, 0}, .alpha = Angle::quarter(1)}, {0.7, {0, 0, 0.08}, 0.002, 0.002, 0.001})};
  static constexpr std::array<double, 7> lower = {-2.8, -1.7, -2.8, -3.0, -2.8, 0.0, -2.8};
  static constexpr std::array<double, 7> upper = {2.8, 1.7, 2.8, -0.1, 2.8, 3.7, 2.8};
  static constexpr std::array<double, 7> max_velocity = {2.1, 2.1, 2.1, 2.1, 2.6, 2.6, 2.6};
  static constexpr std::array<double, 7> max_torque = {87, 87, 87, 87, 12, 12, 12};
};

struct Ur5 {
  using Arm = Loaded<ur5::Model, 5>;
  using Description = ur5::Description;
  static constexpr JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
  static Arm with(const LinkInertia& load) { return Arm(ur5::Model{}, load); }
};
struct Seven {
  using Arm = Loaded<StaticModel<SevenDescription>, 6>;
  using Description = SevenDescription;
  static constexpr JointPosition<7> home{0.0, -0.4, 0.0, -2.0, 0.0, 1.7, 0.0};
  static Arm with(const LinkInertia& load) { return Arm(StaticModel<SevenDescription>{}, load); }
};

LinkInertia gripped(double mass) {
  if (mass == 0) return {};
  return {.mass = mass, .c = {0, 0, 0.15}, .xx = 0.002 * mass, .yy = 0.002 * mass, .zz = 0.002 * mass};
}

/// The declared times, which are the true ones.
struct Loop {
  Nanoseconds period, delay;
};
constexpr Loop fr3_loop{1ms, 2ms};
/// What is told and what is so.
struct Truth {
  Loop loop;
  double told = 0, carried = 0;        ///< payload [kg]
  double rotors = 0, real_rotors = 0;  ///< at each joint [kg m^2]
  bool may_be_empty = false;           ///< told: the gains are those for a robot that may carry nothing
  double friction = 0;                 ///< of each joint, dry, which nobody compensates [N m]
  Nanoseconds end = 8s;
};
struct Seen {
  double peak = 0;    ///< largest speed of a joint [rad/s]
  double late = 0;    ///< the same in the last quarter
  double worst = 0;   ///< largest distance of a joint from its reference [rad]
  double off = 0;     ///< largest distance of a joint from its goal at the end [rad]
  double others = 0;  ///< the same without the last joint

  /// Faster than any of these joints may be, or at the end still as fast as the way to the goal asks.
  [[nodiscard]] bool ran_away() const { return !(peak < 3 && late < 0.5); }
};

/// Period 1 to 8 ms, delay 0 to 20 ms; none, half or all of `rated` [kg] told, and as much carried; half with
/// dry friction of 4 N m. An arm that may have lost its payload is told so; one that carries more than told
/// is not.
template <class Random>
Truth random_truth(Random& random, double rated, double rotors) {
  const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n + 1)); };
  Truth t;
  t.loop = {(1 + upto(7)) * 1ms, upto(20) * 1ms};
  t.told = 0.5 * upto(2) * rated, t.carried = 0.5 * upto(2) * rated;
  t.rotors = t.real_rotors = rotors;
  t.may_be_empty = t.told > 0;
  t.friction = 4.0 * upto(1);
  return t;
}

/// The arm as told, with a payload of `load` [kg].
template <class Robot>
auto described(const Truth& t, double load) {
  return by_torque(Robot::with(gripped(load)),
                   {.limits = limits_of<typename Robot::Description>(15.0),
                    .period = t.loop.period,
                    .delay = t.loop.delay,
                    .virtual_inertia = JointTorque<Robot::Arm::joints>::constant(t.rotors)},
                   FrictionUncompensated{});
}
/// The default gains.
template <class Robot>
auto default_gains(const Truth& t) {
  const auto arm = described<Robot>(t, t.told);
  return t.may_be_empty ? tracking_settings(arm, described<Robot>(t, 0)) : tracking_settings(arm);
}

/// A goal for all joints, 0.4 rad away in 1.5 s.
template <class Robot, class Gains>
Seen reach(const Truth& t, const Gains& gains) {
  using Arm = typename Robot::Arm;
  constexpr std::size_t N = Arm::joints;
  const Cycle cycle(described<Robot>(t, t.told), SplineJoint<N>(gains) + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(cycle)>;

  const Arm real = Robot::with(gripped(t.carried));
  const auto rotors = JointTorque<N>::constant(t.real_rotors);
  State<N> x{0ns, Robot::home, {}};
  const auto memory = std::make_unique<typename Scene::Memory>();
  cycle.start(*memory, x);
  JointTorque<N> tau = memory->robot.command().torque;
  std::deque<std::pair<Nanoseconds, JointTorque<N>>> under_way;
  auto goal = Robot::home;
  for (std::size_t i = 0; i < N; ++i) goal[i] += i % 2 == 0 ? 0.4 : -0.3;
  const Nanoseconds asked = 50 * t.loop.period;
  const JointSpline<N> course{Robot::home, goal, 1.5};
  typename Scene::Input input;
  Seen seen;
  constexpr Nanoseconds step = 100us;
  for (Nanoseconds now = t.loop.period; now <= t.end; now += t.loop.period) {
    for (; x.time < now; x.time += step) {
      for (; !under_way.empty() && under_way.front().first <= x.time; under_way.pop_front())
        tau = under_way.front().second;
      auto pushed = tau;
      if (t.friction > 0)
        for (std::size_t i = 0; i < N; ++i) pushed[i] -= t.friction * std::tanh(x.dq[i] / 0.01);
      x.dq = integrate(x.dq, acceleration(real, x, pushed, rotors), seconds<double>(step));
      x.q = integrate(x.q, x.dq, seconds<double>(step));
    }
    const auto target = course.at(std::max(0.0, seconds<double>(now - asked)));
    for (std::size_t i = 0; i < N; ++i) {
      seen.peak = std::max(seen.peak, std::abs(x.dq[i]));
      if (4 * now > 3 * t.end) seen.late = std::max(seen.late, std::abs(x.dq[i]));
      seen.worst = std::max(seen.worst, std::abs(x.q[i] - target.q_d[i]));
    }
    if (!(seen.peak < 100)) break;
    input.now = now;
    input.measured = x;
    input.goal.reset();
    if (now == asked) input.goal = {goal, 1500ms};
    under_way.push_back({now + t.loop.delay, cycle.step(*memory, input).command.torque});
  }
  for (std::size_t i = 0; i < N; ++i) {
    const double off = std::abs(x.q[i] - goal[i]);
    seen.off = std::max(seen.off, off);
    if (i + 1 < N) seen.others = std::max(seen.others, off);
  }
  return seen;
}
template <class Robot>
Seen reach(const Truth& t) {
  return reach<Robot>(t, default_gains<Robot>(t));
}
/// The default gains, refused or not.
template <class Robot>
struct Tried {
  std::string refused;  ///< the reason
  Seen seen;
  explicit Tried(const Truth& t) {
    try {
      seen = reach<Robot>(t);
    } catch (const ConfigurationError& e) {
      refused = e.what();
    }
  }
};

}  // namespace skinctl::testing
