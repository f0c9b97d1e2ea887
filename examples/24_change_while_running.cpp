// 24 Payload and gains change while the arm runs: configurations of one scene; the input selects one.
//
//   0      without payload
//   1      with a payload of 3 kg
//   2      without payload, with a third of the gains
//   tau    spline joint control, eqs. (8)-(14), with G(q): the command of a simulated UR5 by torque
//   drawn  deflection of joint 1, and its torque, with the changes of configuration and without
//
// The arm holds its pose. The payload is there from 1 s to 3 s; a hand pushes at 4 s and at 6 s.
#include <algorithm>

#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/configurations.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/recording/recording.hpp"
#include "support/arm.hpp"

using namespace examples;

using Carrier = Loaded<ur5::Model, 5>;
constexpr LinkInertia part{.mass = 3, .c = {0, 0, 0.1}, .xx = 0.01, .yy = 0.01, .zz = 0.01};

// Rotors of the motors, seen at the joints [kg m^2]. They bound how much lighter the wrist is without the payload, for
// which the gains have to be small enough.
const JointTorque<6> rotors = JointTorque<6>::constant(0.1);

auto scene(const LinkInertia& load, double share_of_gains) {
  const auto arm =
      by_torque(Carrier(ur5::Model{}, load),
                {.limits = limits_of<ur5::Description>(15.0), .period = 2ms, .virtual_inertia = rotors},
                RobotCompensatesFriction{});
  auto gains = tracking_settings(arm);
  gains.lambda = 30 * share_of_gains;
  return Cycle(arm, SplineJoint<6>(gains));
}

// The real arm, with the share `weight` of the payload.
struct SimulatedArm {
  State<6> robot{{}, home, {}};
  Carrier arm{ur5::Model{}};

  void move(const JointTorque<6>& sent, double weight, double push) {
    auto load = part;
    for (double* x : {&load.mass, &load.xx, &load.yy, &load.zz}) *x *= weight;
    arm.carry(load);
    auto tau = sent;
    tau[1] += push;
    for (int k = 0; k < 8; ++k) {
      auto mass = mass_matrix(arm, robot.q);
      for (std::size_t i = 0; i < 6; ++i) mass(i, i) += rotors[i];
      const auto drives = tau - inverse_dynamics(arm, robot.q, robot.dq, JointAcceleration<6>{});
      JointAcceleration<6> ddq;
      math::Ldlt<6>(mass.data).solve(drives.data, ddq.data);
      robot.dq = integrate(robot.dq, ddq, 0.00025);
      robot.q = integrate(robot.q, robot.dq, 0.00025);
    }
    robot.time += 2ms;
  }
};

template <class C>
double run(const C& cycle, bool told, Curve& bent, Curve& torque, Curve& carried, Recording<C>& recording) {
  SimulatedArm world;
  auto memory = std::make_unique<typename C::Memory>();
  cycle.start(*memory, world.robot);
  recording.start(world.robot);
  JointTorque<6> sent = memory->robot.command().torque;
  double step = 0;  // largest step of the torque in a cycle around a change [N m]
  typename C::Input input;
  for (double t = 0.002; t < 8; t += 0.002) {
    const double weight = std::clamp((t - 1) / 0.1, 0.0, 1.0) - std::clamp((t - 3) / 0.1, 0.0, 1.0);
    const bool pushed = (t > 4 && t < 4.5) || (t > 6 && t < 6.5);
    world.move(sent, weight, pushed ? 20 : 0);
    input.now = world.robot.time;
    input.measured = world.robot;
    if (told) input.configuration = t > 1 && t < 3 ? 1 : t > 5 ? 2 : 0;
    const auto out = cycle.step(*memory, input);
    recording.add(input, out.planned);
    if ((t > 1 && t < 1.2) || (t > 3 && t < 3.2) || (t > 5 && t < 5.2))
      step = std::max(step, std::abs(out.command.torque[1] - sent[1]));
    sent = out.command.torque;
    bent.add(t, 1e3 * (world.robot.q[1] - home[1]));
    torque.add(t, sent[1]);
    carried.add(t, weight);
  }
  return step;
}

int main(int argc, char** argv) {
  const Configurations cycle(scene({}, 1), scene(part, 1), scene({}, 1.0 / 3));
  Recording<std::remove_cv_t<decltype(cycle)>> recording(std::size_t(8) << 20), other = recording;
  Curve bent{"told"}, torque = bent, carried{"carries 3 kg"};
  Curve bent_untold{.name = "not told", .dashed = true}, torque_untold = bent_untold, again = carried;
  const double step = run(cycle, true, bent, torque, carried, recording);
  run(cycle, false, bent_untold, torque_untold, again, other);
  const auto most = [](const Curve& c, double from, double to) {
    double x = 0;
    for (std::size_t k = 0; k < c.t.size(); ++k)
      if (c.t[k] > from && c.t[k] < to) x = std::max(x, std::abs(c.y[k]));
    return x;
  };
  const double sag = most(bent, 1, 3), sag_untold = most(bent_untold, 1, 3);
  const double stiff = most(bent, 4, 5), soft = most(bent, 6, 8);
  const auto replayed = replay(cycle, recording);
  std::printf("sags by %.1f mrad, not told by %.1f; pushed by %.1f mrad, with lower gains by %.1f\n", sag,
              sag_untold, stiff, soft);
  std::printf("the torque changes by at most %.2f N m a cycle; replayed %d cycles, %d different\n", step,
              int(replayed.cycles), int(replayed.different));
  return draw(argc, argv, "24_change_while_running.svg", "Payload and gains change while the arm runs",
              {{"joint 1 gives way [mrad]", {bent, bent_untold}},
               Panel("torque of joint 1 [N m]", {torque, torque_untold}).close_up()},
              while_above_zero(carried, "carries 3 kg")) ||
         replayed.different != 0 || sag > 0.5 * sag_untold || soft < 2 * stiff;
}
