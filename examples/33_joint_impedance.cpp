// 33 Joint impedance: an arm on springs, such as an iiwa or an FR3, gives way to a touch that its motors feel.
//
//   k       stiffness of the springs by which the robot's own controller holds its joints [N m/rad]
//   q_c     commanded position of joint 0: the virtual robot, which gives way as configured
//   q       its measured position: a push p deflects the springs by p/k beside
//   tau     torque sent beside the positions, which the links take for the motion: springs do not bend for it
//   printed: a push on joint 0 and after it; and what a scene says that takes the same arm for one by position
#include <cmath>
#include <cstdio>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robot/spring.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/testing/impedance_plant.hpp"

using namespace skinctl;

namespace {

const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
const auto stiffness = JointTorque<6>::constant(300);

RobotConfiguration<6> configuration() {
  return {
      .limits = limits_of<ur5::Description>(/*acceleration*/ 15.0),
      .period = 4ms,
      .delay = 6ms,  // 4 ms, and half of the period in which it goes to a new position
      .dead_band = JointPosition<6>::constant(0.05),  // holds a push of 75 N m that is felt wrong by a fifth
  };
}
/// Heavy for a push of the hand, so that its springs show.
auto heavy(RobotConfiguration<6> c) {
  c.virtual_inertia = JointTorque<6>::constant(20);
  c.virtual_damping = 2;
  return c;
}

struct Course {
  double gave_way = 0, deflected = 0, fed = 0;
  Status said;
};

/// Three seconds with a push of 40 N m on joint 0 from 0.5 to 1.3 s.
template <class Robot>
Course run(const Robot& robot, bool print) {
  const ur5::Model model;
  const MotorTouch<ur5::Model> motors(
      model, {.observer = {.rate = 40}, .gates = same_gate(model, EventGate<>::dead_band(1.0))});
  const Cycle scene(robot, motors, SkinJointControl{} + GravityControl{});
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto memory = std::make_unique<typename Scene::Memory>();
  testing::ImpedancePlant<ur5::Model> arm(
      model, {.stiffness = stiffness, .damping_ratio = 0.7, .delay = 0.004, .period = 0.004}, home);
  scene.start(*memory, {0ns, home, {}});
  typename Scene::Input input;
  Course course;
  for (int k = 1; k <= 750; ++k) {
    const double t = 0.004 * k, rise = std::min(std::min(t - 0.5, 1.3 - t) / 0.2, 1.0);
    JointTorque<6> push;
    push[0] = rise > 0 ? 40 * rise : 0;
    arm.push(push);
    arm.run(0.004);
    input.now = k * 4ms;
    input.measured = {input.now, arm.q(), arm.dq()};
    input.sensed.motor_torque = arm.motor_torque();
    const auto out = scene.step(*memory, input);
    ImpedanceCommand<6> sent;
    sent.position = out.command.position;
    if constexpr (Robot::interface == Interface::impedance) sent.torque = out.command.torque;
    arm.command(sent);
    const double q_c = sent.position[0], bent = arm.q()[0] - q_c;
    course.said |= out.status;
    course.gave_way = std::max(course.gave_way, std::abs(q_c - home[0]));
    course.deflected = std::max(course.deflected, bent);
    course.fed = std::max(course.fed, std::abs(sent.torque[0]));
    if (print && k % 50 == 0)
      std::printf("%4.1f s  push %4.0f N m  q_c %6.3f  q %6.3f rad  tau %5.1f N m\n", t, push[0], q_c,
                  arm.q()[0], sent.torque[0]);
  }
  return course;
}
void print(const char* name, const Course& c) {
  std::printf("%-12s gave way by %.3f rad, springs bent by %.3f rad\n", name, c.gave_way, c.deflected);
  c.said.for_each([](Reason reason) { std::printf("%14s%s\n", "", describe(reason)); });
}

}  // namespace

int main() {
  auto springs = heavy(configuration());
  springs.stiffness = stiffness;
  springs.spring_lag = 130ms;  // 1.4 sqrt(2.7 kg m^2 / 300 N m/rad) of joint 0
  const Course soft = run(by_impedance(ur5::Model{}, springs), true);
  const Course stiff = run(by_position(ur5::Model{}, heavy(configuration())), false);
  print("by impedance", soft);
  print("by position", stiff);
  // The deflection is 40/300 = 0.13 rad, as large as the largest lead: by position it is taken for a gap.
  const bool kept = !soft.said.has(Reason::displaced) && !soft.said.has(Reason::blocked);
  return kept && soft.gave_way > 0.05 && soft.deflected > 0.1 && stiff.said.has(Reason::displaced) ? 0 : 1;
}
