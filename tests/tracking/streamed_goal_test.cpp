// Goals that a program sends in every cycle, as a stream.
//
// Promise: a goal that is sent anew in each cycle changes nothing, and one that moves slowly is followed
// Tried: splines of joints and of a tool, springs, targets without velocities; the same goal and one of 0.4
// rad/s in each of 1000 cycles of 8 ms; an arm by position, velocity and torque that is touched, stopped and
// resumed meanwhile
//
// Promise: a goal soon after the last one that no motion of the largest speed leads to begins without a step
// Tried: a reversal 32 to 184 ms after a goal: 0.003 N m (taken for a sample of one motion: 4.8 N m)

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "skinctl/control/impedance.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const auto robot = test_robot<Interface::position, double>({});
constexpr double turned = 0.8;  // of the first joint, at the goal [rad]

JointPosition<6> on_the_way(double share) {
  auto q = home_position();
  q[0] += turned * share;
  return q;
}
Transform<Base, Tool> tool(double share) {
  return link_poses(ur5::Model{}, on_the_way(share)).get<5>() * Transform<Link<5>, Tool>();
}

/// A scene and its stiff joints, at 125 Hz.
template <class L>
class Run {
 public:
  explicit Run(const L& law)
      : scene_(robot, law),
        memory_(scene_.start({0ns, home_position(), {}})),
        joints_(home_position(), 8ms, 0ns) {}

  auto step() {
    input_.now = input_.now + 8ms;
    input_.measured = joints_.run_to(input_.now);
    const auto out = scene_.step(memory_, input_);
    joints_.command(input_.now, out.command.position);
    input_.goal.reset();
    return out.planned;
  }
  void send(const typename L::Goal& goal) { input_.goal = goal; }
  double time() const { return seconds<double>(input_.now); }

 private:
  Cycle<detail::ResolverFor<std::remove_const_t<decltype(robot)>>, L> scene_;
  typename decltype(scene_)::Memory memory_;
  typename decltype(scene_)::Input input_;
  StiffJoints<> joints_;
};

/// @param goal_at  goal at a share of the way.
template <class L, class GoalAt>
void check_same(const L& law, const GoalAt& goal_at) {
  Run<L> once(law), always(law);
  once.send(goal_at(1.0));
  int different = 0;
  for (int k = 0; k < 1000; ++k) {
    always.send(goal_at(1.0));
    const auto a = once.step(), b = always.step();
    different += a.position == b.position && a.velocity == b.velocity ? 0 : 1;
  }
  CHECK(different == 0);
}

/// The goal moves for two seconds, then stands.
template <class L, class GoalAt>
void check_moving(const L& law, const GoalAt& goal_at, double lag, double error) {
  Run<L> run(law);
  double largest_lag = 0, fastest = 0;
  JointPosition<6> last;
  while (run.time() < 8) {
    const double share = std::fmin(run.time() / 2, 1.0);
    run.send(goal_at(share));
    const auto planned = run.step();
    last = planned.position;
    largest_lag = std::fmax(largest_lag, std::fabs(last[0] - on_the_way(share)[0]));
    fastest = std::fmax(fastest, std::fabs(planned.velocity[0]));
  }
  CHECK(largest_lag < lag);
  CHECK(fastest < 1.0);
  CHECK(std::fabs(last[0] - on_the_way(1)[0]) < error);
}

JointImpedance<6> springs() {
  JointImpedance<6>::Settings s;
  s.space = tracking_settings(robot);
  s.stiffness.fill(150), s.damping.fill(50);
  return JointImpedance<6>(s);
}
auto to_joints(Nanoseconds duration) {
  return [duration](double share) { return JointGoal<6>{on_the_way(share), duration}; };
}
auto to_pose(Nanoseconds duration) {
  return [duration](double share) { return PoseGoal<Tool>{tool(share), duration}; };
}
const auto target = [](double share) { return JointReference<6>{on_the_way(share), {}, {}}; };

