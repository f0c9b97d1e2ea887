// A resolver with random skills in random contacts, and the energy that the real robot gives.
#pragma once

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/simulated_joints.hpp"

namespace skinctl::testing {

/// Contacts along fixed directions of joint space, exactly conservative, and what is seen but not touched, in
/// place of a skin.
struct SceneTouch {
  using scalar = double;
  Contacts<6, double, 2> contacts;
  JointTorque<6> seen;
};
/// Of two touches with the same contacts.
inline SceneTouch led_by(const SceneTouch& touch, const double& share, const SceneTouch& change) noexcept {
  SceneTouch out = touch;
  for (std::size_t k = 0; k < touch.contacts.count; ++k)
    out.contacts.list[k].force += share * change.contacts.list[k].force;
  out.seen += share * change.seen;
  return out;
}
template <class M, class A>
JointTorque<6> skin_torque(const M&, const A&, const SceneTouch& touch) noexcept {
  JointTorque<6> tau = touch.seen;
  for (const auto& c : touch.contacts)
    for (std::size_t i = 0; i < 6; ++i) tau[i] -= c.force * c.row[i];
  return tau;
}
inline SceneTouch contact_part(const SceneTouch& touch) noexcept {
  return {touch.contacts, {}};
}
template <class M>
Contacts<6, double, 2> contacts_of(const M&, const JointPosition<6>&, const SceneTouch& touch) noexcept {
  return touch.contacts;
}

/// A skill of limited duration: a weight of the skin, and a spring and damper to a goal.
struct TimedSkill {
  double until = 0, skin = 1, pull = 0, stiffness = 0, damping = 0;
  JointPosition<6> goal;
};

/// Skills one after the other, with jumps between them, as a tank has to cover them.
struct RandomSkills : StatelessLaw<RandomSkills> {
  static constexpr Needs needs{.angles = true, .gravity = true, .touch = true};
  std::vector<TimedSkill> skills;

  template <class K>
  JointTorque<6> torque(const K& known) const noexcept {
    const double t = seconds<double>(known.time());
    std::size_t k = 0;
    while (k + 1 < skills.size() && skills[k].until <= t) ++k;
    const TimedSkill& s = skills[k];
    constexpr double scale[6] = {1, 1, 0.6, 0.1, 0.1, 0.05};
    auto tau = s.skin * skin_torque(known.model(), known.angles(), known.touch()) + known.gravity();
    for (std::size_t i = 0; i < 6; ++i)
      tau[i] += s.pull * scale[i] * (s.stiffness * (s.goal[i] - known.q()[i]) - s.damping * known.dq()[i]);
    return tau;
  }
};

/// An obstacle along `row` beyond `at` [m]: a wall, or a hand that moves.
struct StiffBody {
  double row[6] = {};
  double at = 0, stiffness = 0, damping = 0, swing = 0, pulse = 0;  ///< `at + swing sin(pulse t)`
  double seen = 0;  ///< push at its surface, where it is seen but not touched [N]; none from `range` on
  static constexpr double range = 0.05;

  double force(const std::array<double, 6>& q, const std::array<double, 6>& q0,
               const std::array<double, 6>& dq, double t) const {
    double x = 0, v = 0;
    for (std::size_t i = 0; i < 6; ++i) x += row[i] * (q[i] - q0[i]), v += row[i] * dq[i];
    const double depth = x - (at + swing * std::sin(pulse * t));
    return depth > 0 ? std::max(0.0, stiffness * depth + damping * (v - swing * pulse * std::cos(pulse * t)))
                     : 0.0;
  }
  /// The torque by which the arm keeps off.
  void keep_off(const std::array<double, 6>& q, const std::array<double, 6>& q0, double t,
                JointTorque<6>& tau) const {
    double gap = at + swing * std::sin(pulse * t);
    for (std::size_t i = 0; i < 6; ++i) gap -= row[i] * (q[i] - q0[i]);
    const double push = seen * std::clamp(1 - gap / range, 0.0, 1.0);
    for (std::size_t i = 0; i < 6; ++i) tau[i] -= push * row[i];
  }
};

/// A scene from a seed: rate, delay of 0 to 5 cycles, skills, one or two obstacles, half of which are seen
/// before they are touched.
struct RandomScene {
  std::array<double, 6> pose{};
  Nanoseconds period{};
  int delay = 0;
  double lag = 0, energy = 1, tank = 1, stiffest = 0;
  RandomSkills law;
  std::vector<StiffBody> obstacles;
  RobotConfiguration<6> configuration{.limits = limits_of<ur5::Description>(20.0), .period = 8ms};

