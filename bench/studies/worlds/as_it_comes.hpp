// A UR5 as it comes, run under a cycle with skin, and its twin that is declared truly.
#pragma once

#include <algorithm>
#include <memory>

#include "bench/studies/worlds/as_it_comes_robot.hpp"

namespace skinctl::testing {

/// What came of a case.
struct AsItComesResult {
  double moved = 0;       ///< most way of a joint that nobody touched [rad]: before the first touch, and 1 s
                          ///< after the last one
  double beyond = -1;     ///< the same less what gap, droop, friction and encoder of that joint explain
  double early = 0;       ///< largest force until `guided` [N]
  double late = 0;        ///< and after it
  double goal_error = 0;  ///< at the end, less gap and droop [rad]; without goal 0
  double last_speed = 0;  ///< of any joint in the last half second [rad/s]
  double outside = 0;     ///< furthest from the pose of the start in the whole run [rad]
  double alone =
      0;  ///< most way of a joint in one go on which no hand led it, less the same slack [rad]: the hands did
          ///< no work on it, or their work was below a tenth of force times way; without goal
  Status reasons;
  bool valid = true;  ///< every command was
  int consents = 0;
  double asked_at = -1;  ///< when consent was first asked for [s]
};

/// What is promised of a case, beside its twin.
struct AsItComesVerdict {
  static constexpr double late_bound = 1.5;
  double early_ratio = 0, late_ratio = 0;
  bool moved, early, late, goal, away, led_further, silent = false;

