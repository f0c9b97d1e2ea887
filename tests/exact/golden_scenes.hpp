// The scenes of the golden runs, and the robot that they command.
#pragma once

#include <array>
#include <deque>
#include <limits>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/configurations.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/clearance_limits.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/skin_watch.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/passivity/energy_tank.hpp"
#include "skinctl/passivity/passivity_observer.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/skills/library.hpp"
#include "tests/support/ur5_clearance.hpp"

namespace skinctl::golden {

/// A robot by its model that takes each joint's own interface, behind a delay of one period and a lag of half
/// a one, and hands that press its skin.
template <class Scene>
class Run {
 public:
  static constexpr std::size_t joints = Scene::joints;
  using Input = typename Scene::Input;

  Run(const Scene& scene, const std::array<Interface, joints>& takes, Nanoseconds planned,
      const JointPosition<joints>& at)
      : period(planned), scene_(scene), takes_(takes), state{{}, at, {}} {
    scene_.start(memory_, state);
    for (std::size_t i = 0; i < joints; ++i)
      under_way_[i] = sent_[i] = takes[i] == Interface::position ? at[i] : 0.0;
  }

  /// The number that joint `i` takes.
  [[nodiscard]] double asked(const JointCommand<joints>& c, std::size_t i) const {
    return takes_[i] == Interface::position
               ? c.position[i]
               : (takes_[i] == Interface::velocity ? c.velocity[i] : c.torque[i]);
  }

  auto cycle() {
    move();
    input.now = state.time;
    input.measured = state;
    input.measured.dq = reported(state.dq);
    if (break_state) break_state(input.measured);
    if (!holds_samples) press();
    input.samples = samples_;
    const auto out = scene_.step(memory_, input);
    if (out.planned.valid)
      for (std::size_t i = 0; i < joints; ++i) under_way_[i] = sent_[i], sent_[i] = asked(out.planned, i);
    input.request = {};
    forget_goal(input);
    break_state = nullptr;
    ++k_;
    return out;
  }

  Input input;
  const Nanoseconds period;
  Nanoseconds late{};          ///< added to the time of the next cycle
  bool held = false;           ///< the robot is held fast
  bool holds_samples = false;  ///< the skin is silent
  void (*break_state)(State<joints>&) = nullptr;

 private:
  static JointVelocity<joints> reported(const JointVelocity<joints>& dq) { return dq; }
  template <class I>
  static void forget_goal(I& in) {
    if constexpr (requires { in.goal.reset(); }) in.goal.reset();
  }
  void move() {
    const double dt = seconds<double>(period + late);
    state.time += period + late;
    late = {};
    if (held) {
      state.dq = {};
      return;
    }
    bool driven = false;
    for (std::size_t i = 0; i < joints; ++i) {
      const double before = state.q[i];
      if (takes_[i] == Interface::position) {
        state.q[i] += 0.75 * (under_way_[i] - before);
        state.dq[i] = (state.q[i] - before) / dt;
      } else if (takes_[i] == Interface::velocity) {
        state.dq[i] += 0.75 * (under_way_[i] - state.dq[i]);
        state.q[i] += dt * state.dq[i];
      } else {
        driven = true;
      }
    }
    if constexpr (requires { scene_.resolver(); }) {
      if (driven) move_driven(dt);
    }
  }
  /// Joints by torque, each as a rotor with viscous friction that carries its weight: enough of a world.
  void move_driven(double dt) {
    const auto& model = scene_model();
    constexpr int parts = 4;
    for (int part = 0; part < parts; ++part) {
      const auto mass = mass_matrix(model, state.q);
      const auto weight = gravity_torque(model, state.q);
      for (std::size_t i = 0; i < joints; ++i) {
        if (takes_[i] != Interface::torque) continue;
        const double rotor = 0.05, friction = 0.2;
        state.dq[i] +=
            dt / parts * (under_way_[i] - weight[i] - friction * state.dq[i]) / (mass(i, i) + rotor);
        state.q[i] += dt / parts * state.dq[i];
      }
    }
  }
  [[nodiscard]] const auto& scene_model() const { return scene_.resolver().model(); }
  /// Three neighbours are pressed for 100 cycles out of each 300; all cells report each 25 cycles.
  void press() {
    samples_.clear();
    const std::uint32_t phase = k_ % 300, turn = k_ / 300;
    const auto first = 1 + (37 * turn) % 250;
    const bool pressed = phase >= 100 && phase < 200;
    const double rise = static_cast<double>(phase - 100) / 50.0;
    const double share = pressed ? (rise < 1 ? rise : 2 - rise) : 0.0;
    const auto of = [&](std::uint32_t id) {
      const bool is_pressed = id >= first && id < first + 3;
      const float f = is_pressed ? static_cast<float>(0.4 * share) : 0.0F;
      CellSample out{.time = state.time - 1ms, .cell = id};
      out.force = {f, f, f};
      out.proximity = is_pressed && pressed ? 0.5F : 0.0F;
      return out;
    };
    if (k_ % 25 == 0) {
      for (std::uint32_t id = 1; id <= 260; ++id) samples_.push_back(of(id));
    } else if (phase >= 100 && phase <= 200) {
      for (std::uint32_t id = first; id < first + 3; ++id) samples_.push_back(of(id));
    }
  }

