// 09 A reactive target: a camera sees a part at 5 Hz; the target jumps with every image, the tool does not.
//
//   tau = tau_op + tau_skin + G(q)
//
//   tau_op    operational control, eqs. (15)-(21), of a reference that follows the target within v, a, j
//   X_BP      pose of the target, from a sensor at any rate
//   v, a, j   limits of speed, acceleration and jerk
#include "skinctl/control/reactive_control.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  auto settings = operational_settings(robot);
  settings.max_linear_velocity = 0.25;   // [m/s]
  settings.max_linear_acceleration = 1;  // [m/s^2]
  settings.max_linear_jerk = 10;         // [m/s^3]
  const ReactiveOperational<6, 5> follow(tool_on_flange, settings);
  Arm arm(follow + SkinJointControl{} + GravityControl{});
  Curve seen{.name = "target as the camera sees it", .dashed = true}, tool{"tool"},
      speed{"speed of the tool [m/s]"};
  const auto start = arm.tool();
  Xyz<double> p = start.origin(), last = p;
  double fastest = 0, noise = 0.5;
  for (int k = 0; arm.time() < 8; ++k) {
    if (k % 25 == 0) {
      noise = 3.9 * noise * (1 - noise);  // pseudo-random noise of the camera, a logistic map
      const double jump = arm.time() > 4 ? 0.1 : 0;
      p = start.origin() + Xyz<double>{0, 0.06 * std::sin(arm.time()) + jump, 0.004 * noise};
      arm.ask(PoseReference<Tool>{{start.axes(), p}, {}, {}});
    }
    arm.step();
    const auto now = arm.tool().origin();
    const double v = norm(Xyz<double>(now - last)) / 0.008;
    seen.add(arm.time(), p.y), tool.add(arm.time(), now.y), speed.add(arm.time(), v);
    if (k > 0) fastest = std::fmax(fastest, v);
    last = now;
  }
  std::printf("fastest %.3f m/s\n", fastest);
  return draw(argc, argv, "09_reactive_target.svg", "The target jumps, the tool does not",
              {{"y in the base's frame [m]", {seen, tool}}, {speed, {0.25, "limit"}}}, {}, arm.sketch()) ||
         fastest > 0.3;
}
