// 25 A wrist sensor: an arm without skin is led at its tool, which weighs 1 kg and is no touch.
//
//   w      reading of the sensor: the wrench of the world on the tool, weight included [N], [N m]
//   F      what is left of its force without the tool's weight, behind a dead band of 2 N [N]
//   tau    J' F + G(q): the arm as 5 kg with a friction of 50 N s/m at its tool
//   drawn  the hand's force, what the sensor reads, the speed of the tool against F / 50, its place
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "support/arm.hpp"

using namespace examples;

namespace {

const auto sensor_on_flange = Transform<Link<5>, ForceSensor>::translation_xyz(0, 0, 0.1);
constexpr double tool_mass = 1, friction = 50, dead_band = 2;
constexpr Xyz<double> tool_centre{0, 0.01, 0.06};

/// 5 kg and 0.3 kg m^2 at the sensor, the same in all directions.
auto arm_by_position() {
  using Shape = ToolShape<5>;
  return by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 0},
      Shape({.X_LT = tool_on_flange,
             .mass = Shape::diagonal({5, 5, 5, 0.3, 0.3, 0.3}),
             .damping = Shape::diagonal({friction, friction, friction, 3, 3, 3})}));
}

/// The simulated sensor with its tool: `push` along the axes of the base, on its origin.
WrenchSample reading(Nanoseconds time, const JointPosition<6>& q, const Xyz<double>& push) {
  const auto R = tool_at(q).axes();
  const Xyz<double> weight = R.transpose() * Xyz<double>{0, 0, -9.81 * tool_mass};
  const Xyz<double> f = R.transpose() * push + weight, m = cross(tool_centre, weight);
  return {time, {f.x, f.y, f.z}, {m.x, m.y, m.z}};
}

}  // namespace

int main(int argc, char** argv) {
  const auto sensor =
      wrist_sensor<5>(ur5::Model{}, {.X_LS = sensor_on_flange, .mass = tool_mass, .centre = tool_centre});
  const Cycle scene(arm_by_position(), sensor, SkinJointControl{} + GravityControl{});
  State<6> measured{0ns, home, {}};
  auto under_way = home;
  const auto memory = std::make_unique<decltype(scene)::Memory>();
  scene.start(*memory, measured);

  Curve hand{"hand"}, sensed{"reading"}, speed{"speed"}, expected{"(F - 2 N) / 50 N s/m"};
  Curve x{"x"}, y{"y"}, z{"z"};
  expected.dashed = true;
  const auto start = tool_at(home).origin();
  double untouched = 0, worst = 0;
  while (measured.time < 6s) {
    measured.time += 8ms;
    const auto before = tool_at(measured.q).origin();
    measured.q = under_way;
    const double t = seconds<double>(measured.time);
    // A hand pulls forwards, then up, then to the side.
    const double F = (t > 1 && t < 2) || (t > 2.5 && t < 3.5) || (t > 4 && t < 5) ? 12 : 0;
    const Xyz<double> push{t < 2.2 ? F : 0, t > 3.8 ? F : 0, t > 2.2 && t < 3.8 ? F : 0};
    const WrenchSample sample = reading(measured.time, measured.q, push);
    decltype(scene)::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.sensed.wrenches = {&sample, 1};
    under_way = scene.step(*memory, input).command.position;

    const auto way = tool_at(measured.q).origin() - before;
    const double v = norm(Xyz<double>(way)) / 0.008, v_expected = (F > 0 ? F - dead_band : 0) / friction;
    hand.add(t, F);
    sensed.add(t, norm(Xyz<double>{sample.force[0], sample.force[1], sample.force[2]}));
    speed.add(t, v);
    expected.add(t, v_expected);
    const Xyz<double> moved = tool_at(measured.q).origin() - start;
    x.add(t, 1e3 * moved.x), y.add(t, 1e3 * moved.y), z.add(t, 1e3 * moved.z);
    if (t < 1) untouched = std::max(untouched, v);
    const double in_push = std::fmod(t - 1, 1.5);
    if (F > 0 && in_push > 0.6) worst = std::max(worst, std::abs(v / v_expected - 1));
  }
  std::printf("untouched: %.1e m/s; led: speed within %.1f %% of (F - 2 N) / 50 N s/m\n", untouched,
              100 * worst);
  return draw(argc, argv, "25_wrist_sensor.svg", "A wrist sensor: an arm without skin is led at its tool",
              {Panel("force [N]", {hand, sensed}), Panel("speed of the tool [m/s]", {speed, expected}),
               Panel("tool moved by [mm]", {x, y, z})},
              while_above_zero(hand, "hand pulls")) ||
         untouched > 1e-9 || worst > 0.05;
}
