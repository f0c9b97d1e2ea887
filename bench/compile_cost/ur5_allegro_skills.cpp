// The ten skills of ur5_skills.cpp for an arm with a hand: 22 joints, a patch on each link of the arm but the
// first, and on the last links of the fingers. Nine tenths are code generation: SKINCTL_NO_FORCED_INLINE
// takes more than half of it away, where the loop has the time.
#include "skinctl/control/force_control.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/robots/ur5_allegro.hpp"
#include "skinctl/skills/library.hpp"
#include "skinctl/tactile/skin.hpp"

using namespace skinctl;

using ArmWithHand = ur5_allegro::Model<>;
template <std::size_t I, std::size_t N>
Patch<I, N> patch(std::uint32_t first) {
  std::vector<PlacedCell<I>> cells;
  for (std::size_t k = 0; k < N; ++k)
    cells.push_back({first + static_cast<std::uint32_t>(k),
                     Transform<Link<I>, Cell>::translation_xyz(0.01 * static_cast<double>(k), 0, 0.05)});
  return Patch<I, N>(cells, {.force = 20});
}
auto make_cycle() {
  const JointLimits<22> limits({.lower = JointPosition<22>::constant(-3),
                                .upper = JointPosition<22>::constant(3),
                                .velocity = JointVelocity<22>::constant(3),
                                .acceleration = JointAcceleration<22>::constant(15),
                                .torque = JointTorque<22>::constant(28)});
  const auto arm = by_position(ur5_allegro::arm_with_hand(),
                               {.limits = limits, .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  const auto tool = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1);
  const Skin<ArmWithHand, double, Patch<1, 60>, Patch<2, 60>, Patch<3, 20>, Patch<4, 20>, Patch<5, 20>,
             Patch<9, 4>, Patch<13, 4>, Patch<17, 4>, Patch<21, 4>>
      skin(patch<1, 60>(1), patch<2, 60>(61), patch<3, 20>(121), patch<4, 20>(141), patch<5, 20>(161),
           patch<9, 4>(181), patch<13, 4>(185), patch<17, 4>(189), patch<21, 4>(193));
  const auto skills = skill_set<behaviour::KinestheticJoint>(
      boost::hana::union_(figure_7, section_6), {}, skill_controller<controller::Gravity>(GravityControl{}),
      skill_controller<controller::SkinJoint>(SkinJointControl{}),
      skill_controller<controller::SkinCartesian>(SkinCartesianControl<5>(tool)),
      skill_controller<controller::Joint>(JointControl(arm)),
      skill_controller<controller::SplineJoint>(SplineJoint(arm)),
      skill_controller<controller::Operational>(OperationalControl(arm, tool)),
      skill_controller<controller::SplineOperational>(SplineOperational(arm, tool)),
      skill_controller<controller::Force>(ForceControl(arm, tool)));
  static_assert(decltype(skills)::skills == 10);
  return Cycle(arm, skin, skills);
}

int main() {
  const auto cycle = make_cycle();
  auto memory = cycle.start(State<22>{});
  decltype(cycle)::Input input;
  return static_cast<int>(cycle.step(memory, input).command.position[0]);
}
