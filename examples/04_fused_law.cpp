// 04 A fused law: one expression moves an arm to a goal, yields to a push and compensates gravity.
//
//   law     sum of three laws, eq. (23): gravity enters once, tracking weights are normalised
//   known   the state and the quantities computed from it
//   now     torque of the sum, each law's share, and the next memory
#include <cstdio>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;

int main() {
  const ur5::Model robot;
  JointControlSettings<6> settings;
  settings.lambda = 20;
  settings.K_c = 4;
  settings.tb = 0s;
  const auto law = SplineJoint<6>(settings) + SkinJointControl{} + GravityControl{};
  using Law = std::remove_cvref_t<decltype(law)>;
  using Touch = Ur5Skin<260>::Wrenches;
  using Known = Quantities<ur5::Model, Law::needs, double, Touch>;

  State<6> state;
  state.q = {0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  const double h = 0.002;
  Touch touch;
  auto memory = law.start(Known(robot, state, h, touch));
  auto goal = JointGoal<6>{state.q, 2s};
  goal.q_g[0] = 0.6;
  memory = law.receive(memory, Known(robot, state, h, touch), goal).memory;

  std::printf("   t    q0     spline    skin   gravity [N m, joint 1]\n");
  for (int k = 0; k <= 2000; ++k) {
    // A steady push on the forearm from 1.0 to 1.5 s, as a wrench on the link.
    const bool pushed = k >= 500 && k < 750;
    touch.set<2>(pushed ? Wrench<Link<2>, Link<2>>{{0, -15, 0}, {0, 0, 3}} : Wrench<Link<2>, Link<2>>{});
    const auto now = evaluate(law, memory, Known(robot, state, h, touch), h);
    if (k % 200 == 0)
      std::printf("%5.2f %6.3f %8.2f %8.2f %8.2f%s\n", h * k, state.q[0], now.shares[0][1], now.shares[1][1],
                  now.shares[2][1], pushed ? "   pushed" : "");
    const auto ddq = forward_dynamics(robot, state.q, state.dq, now.torque).acceleration;
    state.dq = integrate(state.dq, ddq, h);
    state.q = integrate(state.q, state.dq, h);
    memory = now.memory;
  }
  std::printf("goal reached to %.4f rad\n", std::abs(state.q[0] - 0.6));
  return std::abs(state.q[0] - 0.6) < 0.01 ? 0 : 1;
}