/// The planned motion of an arm that does what it is told, with a goal in the first cycle or in each. It is
/// touched, stopped on the way and resumed.
template <Interface I>
std::vector<JointPosition<6>> touched_and_stopped(bool always) {
  const SceneSettings settings{.decay = I == Interface::torque ? 0.0 : 6.0, .force_gain = 300};
  const auto scene = make_scene<I, 260, double>(
      SplineJoint<6>(test_robot<I, double>(settings)) + SkinJointControl{} + GravityControl{}, settings);
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> now{0ns, home_position(), {}};
  scene.start(*memory, now);
  std::vector<JointPosition<6>> way;
  for (int k = 1; k <= 900; ++k) {
    typename Scene::Input input;
    input.now = now.time = k * 8ms;
    input.measured = now;
    if (always || k == 1) input.goal = {on_the_way(1), 2s};
    if (k == 60) input.request = CycleRequest::stop;
    if (k == 120) input.request = CycleRequest::resume;
    const float force = (k > 150 && k < 220) || (k > 500 && k < 560) ? 0.4f : 0.f;
    const CellSample touch{.time = input.now, .cell = 100, .force = {force, force, force}};
    input.samples = {&touch, 1};
    const auto planned = scene.step(*memory, input).planned;
    if constexpr (I == Interface::torque) {
      now = simulate(ur5::Model{}, now, planned.torque, 0.008, 8);
    } else {
      now.q = planned.position, now.dq = planned.velocity;
    }
    way.push_back(now.q);
  }
  return way;
}
template <Interface I>
void check_touched_and_stopped() {
  const auto once = touched_and_stopped<I>(false), always = touched_and_stopped<I>(true);
  CHECK(once == always);
  CHECK(std::fabs(once.back()[0] - on_the_way(1)[0]) < 0.05);
  double aside = 0;
  for (const auto& q : once) aside = std::fmax(aside, std::fabs(q[1] - home_position()[1]));
  CHECK(aside > 0.01);
}

}  // namespace

TEST_CASE("streamed goals: the same one in each cycle, touched, stopped and resumed, by each interface") {
  check_touched_and_stopped<Interface::position>();
  check_touched_and_stopped<Interface::velocity>();
  check_touched_and_stopped<Interface::torque>();
}

TEST_CASE("streamed goals: the same one in each cycle gives the commands of one that was sent once") {
  check_same(SplineJoint<6>(robot), to_joints(2s));
  check_same(SplineJoint<6>(robot), to_joints(0s));
  check_same(SplineOperational<6, 5>(robot, Transform<Link<5>, Tool>()), to_pose(2s));
  check_same(SplineOperational<6, 5>(robot, Transform<Link<5>, Tool>()), to_pose(0s));
  check_same(springs(), to_joints(2s));
}

TEST_CASE("streamed goals: one that moves slowly is followed") {
  check_moving(SplineJoint<6>(robot), to_joints(0s), 0.4, 1e-3);
  check_moving(SplineJoint<6>(robot), to_joints(1s), 0.4, 1e-3);
  check_moving(SplineOperational<6, 5>(robot, Transform<Link<5>, Tool>()), to_pose(0s), 0.5, 1e-3);
  check_moving(springs(), to_joints(0s), 0.4, 2e-2);
  check_moving(JointControl<6>(robot), target, 0.2, 1e-3);
}

TEST_CASE("streamed goals: a goal long after the last one is planned anew from where the robot is") {
  using L = SplineJoint<6>;
  Run<L> run{L(robot)};
  run.send({on_the_way(1), 1s});
  while (run.time() < 4) run.step();
  run.send({on_the_way(0), 1s});
  double peak = 0;
  while (run.time() < 5) peak = std::fmax(peak, std::fabs(run.step().velocity[0]));
  CHECK(peak > 0.8 * 1.875 * turned / 1.5);
  run.send({on_the_way(1), 1s});
  while (run.time() < 9) peak = std::fabs(run.step().position[0] - on_the_way(1)[0]);
  CHECK(peak < 1e-3);
}

TEST_CASE("streamed goals: one far away, soon after the last one, is a new goal: the torque has no step") {
  using Robot = Quantities<ur5::Model, SplineJoint<6>::needs>;
  const SplineJoint<6> law(robot);
  const double dt = 0.008;
  double largest_step = 0;
  for (int cycles = 4; cycles < 24; ++cycles) {
    State<6> x{0ns, home_position(), {}};
    const auto known = [&] { return Robot(ur5::Model{}, x, dt, NoTouch{}); };
    auto memory = law.start(known());
    memory = law.receive(memory, known(), {on_the_way(0.5), 1s}).memory;
    for (int k = 0; k < cycles; ++k) {
      const auto out = evaluate(law, memory, known(), dt);
      memory = out.memory;
      x = simulate(ur5::Model{}, x, out.torque + gravity_torque(ur5::Model{}, x.q), dt, 4);
    }
    const auto before = law.torque(memory, known());
    const auto after = law.torque(law.follow(memory, known(), {on_the_way(-0.5), 600ms}).memory, known());
    for (std::size_t i = 0; i < 6; ++i)
      largest_step = std::fmax(largest_step, std::fabs(after[i] - before[i]));
  }
  CHECK(largest_step < 0.1);
  MESSAGE("a step of ", largest_step, " N m");
}
