// 31 Limits and touches: one fast motion and one push, with each part that a scene can have beside its law.
//
//   q_g     joint 0 goes by 1.2 rad in 0.8 s; a hand pushes on the forearm meanwhile
//   v       largest speed of the tool [m/s];  ddq  largest change of a joint's acceleration [rad/s^3]
//   printed a line for each part: v, ddq, how far the arm came, and what the scene said
#include <cstdio>

#include "skinctl/clearance/own_view_skin.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/tactile/contact_skin.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/touch_sum.hpp"
#include "skinctl/tactile/weighted_skin.hpp"
#include "support/arm.hpp"

using namespace examples;

namespace {

struct Course {
  double speed = 0, jerk = 0, reached = 0;
};
Status of_the_plain_scene;

/// Three seconds of a scene; `prepare` fills what its touch adds to the input.
template <class Scene, class Prepare>
Course run(const char* name, const Scene& scene, const Prepare& prepare) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> measured{0ns, home, {}};
  scene.start(*memory, measured);
  auto under_way = home;
  auto goal = home;
  goal[0] += 1.2;
  Course course;
  Status said;
  JointAcceleration<6> last;
  while (measured.time < 3s) {
    measured.time += 8ms;
    const auto before = measured;
    measured.q = under_way;
    measured.dq =
        JointVelocity<6>::generate([&](std::size_t i) { return (measured.q[i] - before.q[i]) / 0.008; });
    const bool pushed = measured.time > 400ms && measured.time < 600ms;
    const float f = pushed ? 0.2f : 0.f;
    const CellSample sample{
        .time = measured.time, .cell = Arm<GravityControl>::cell<2>().id, .force = {f, f, f}};
    typename Scene::Input input;
    input.now = measured.time;
    input.measured = measured;
    if constexpr (requires { scene.skin().places(); }) input.samples = {&sample, 1};
    if (measured.time == 8ms) input.goal = {goal, 800ms};
    prepare(input, pushed);
    const auto out = scene.step(*memory, input);
    under_way = out.command.position;
    said |= out.status;
    for (std::size_t i = 0; i < 6; ++i) {
      const double a = (measured.dq[i] - before.dq[i]) / 0.008;
      course.jerk = std::max(course.jerk, std::abs(a - last[i]) / 0.008);
      last[i] = a;
    }
    course.speed = std::max(
        course.speed, norm(Xyz<double>(tool_at(measured.q).origin() - tool_at(before.q).origin())) / 0.008);
  }
  course.reached = measured.q[0] - home[0];
  std::printf("%-20s %5.2f m/s %7.0f rad/s^3 %6.3f rad\n", name, course.speed, course.jerk, course.reached);
  if (of_the_plain_scene == Status()) of_the_plain_scene = said;
  said.without(of_the_plain_scene).for_each([](Reason reason) {
    std::printf("%22s%s\n", "", describe(reason));
  });
  return course;
}
template <class Scene>
Course run(const char* name, const Scene& scene) {
  return run(name, scene, [](auto&, bool) {});
}

}  // namespace

int main() {
  const auto law = SplineJoint(robot) + SkinJointControl{} + GravityControl{};
  const ur5::Model model;
  const Cycle plain(robot, skin(), law);
  const Course bare = run("no part", plain);

  // Limits: each is a part, in any order, and says in one line what it cut.
  // One of jerk asks for gains that wait for the acceleration.
  const auto jerk = JointJerk<6>::constant(400);
  const auto patient = SplineJoint<6>(tracking_settings(robot, jerk)) + SkinJointControl{} + GravityControl{};
  const Course smooth = run("MaxJerk", Cycle(robot, skin(), patient).with(MaxJerk{jerk}));
  const Course slow = run("MaxToolSpeed", plain.with(MaxToolSpeed<5>{.speed = 0.25, .reach = 1.2}));
  const LinkContact<2> forearm{
      .region = {.force = 80, .blow = 120, .first = 100ms, .stiffness = 2e4, .mass = 4},
      .reach = 0.5,
      .reaction_time = 20ms};
  const Course careful = run("LinkContact", plain.with(forearm));

  // Energy: a tank pays for the law's work, an observer holds motion into a contact that would give more than
  // came in.
  const EnergyTank<> tank({.start = 4, .max = 5});
  const PassivityObserver<> observer({.start = 1, .max = 5, .stiffness = 3e4});
  const Course paid = run("PassivityObserver", Cycle(ur5_by_position(tank, observer), skin(), law));

  // Touches: what the cells see of the robot itself does not count; patches count as the input says, here not
  // at all; the motors feel a touch where there is no skin.
  const auto cells = skin();
  const OwnView<ur5::Model> view(model, cells.places(),
                                 {{.link = 0, .shape = {{0, 0, 0}, {0, 0, 0.3}, 0.08}}});
  const WeightedSkin weighted(ContactSkin(OwnViewSkin(cells, view)));
  const Course numb = run("WeightedSkin", Cycle(robot, weighted, law),
                          [](auto& input, bool) { input.sensed.patch_weights.force.fill(0); });
  const MotorTouch<ur5::Model> motors(model, {.gates = same_gate(model, EventGate<>::dead_band(2.0))});
  const Course felt = run("MotorTouch", Cycle(robot, motors, law), [&](auto& input, bool pushed) {
    input.sensed.motor_torque = gravity_torque(model, input.measured.q);
    if (pushed) input.sensed.motor_torque[0] += 6;
  });
  const auto arrives = [](const Course& c) { return std::abs(c.reached - 1.2) < 0.02; };
  return !(arrives(bare) && arrives(smooth) && arrives(numb) && smooth.jerk < 401 && slow.speed < 0.251 &&
           careful.speed <= bare.speed && paid.speed > 0 && felt.jerk > bare.jerk / 10);
}