  const Scene& scene_;
  std::array<Interface, joints> takes_;
  typename Scene::Memory memory_;
  std::vector<CellSample> samples_;
  std::array<double, joints> under_way_, sent_;
  std::uint32_t k_ = 0;

 public:
  State<joints> state;
};

// The parts of scenes.
template <Interface I>
constexpr std::array<Interface, 6> all_take = {I, I, I, I, I, I};
inline constexpr std::array<double, 6> home = {0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

inline RobotConfiguration<6> arm_numbers(Nanoseconds period) {
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0), .period = period, .delay = period};
  c.lag = period / 2;
  c.virtual_damping = 6;
  return c;
}
/// Three joints of the arm as a group.
inline RobotConfiguration<3> half_numbers(Nanoseconds period) {
  const JointLimits<3> limits({.lower = JointPosition<3>::constant(-6.2),
                               .upper = JointPosition<3>::constant(6.2),
                               .velocity = JointVelocity<3>::constant(3),
                               .acceleration = JointAcceleration<3>::constant(15),
                               .torque = JointTorque<3>::constant(100)});
  RobotConfiguration<3> c{.limits = limits, .period = period, .delay = period};
  c.lag = period / 2;
  c.virtual_damping = 6;
  return c;
}
inline auto hexagons() {
  SkinSettings s;
  s.max_age = 1s;
  return ur5_skin<260>({.force = 20, .proximity = 0.5}, s);
}
inline auto led() {
  return SkinJointControl{} + GravityControl{};
}
template <class Robot>
auto reaching(const Robot& robot, double lambda = 10) {
  auto s = tracking_settings(robot);
  s.lambda = lambda;
  s.K_c = 2;
  return SplineJoint<6>(s) + SkinJointControl{} + GravityControl{};
}
template <class Input, class Goal>
void give(Input& input, const Goal& goal) {
  input.goal = goal;
}
/// A goal each 700 cycles.
template <class R>
void send_goals(int k, R& run) {
  if (k % 700 != 1) return;
  JointGoal<6> goal{JointPosition<6>(home), 2s};
  for (std::size_t i = 0; i < 6; ++i)
    goal.q_g[i] += 0.3 * static_cast<double>((k / 700 + static_cast<int>(i)) % 3 - 1);
  give(run.input, goal);
}
inline auto nothing = [](int, auto&) {};
/// Goals, and consent after each stop.
inline auto goals_and_consent = [](int k, auto& run) {
  send_goals(k, run);
  if (k % 400 == 399) run.input.request = CycleRequest::resume;
};
/// States that are no numbers or old, silences, late cycles, clocks that leap, stops, a robot that is held.
inline auto faults = [](int k, auto& run) {
  if (k % 500 == 250) run.late = run.period * (k / 500 + 1);
  if (k % 500 >= 300 && k % 500 < 305)
    run.break_state = [](auto& s) { s.q[1] = std::numeric_limits<double>::quiet_NaN(); };
  if (k % 900 >= 600 && k % 900 < 640) run.break_state = [](auto& s) { s.time = s.time - 10s; };
  run.held = k % 1000 >= 700 && k % 1000 < 760;
  run.holds_samples = k % 800 >= 400 && k % 800 < 420;
  if (k == 2100) run.late = 30s;
  if (k % 600 == 420) run.input.request = CycleRequest::stop;
  if (k % 600 == 480 || k % 600 == 560) run.input.request = CycleRequest::resume;
};
inline auto goals_and_faults = [](int k, auto& run) {
  send_goals(k, run);
  faults(k, run);
};

inline auto all_limits() {
  LinkContact<2> contact{
      .region = {.force = 140, .blow = 280, .first = 500ms, .stiffness = 1e4, .mass = 4, .power = 80},
      .reach = 0.5,
      .reaction_time = 20ms};
  contact.newton = 10;
  return std::tuple(MaxToolSpeed<5>{.speed = 0.25, .point = {0.0, 0.0, 0.1}, .reach = 1.0}, SkinWatch{},
                    contact);
}

