// 22 Your robot, your skin, by torque: the arm of 21 as a header that urdf_to_model wrote during the build.
//
//   arm7::Model              static: zeros, ones and topology are types
//   arm7::X_LN<"hand_link">  pose of the file's link in the model; an unknown name does not compile
//   tau                      torque of skin and gravity, the command; the finger pushes the simulated arm too
//   drawn                    displacement of the touched cell along the finger's direction [mm]
#include <cstdio>
#include <string>

#include "arm7.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/tactile/named_patch.hpp"
#include "skinctl/tactile/skin.hpp"

using namespace skinctl;

constexpr double newtons_per_reading = 20;
constexpr Rotation<double> looks_along_x{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};

const Transform<NamedFrame<"forearm_link">, Cell> X_NC(looks_along_x, {-0.03, 0.13, 0});

auto make_skin() {
  const auto forearm =
      patch_on<arm7::Description, "forearm_link">({{1, X_NC}}, {.force = newtons_per_reading});
  const auto hand = patch_on<arm7::Description, "hand_link">(
      {{2, Transform<NamedFrame<"hand_link">, Cell>::translation_xyz(0, 0.03, 0.066)}},
      {.force = newtons_per_reading});
  return Skin<arm7::Model, double, Patch<3, 1>, Patch<6, 1>>(forearm, hand);
}

auto make_cycle() {
  const auto arm = by_torque(arm7::Model{},
                             {.limits = limits_of<arm7::Description>(/*acceleration*/ 10.0),
                              .period = 1ms,
                              .delay = 2ms,
                              .viscous_friction = JointTorque<7>::constant(6)},  // brings the arm to rest
                             RobotCompensatesFriction{});
  return Cycle(arm, make_skin(), SkinJointControl{} + GravityControl{});
}

int main() {
  const auto cycle = make_cycle();
  const arm7::Model model;
  const auto X_LC = arm7::X_LN<"forearm_link"> * X_NC;
  State<7> real;
  real.q = {0.0, -0.4, 0.0, -2.0, 0.0, 1.7, 0.0};
  const auto before = link_poses(model, real.q).get<3>() * X_LC;
  auto memory = cycle.start(real);

  double yielded = 0, first = 0;
  for (int k = 1; k <= 4000; ++k) {
    real.time += 1ms;
    const double newtons = k <= 1000 ? 8 : 0;  // a finger for a second
    const auto f = static_cast<float>(newtons / (3 * newtons_per_reading));
    const CellSample sample{.time = real.time - 1ms, .cell = 1, .force = {f, f, f}};
    decltype(cycle)::Input input;
    input.now = real.time;
    input.measured = real;
    input.samples = {&sample, 1};
    const auto tau = cycle.step(memory, input).command.torque;

    const auto poses = link_poses(model, real.q);
    const auto cell = poses.get<3>() * X_LC;
    const Wrench<Cell, Cell, Base> finger{-newtons * cell.axis_z(), {0, 0, 0}};
    const auto push = transpose(jacobian<3>(poses, X_LC)) * finger;
    const auto ddq = forward_dynamics(model, real.q, real.dq, tau + push).acceleration;
    for (std::size_t i = 0; i < 7; ++i) real.dq[i] += 0.001 * ddq[i];
    real.q = integrate(real.q, real.dq, 0.001);

    yielded = -dot(cell.origin() - before.origin(), before.axis_z());
    if (k == 20) first = yielded;
    if (k % 200 == 0)
      std::printf("%5.2f s %s %s* %4.0f mm\n", 0.001 * k, newtons > 0 ? "pressed" : "       ",
                  std::string(static_cast<std::size_t>(std::max(0.0, 200 * yielded)), ' ').c_str(),
                  1e3 * yielded);
  }
  double speed = 0;
  for (const double v : real.dq) speed = std::max(speed, std::abs(v));
  std::printf("the forearm gave way by %.0f mm; at rest: %.1e rad/s\n", 1e3 * yielded, speed);
  return first > 0 && yielded > 0.01 && speed < 0.02 ? 0 : 1;
}