  /// The parts of `Passivity` at the virtual and at the measured port.
  [[nodiscard]] auto passivity() const {
    return Passivity(
        EnergyTank<>({.start = tank, .max = tank}),
        PassivityObserver<>(
            {.start = energy, .max = energy, .stiffness = stiffest, .reach = {0.6, 0.6, 0.4, 0.1, 0.1, 0}}));
  }

  explicit RandomScene(std::uint64_t seed) {
    std::mt19937_64 rng(seed), other(~seed);
    const auto uniform = [&](double a, double b) {
      return a + (b - a) * std::uniform_real_distribution<>()(rng);
    };
    const auto pick = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(rng); };
    pose = {0.1, -1.5, 1.2, -1, -1.5, 0.3};
    for (double& q : pose) q += uniform(-0.5, 0.5);
    period = std::array<Nanoseconds, 3>{8ms, 4ms, 2ms}[std::size_t(pick(3))];
    delay = pick(6);
    lag = pick(2) * 0.006;
    const double speed = uniform(0.2, 1);
    // Weak brakes give a contact energy that a free robot would not: 1 to 20 rad/s^2.
    const double brake = std::exp(std::log(20.0) * std::uniform_real_distribution<>()(other));
    auto values = limits_of<ur5::Description>(brake).values();
    values.velocity = JointVelocity<6>::constant(speed);
    configuration = {.limits = JointLimits<6>(values), .period = period, .delay = delay * period};
    configuration.lag = nanoseconds(lag);
    configuration.virtual_damping = uniform(1, 8);
    configuration.viscous_friction = JointTorque<6>::constant(uniform(0.5, 5));
    double reach = 0;
    for (int k = 0, n = 1 + pick(2); k < n; ++k) {
      StiffBody o;
      double sum = 0;
      for (std::size_t i = 0; i < 6; ++i) {
        o.row[i] = uniform(-1, 1) * std::array<double, 6>{0.6, 0.6, 0.4, 0.1, 0.1, 0.0}[i];
        sum += std::abs(o.row[i]);
      }
      reach = std::max(reach, sum);
      o.at = uniform(0, 0.05);
      if (pick(2) == 1) o.swing = uniform(0, 0.1), o.pulse = uniform(1, 8);
      obstacles.push_back(o);
    }
    // The stiffest obstacle whose first impact the initial energy pays for.
    const double T = seconds<double>((delay + 1) * period) + lag, v = reach * speed;
    configuration.dead_band = JointPosition<6>::constant(std::min(0.02, speed * T));
    const double p = v * T + 0.5 * v * speed / brake;
    stiffest = std::min(3e4, 2 * energy / (p * p));
    for (StiffBody& o : obstacles) {
      o.stiffness = stiffest * std::exp(uniform(-3, 0)) / double(obstacles.size());
      o.damping = pick(2) * uniform(0, 0.01) * o.stiffness;
      if (o.swing > 0) o.damping = 0, o.stiffness *= 0.3;
      if (std::uniform_int_distribution<>(0, 1)(other) == 1)
        o.seen = 40 * std::uniform_real_distribution<>()(other);
    }
    for (double t = 0; t < 2;) {
      TimedSkill s;
      s.until = t += uniform(0.05, 0.6);
      s.skin = pick(2) ? 1 : uniform(0, 2);
      s.pull = pick(4) ? uniform(0, 1) : 0;
      s.stiffness = uniform(0, 300);
      s.damping = uniform(0, 20);
      for (std::size_t i = 0; i < 6; ++i) s.goal[i] = pose[i] + uniform(-0.4, 0.4);
      law.skills.push_back(s);
    }
  }
};

/// The energies of a scene.
struct Energies {
  double extracted = 0;          ///< largest energy given by the real port at any time [J]
  double virtual_extracted = 0;  ///< the same by the virtual port
  double least_tank = 0, least_ledger = 0;
  double largest_force = 0;
  double path = 0;  ///< of joint 0 [rad]
  double led = 0;   ///< how far the hand led the arm at the end [m]
  Status status;
};