/// Calls `tell(name, scene, interfaces, period, home, own)` with each.
template <class Tell>
void each_scene(const Tell& tell) {
  using enum Interface;
  const JointPosition<6> at(home);
  const auto arm = [](auto interface, Nanoseconds period, const auto&... parts) {
    constexpr Interface I = decltype(interface)::value;
    auto c = arm_numbers(period);
    if constexpr (I == torque) {
      c.virtual_damping = 0, c.lag = 0ns;
      return by_torque(ur5::Model{}, c, FrictionUncompensated{}, parts...);
    } else {
      return robot_by<I>(ur5::Model{}, c, parts...);
    }
  };
  constexpr std::integral_constant<Interface, position> p;
  constexpr std::integral_constant<Interface, velocity> v;
  constexpr std::integral_constant<Interface, torque> t;
  const auto goals = [](int k, auto& run) { send_goals(k, run); };

  tell("position", Cycle(arm(p, 8ms), hexagons(), reaching(arm(p, 8ms))), all_take<position>, 8ms, at, goals);
  tell("velocity", Cycle(arm(v, 8ms), hexagons(), reaching(arm(v, 8ms))), all_take<velocity>, 8ms, at, goals);
  tell("torque", Cycle(arm(t, 2ms), hexagons(), reaching(arm(t, 2ms))), all_take<torque>, 2ms, at, goals);

  const auto half = half_numbers(8ms);
  const auto mixed =
      by_groups(ur5::Model{}, position_joints<0b000111>(half), velocity_joints<0b111000>(half));
  tell("groups", Cycle(mixed, hexagons(), led()),
       std::array{position, position, position, velocity, velocity, velocity}, 8ms, at, nothing);
  auto driven = half_numbers(2ms);
  driven.virtual_damping = 0, driven.lag = 0ns;
  const auto wrist =
      by_groups(ur5::Model{}, position_joints<0b000111>(half_numbers(2ms)), torque_joints<0b111000>(driven));
  tell("groups_torque", Cycle(wrist, hexagons(), led()),
       std::array{position, position, position, torque, torque, torque}, 2ms, at, nothing);

  const EnergyTank<> tank({.start = 2, .max = 5});
  const PassivityObserver<> observer({.start = 1, .max = 5});
  tell("passive", Cycle(arm(p, 8ms, tank, observer), hexagons(), led()), all_take<position>, 8ms, at,
       nothing);

  const auto limited = [&](const auto& scene) {
    return std::apply([&](const auto&... parts) { return scene.with(parts...); }, all_limits());
  };
  tell("limits_position", limited(Cycle(arm(p, 8ms), hexagons(), reaching(arm(p, 8ms)))), all_take<position>,
       8ms, at, goals_and_consent);
  tell("limits_torque", limited(Cycle(arm(t, 2ms), hexagons(), reaching(arm(t, 2ms)))), all_take<torque>, 2ms,
       at, goals_and_consent);
  tell("jerk",
       Cycle(arm(p, 8ms), hexagons(), reaching(arm(p, 8ms))).with(MaxJerk{JointJerk<6>::constant(300)}),
       all_take<position>, 8ms, at, goals);
  tell("clearance", Cycle(arm(p, 8ms), hexagons(), reaching(arm(p, 8ms))).with(testing::ur5_clearance<4>()),
       all_take<position>, 8ms, at, [](int k, auto& run) {
         send_goals(k, run);
         // A ball that comes and goes, and for a second nobody looks.
         auto& around = run.input.around;
         if (k % 1300 < 1200) around.time = run.state.time;
         around.count = 0;
         Obstacle<Base> ball;
         const double way = 0.001 * (k % 800 < 400 ? k % 400 : 400 - k % 400);
         ball.shape = {{0.9 - way, 0.2, 0.4}, {0.9 - way, 0.2, 0.4}, 0.1};
         around.add(ball);
       });

  const auto loaded = [&](double kg, double lambda) {
    const auto robot =
        by_position(Loaded<ur5::Model, 5>(ur5::Model{},
                                          {.mass = kg, .c = {0, 0, 0.1}, .xx = 0.01, .yy = 0.01, .zz = 0.01}),
                    arm_numbers(8ms));
    return Cycle(robot, hexagons(), reaching(robot, lambda));
  };
  tell("configurations", Configurations(loaded(0.1, 10), loaded(3, 20)), all_take<position>, 8ms, at,
       [](int k, auto& run) {
         send_goals(k, run);
         run.input.configuration = static_cast<std::uint32_t>(k / 600 % 2);
       });
  const auto settings = tracking_settings(arm(p, 8ms));
  const auto skills = skill_set<behaviour::KinestheticJoint>(
      boost::hana::union_(figure_7, section_6), SkillSettings{},
      skill_controller<controller::Gravity>(GravityControl{}),
      skill_controller<controller::SkinJoint>(SkinJointControl{}),
      skill_controller<controller::SplineJoint>(SplineJoint<6>(settings)));
  using Set = std::remove_cv_t<decltype(skills)>;
  tell("skills", Cycle(arm(p, 8ms), hexagons(), skills), all_take<position>, 8ms, at, [](int k, auto& run) {
    if (k % 500 != 1) return;
    JointGoal<6> goal{JointPosition<6>(home), 2s};
    goal.q_g[0] += 0.4 * (k / 500 % 3 - 1);
    give(run.input,
         Set::start_skill(static_cast<std::uint8_t>(k / 500 % static_cast<int>(Set::skills)), goal));
  });
  tell("faults_position", Cycle(arm(p, 8ms), hexagons(), reaching(arm(p, 8ms))), all_take<position>, 8ms, at,
       goals_and_faults);
  tell("faults_velocity", Cycle(arm(v, 8ms), hexagons(), led()), all_take<velocity>, 8ms, at, faults);
  tell("faults_torque", Cycle(arm(t, 2ms), hexagons(), reaching(arm(t, 2ms))), all_take<torque>, 2ms, at,
       goals_and_faults);
}

}  // namespace skinctl::golden
