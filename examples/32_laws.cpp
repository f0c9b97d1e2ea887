// 32 Laws side by side: a tool's task first, and what other laws do with what it leaves.
//
//   reach    Spline Operational Control of the tool's position; ZyzError: the paper's orientation error, eqs.
// (16), (17)
//   beside   a posture in its null space; a second law behind it (task priority); a distance to the joints'
// ends
//   learnt   Adaptive learns a load that the model does not have; FrictionControl gives back what bearings
// take
//   printed  a line for each law: the largest error of the tool or of the joints at the end
#include <cmath>
#include <cstdio>

#include "skinctl/control/friction_control.hpp"
#include "skinctl/control/joint_limits.hpp"
#include "skinctl/control/on_joints.hpp"
#include "skinctl/control/posture.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/fusion/null_space.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/tracking/adaptation.hpp"
#include "support/arm.hpp"

using namespace examples;

namespace {

constexpr double h = 0.002;
const NoTouch untouched;

struct Ends {
  State<6> state;
  double tool = 0;  ///< way between the tool and its goal [m]
};

/// Six seconds of a law on an arm by torque, whose bearings have a friction of `coulomb`.
template <class Law, class Goal, class World>
Ends run(const char* name, const Law& law, const Goal& goal, const Xyz<double>& at, const World& world,
         double coulomb = 0) {
  using Known = Quantities<ur5::Model, Law::needs>;
  const ur5::Model model;
  State<6> state{0ns, home, {}};
  auto memory = law.start(Known(model, state, h, untouched));
  memory = law.receive(memory, Known(model, state, h, untouched), goal).memory;
  for (int k = 0; k < 3000; ++k) {
    const auto now = evaluate(law, memory, Known(model, state, h, untouched), h);
    auto tau = now.torque;
    for (std::size_t i = 0; i < 6; ++i) tau[i] -= coulomb * std::tanh(state.dq[i] / 0.01);
    state.dq = integrate(state.dq, forward_dynamics(world, state.q, state.dq, tau).acceleration, h);
    state.q = integrate(state.q, state.dq, h);
    memory = now.memory;
  }
  const double far = norm(Xyz<double>(tool_at(state.q).origin() - at));
  std::printf("%-28s tool %6.2f mm from its goal, joint 5 at %6.3f rad\n", name, 1e3 * far, state.q[5]);
  return {state, far};
}

}  // namespace

int main() {
  const ur5::Model model;
  OperationalSettings<6> settings{.tracking = {.dt = nanoseconds(h), .tb = 0s}};
  const auto X_BG = tool_at({0.2, -1.1, 1.3, -1.7, -1.4, 0.3});
  const Xyz<double> at = X_BG.origin();
  const PoseGoal<Tool> pose{X_BG, 3s};

  // Orientation by ZYZ angles, as printed in the paper.
  using Zyz = SplineOperational<6, 5, Tool, double, TaskSpace::pose, ZyzError>;
  const Ends zyz = run("ZYZ errors", Zyz(tool_on_flange, settings), pose, at, model);

  // The tool's position leaves three joints' motion free, for a posture, ...
  using Reach =
      SplineOperational<6, 5, Tool, double, TaskSpace::position, RotationVectorError, FreeNullSpace>;
  const Reach reach(tool_on_flange, settings);
  auto posture = home;
  posture[5] = 1;
  const auto posed = reach + NullSpacePosture<6, 5>(tool_on_flange, posture) + GravityControl{};
  const Ends turned = run("a posture in the null space", posed, pose, at, model);
  // ... joints keep away from the ends of their range meanwhile, ...
  JointLimitSettings<6> ends;
  ends.upper[5] = 0.6;
  const Ends inside = run("and JointLimitLaw", posed + JointLimitLaw<6>(ends), pose, at, model);
  // ... and a law behind the task moves what does not move the flange.
  ends.lower[5] = 0.4, ends.upper[5] = 2;
  ends.strength = JointTorque<6>::constant(0.5), ends.damping = JointTorque<6>::constant(0.1);
  const auto behind = task_priority<5>(reach, JointLimitLaw<6>(ends), {.keeps = Keeps::point});
  const Ends kept = run("task_priority", behind, pose, at, model);
  // A tool's law that drives all joints but the last one, which holds its weight only.
  const Ends five = run("on_joints", on_joints<joints_between(0, 5)>(reach), pose, at, model);

  // A load of 3 kg that nobody declared, and bearings that stick.
  const Loaded<ur5::Model, 5> loaded(model, {3, {0, 0, 0.05}, 0.01, 0.01, 0.01});
  const SplineJoint<6> joints(SplineJoint<6>::Settings{.dt = nanoseconds(h), .tb = 0s});
  auto q_g = home;
  q_g[0] += 0.6, q_g[2] -= 0.3;
  const JointGoal<6> there{q_g, 2s};
  const Xyz<double> there_at = tool_at(q_g).origin();
  const Ends heavy = run("a load, not declared", joints, there, there_at, loaded);
  const Ends learnt = run("Adaptive", Adaptive<SplineJoint<6>>(joints, {.bound = deviations(model, 2.0)}),
                          there, there_at, loaded);
  const Ends sticks = run("friction", joints, there, there_at, model, 4);
  JointFriction<6>::Settings stiction;
  stiction.coulomb = JointTorque<6>::constant(4);
  const JointFriction<6> bearings(stiction);
  const Ends eased = run("FrictionControl", joints + FrictionControl<6>(bearings), there, there_at, model, 4);

  return !(zyz.tool < 2e-3 && turned.tool < 5e-3 && std::abs(turned.state.q[5] - 1) < 0.2 &&
           kept.tool < 5e-3 && inside.state.q[5] < 0.6 && kept.state.q[5] > 0.1 && five.tool < 5e-3 &&
           learnt.tool < heavy.tool && eased.tool < sticks.tool + 1e-3);
}