  /// No harder than `late_bound` times its twin; while gaps are met and agreed to, in the first 10 s of
  /// guided motion, and while the arm is blocked: no harder than a rigid one.
  AsItComesVerdict(const AsItComes& c, const AsItComesResult& r, const AsItComesResult& twin) {
    constexpr double felt = 5;  // less than this force is no force
    if (twin.early > 0 || r.early > 0) early_ratio = std::max(r.early, felt) / std::max(twin.early, felt);
    if (twin.late > 0 || r.late > 0) late_ratio = std::max(r.late, felt) / std::max(twin.late, felt);
    moved = r.beyond > 0;
    const double rigid = c.hand * c.way;
    early = r.early > std::max(rigid, late_bound * twin.early);
    late = late_ratio > late_bound && (c.scene != AsItComesScene::blocked || r.late > rigid);
    goal = r.goal_error > 0.01;
    // Alone: further than the greatest lead of the virtual robot (0.36 rad for 60 ms) and a little coasting.
    // A hand may lead an arm as far as it likes; it slides along a smooth finger, so twins part.
    led_further = r.outside > twin.outside + 0.5;
    away =
        r.beyond > 0.1 || r.alone > 0.4 || (c.scene == AsItComesScene::held_goal && led_further) || !r.valid;
    const Status everyday =
        Status(Reason::sample_stale) | Reason::opposed | Reason::bumpless_transfer | Reason::goal_stretched;
    silent = !good() && (r.reasons.bits() & ~everyday.bits()) == 0;
  }
  [[nodiscard]] bool good() const { return !(moved || early || late || goal || away || silent); }
};

/// The scene of a case, with the settings of the main job.
/// @param truly  the configuration states the real lag.
template <Interface I, class L>
auto as_it_comes_cycle(const AsItComes& c, bool truly, const L& law) {
  auto limits = ur5_test_limits().values();
  limits.velocity = JointVelocity<6>::constant(3);
  limits.acceleration = JointAcceleration<6>::constant(30);
  RobotConfiguration<6> r{.limits = JointLimits<6>(limits), .period = c.period, .delay = 8ms};
  r.lag = nanoseconds(truly ? c.truth.lookahead + c.truth.lag : c.declared_lag);
  r.dead_band = JointPosition<6>::constant(c.dead_band);
  r.virtual_damping = 6;
  r.viscous_friction = JointTorque<6>::constant(10);
  const std::array<double, 6> newtons{60, 70, 50, 25, 15, 15};
  std::array<CellGains, 6> gains;
  for (std::size_t i = 0; i < 6; ++i) gains[i].force = newtons[i];
  SkinSettings skin;
  skin.max_age = 10s;
  return Cycle(robot_by<I>(ur5::Model{}, r), ur5_skin<AsItComesWorld::cells_of_skin>(gains, skin), law);
}

/// A case, run once. `trace(t, joints, command, forces)` is called every cycle.
/// @param truly  its encoders have been calibrated; the scene is given that of `as_it_comes_cycle`.
template <class Scene, class Trace>
AsItComesResult run_as_it_comes(const AsItComes& c, const Scene& scene, bool truly, Trace&& trace) {
  using Joints = UndeclaredJoints<6>;
  auto truth = c.truth;
  if (truly) truth.gap = {};
  std::array<double, 6> start{};
  for (std::size_t i = 0; i < 6; ++i) start[i] = c.pose[i];
  Joints joints(c.interface == Interface::position ? Joints::Kind::position : Joints::Kind::velocity, truth,
                start, c.seed);
  AsItComesWorld world(c, start);
  joints.external(world.torque(TruePoses(start), {}));
  constexpr double settled = 5;
  joints.advance(settled);  // under its load
  const auto q0 = joints.q();
  // What explains that a joint which nobody touches moves: gap, droop, friction and encoder, and what its
  // servo makes of a step by its gap.
  std::array<double, 6> slack{}, rest = q0, led = q0, alone_to = q0, sent = alone_to;
  const auto load = world.torque(TruePoses(q0), {});
  for (std::size_t i = 0; i < 6; ++i) {
    slack[i] = std::abs(truth.gap[i]) + (std::abs(load[i]) + truth.stiction[i]) / truth.stiffness[i] +
               2 * truth.resolution + 8 * truth.noise + 1e-3;
    alone_to[i] += truth.gap[i];
  }
  if (c.interface == Interface::position) {
    Joints alone = joints;
    alone.command(settled, alone_to);
    for (double t = settled; t < settled + 0.5; alone.advance(t += 1e-3)) {
      alone.external(world.torque(TruePoses(alone.q()), {}));  // its weight turns with it
      for (std::size_t i = 0; i < 6; ++i)
        slack[i] = std::max(slack[i], std::abs(alone.q()[i] - q0[i]) + 2 * truth.resolution + 1e-3);
    }
  }

  const auto memory = std::make_unique<typename Scene::Memory>();
  typename Scene::Input input;
  const auto read = [&] {
    const auto& m = joints.measured();
    input.measured = {nanoseconds(m.time), JointPosition<6>(m.q), JointVelocity<6>(m.dq)};
    return m.fresh;
  };
  bool heard = false;
  read();
  input.measured.time = nanoseconds(settled);
  if constexpr (requires { scene.start(*memory, input.measured, input.measured.q); }) {
    if (c.reports_held)
      scene.start(*memory, input.measured, JointPosition<6>(joints.reference()));
    else
      scene.start(*memory, input.measured);
  } else {
    scene.start(*memory, input.measured);
  }
  Random random = seeded(~c.seed);
  AsItComesResult out;
  std::vector<CellSample> samples;
  const double ends = c.scene == AsItComesScene::untouched ? 10 : world.ends;
  const bool to_goals = c.scene == AsItComesScene::held_goal;
  double waits = 0;
  int goals = 0;
  bool rested = false;
  std::array<double, 2> forces{};
  for (int ms = 1; ms <= static_cast<int>(1000 * ends); ++ms) {
    const double t = 1e-3 * ms;
    const Nanoseconds now = nanoseconds(settled) + ms * 1ms;
    const bool fast = c.scene == AsItComesScene::blocked && t > 12 && t < c.let_go;
    for (std::size_t i = 0; i < 6; ++i) joints.hold_fast(i, fast);
    joints.advance(settled + t);
    const TruePoses poses(joints.q());
    if (ms == static_cast<int>(1000 * (to_goals ? world.faster : world.begins))) world.take_hold(poses);
    forces = world.forces(poses, t);
    joints.external(world.torque(poses, forces));
    double& peak = t < c.guided ? out.early : out.late;
    peak = std::max({peak, forces[0], forces[1]});
    if (ms % 4 == 0)
      for (std::size_t k = 0; k < 2; ++k) {
        const auto f = static_cast<float>(std::min(1.0, forces[k] / (3 * world.newtons)));
        samples.push_back({.time = now, .cell = world.cell(k).id, .force = {f, f, f}});
      }
    // Who moves it? A hand that presses on a robot that slides along it leads it too.
    const auto pressed = world.torque(poses, forces), weight = world.torque(poses, {});
    double power = 0, size = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double p = (pressed[i] - weight[i]) * joints.dq()[i];
      power += p, size += std::abs(p);
    }
    if (power > 0.1 * size || to_goals || ms == 1) led = joints.q();
    for (std::size_t i = 0; i < 6; ++i)
      out.alone = std::max(out.alone, std::abs(joints.q()[i] - led[i]) - slack[i]);
    const bool before = t<world.begins, after = t> world.leaves + 1.5;
    if (!after) rest = joints.q();
    if (after && !to_goals && !rested) {
      rested = true;
      // The integral of a servo goes on for a while, whatever stands still.
      Joints still = joints;
      still.command(settled + t, c.interface == Interface::position ? sent : std::array<double, 6>{});
      for (double at = t; at < ends; still.advance(settled + (at += 1e-3))) {
        still.external(world.torque(TruePoses(still.q()), {}));
        for (std::size_t i = 0; i < 6; ++i)
          slack[i] = std::max(slack[i], std::abs(still.q()[i] - rest[i]) + 2 * truth.resolution + 1e-3);
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      const double q = joints.q()[i];
      out.outside = std::max(out.outside, std::abs(q - q0[i]));
      if (t > ends - 0.5) out.last_speed = std::max(out.last_speed, std::abs(joints.dq()[i]));
      if (before || c.scene == AsItComesScene::untouched || (after && !to_goals)) {
        const double way = std::abs(q - (after ? rest : q0)[i]);
        out.moved = std::max(out.moved, way);
        out.beyond = std::max(out.beyond, way - slack[i]);
      }
      if (to_goals && (ms == 6000 || ms == 17000)) {
        const double to = ms == 6000 ? c.goal[i] : c.pose[i];
        out.goal_error = std::max(out.goal_error, std::abs(q - to) - slack[i]);
      }
    }
    if (ms % static_cast<int>(c.period / 1ms) != 0) continue;
    // An output that is skipped is a measurement that does not come, or a cycle that does not.
    const bool fresh = read();
    if ((!fresh && random() % 2 == 0) || (!fresh && !heard)) continue;  // a job begins with the first state
    heard = true;
    input.now = now;
    input.samples = samples;
    input.request = CycleRequest::none;
    if constexpr (requires { input.goal->q_g; }) {
      input.goal.reset();
      if (goals < (ms >= 6000 ? 2 : ms >= 1000 ? 1 : 0)) input.goal = {goals++ == 0 ? c.goal : c.pose, 4s};
    }
    if (waits > 0.5) input.request = CycleRequest::resume, waits = 0, ++out.consents;
    const auto result = scene.step(*memory, input);
    samples.clear();
    out.valid = out.valid && result.command.valid;
    out.reasons |= result.status;
    const bool asks = result.status.has(Reason::displaced) || result.status.has(Reason::consent_awaited);
    waits = asks ? waits + seconds<double>(c.period) : 0;
    if (asks && out.asked_at < 0) out.asked_at = t;
    for (std::size_t i = 0; i < 6; ++i)
      sent[i] = c.interface == Interface::position ? result.planned.position[i] : result.planned.velocity[i];
    joints.command(settled + t, sent);
    trace(t, joints, result, forces);
  }
  return out;
}

/// A case as it comes, or its twin that is declared truly.
template <class Trace>
AsItComesResult run_as_it_comes(const AsItComes& c, bool truly, Trace&& trace) {
  const auto with = [&]<Interface I>(std::integral_constant<Interface, I>) {
    if (c.scene != AsItComesScene::held_goal)
      return run_as_it_comes(c, as_it_comes_cycle<I>(c, truly, SkinJointControl{} + GravityControl{}), truly,
                             trace);
    JointControlSettings<6> s;
    s.dt = 2500us;  // five periods of 8 ms in 16 sub-steps
    s.lambda = 8, s.K_c = 2, s.K_i1 = 0.2, s.K_i2 = 0.02;
    s.tb = {};
    s.virtual_dynamics.damping = 6;
    s.virtual_dynamics.viscous = JointTorque<6>::constant(10);
    return run_as_it_comes(
        c, as_it_comes_cycle<I>(c, truly, SplineJoint<6>(s) + SkinJointControl{} + GravityControl{}), truly,
        trace);
  };
  return c.interface == Interface::position ? with(std::integral_constant<Interface, Interface::position>{})
                                            : with(std::integral_constant<Interface, Interface::velocity>{});
}
inline AsItComesResult run_as_it_comes(const AsItComes& c, bool truly) {
  return run_as_it_comes(c, truly, [](auto&&...) {});
}

/// The case where the robot stands as soon as its gap has been met: a twin there is touched like it.
[[nodiscard]] inline AsItComes started_in_gap(AsItComes c) {
  for (std::size_t i = 0; i < 6; ++i) c.pose[i] += c.truth.gap[i];
  return c;
}

/// The case with other noise, that starts elsewhere: each joint by a random share of `gaps`, and by up to
/// `aside`.
[[nodiscard]] inline AsItComes started_aside(AsItComes c, const std::array<double, 6>& gaps, double aside,
                                             std::uint64_t number) {
  Random random = seeded(c.seed ^ (number << 40));
  for (std::size_t i = 0; i < 6; ++i)
    c.pose[i] += gaps[i] * uniform(random, 0.0, 1.0) + aside * uniform(random, -1.0, 1.0);
  c.seed += number << 40;
  return c;
}

/// The worst of several twins. What a hand meets that slides along a link, and when a plan waits for it,
/// hangs on millimetres, and how far a blocked arm leaps that is let go, on the moment: a robot declared
/// truly parts from itself, too. Twins therefore start where the robot as it comes may stand: the first in
/// its gap, the others up to there and 5 mrad away; blocked ones are let go at other moments.
inline AsItComesResult worst_twin(const AsItComes& c, AsItComesResult worst, std::uint64_t further) {
  for (std::uint64_t k = 1; k <= further; ++k) {
    AsItComes aside = k == 1 ? started_in_gap(c) : started_aside(c, c.truth.gap, 0.005, k);
    if (k > 1) aside.let_go -= 0.3 * static_cast<double>(k - 1);
    const auto twin = run_as_it_comes(aside, true);
    worst.early = std::max(worst.early, twin.early);
    worst.late = std::max(worst.late, twin.late);
    worst.goal_error = std::max(worst.goal_error, twin.goal_error);
    worst.outside = std::max(worst.outside, twin.outside);
  }
  return worst;
}

}  // namespace skinctl::testing