/// Two seconds of a scene with the passivity parts `passivity`; then all contacts have ended, the arm comes
/// to rest, and half a second later a hand leads it with up to 20 N, back along the first contact.
///
/// @param movers  limits of jerk, or `NoJerkLimits`.
template <Interface I, class Integrator = CrankNicolson, class Movers, class PassivityParts, class... Shape>
Energies run_by(const Movers& movers, const RandomScene& scene, const PassivityParts& passivity,
                const Shape&... tool) {
  using Tool = std::tuple_element_t<0, std::tuple<Shape..., NoToolShape>>;
  using Robot = ResolverBy<I, ur5::Model, double, Integrator, 32, PassivityParts, Tool>;
  const Robot robot(ur5::Model{}, scene.configuration, passivity, tool...);
  constexpr auto kind =
      I == Interface::position ? SimulatedJoints<6>::Kind::position : SimulatedJoints<6>::Kind::velocity;
  SimulatedJoints<6> joints(kind, seconds<double>(scene.delay * scene.period), scene.lag, scene.pose);
  State<6> measured;
  measured.q = JointPosition<6>(scene.pose);
  auto memory = robot.start(measured);
  RandomSkills law = scene.law;
  law.skills.back().until = 2;
  law.skills.push_back({.until = 2.5, .skin = 1, .pull = 1, .stiffness = 0, .damping = 30, .goal = {}});
  law.skills.push_back({});
  RandomSkills::Memory law_memory;
  Energies out;
  out.least_tank = out.least_ledger = 1e9;
  double given = 0, given_virtual = 0, force[2] = {};
  TouchChange<SceneTouch>::Memory touch{};
  auto last = joints.q();
  for (Nanoseconds now = scene.period; now < 3100ms; now += scene.period) {
    const double t = seconds<double>(now);
    joints.advance(t);
    const bool at_end = now >= 2s;
    SceneTouch next;
    SceneTouch parts[max_substeps];
    const auto interval = robot.interval(memory, now);
    for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
      const StiffBody& o = scene.obstacles[k];
      std::array<double, 6> dq{};
      for (std::size_t i = 0; i < 6; ++i) dq[i] = (joints.q()[i] - last[i]) / seconds<double>(scene.period);
      const double F = at_end ? (k == 0 ? 20 * std::clamp((t - 2.5) / 0.2, 0.0, 1.0) : 0)
                              : o.force(joints.q(), scene.pose, dq, t);
      double dx = 0;
      for (std::size_t i = 0; i < 6; ++i) dx += o.row[i] * (joints.q()[i] - last[i]);
      if (now >= 2500ms && k == 0) out.led -= dx;
      given += 0.5 * (F + force[k]) * dx;
      out.largest_force = std::max(out.largest_force, F);
      auto& c = next.contacts.list[k];
      c.link = 2 + k;
      c.force = F;
      std::copy(std::begin(o.row), std::end(o.row), c.row);
      for (unsigned j = 0; j < interval.substeps; ++j) {
        auto& part = parts[j].contacts;
        part.list[k] = c;
        part.list[k].force = force[k] + (F - force[k]) * (j + 0.5) / interval.substeps;
        part.count = k + 1;
      }
      force[k] = F;
    }
    // The parts get the newest force, as from a skin sampled at the rate of the commands.
    next.contacts.count = scene.obstacles.size();
    if (!at_end)
      for (const StiffBody& o : scene.obstacles) o.keep_off(joints.q(), scene.pose, t, next.seen);
    for (unsigned j = 0; j < interval.substeps; ++j) parts[j].seen = next.seen;
    parts[interval.substeps - 1] = next;
    out.path += std::abs(joints.q()[0] - last[0]);
    last = joints.q();
    measured.time = now;
    measured.q = JointPosition<6>(joints.q());
    measured.dq = JointVelocity<6>(joints.dq());
    const auto before = memory.group().q.value;
    SceneTouch changes[max_substeps];
    for (unsigned j = 0; j < interval.substeps; ++j)
      changes[j] = TouchChange<SceneTouch>::next(touch, parts[j]);
    const auto result = robot.step(
        memory, law, law_memory, measured, interval, std::span<const SceneTouch>(parts, interval.substeps),
        AnyState{}, PressedUnknown{}, std::span<const SceneTouch>(changes, interval.substeps), movers);
    for (std::size_t i = 0; i < 6; ++i) {
      double tau = 0;
      for (unsigned j = 0; j < interval.substeps; ++j)
        tau += skin_torque(0, 0, contact_part(parts[j]))[i] / interval.substeps;
      given_virtual -= tau * (memory.group().q.value[i] - before[i]);
    }
    out.status |= result.status;
    out.extracted = std::max(out.extracted, given);
    out.virtual_extracted = std::max(out.virtual_extracted, given_virtual);
    if constexpr (Robot::has_tank)
      out.least_tank = std::min(out.least_tank, memory.passivity.template of<EnergyTank<>>().energy);
    if constexpr (Robot::has_passivity_observer)
      out.least_ledger =
          std::min(out.least_ledger, memory.passivity.template of<PassivityObserver<>>().energy);
    SimulatedJoints<6>::Row row;
    for (std::size_t i = 0; i < 6; ++i)
      row[i] = I == Interface::position ? result.command.position[i] : result.command.velocity[i];
    joints.command(t, row);
  }
  return out;
}

template <Interface I, class Integrator = CrankNicolson, class PassivityParts, class... Shape>
Energies run(const RandomScene& scene, const PassivityParts& passivity, const Shape&... tool) {
  return run_by<I, Integrator>(NoJerkLimits{}, scene, passivity, tool...);
}

}  // namespace skinctl::testing
