// budget over ur5_cycle_spline: 5 s 200 MB
#include "skinctl/control/force_control.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/skills/library.hpp"

using namespace skinctl;

// The scene of ur5_cycle_spline.cpp with all ten skills of Fig. 7 and section 6: at most 0.5 s a skill. Most
// of it are the eight controllers; a skill more of them costs some hundredths of a second.
auto make_cycle() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  const auto tool = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1);
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
  return Cycle(arm, ur5_skin<260>({.force = 20}), skills);
}

int main() {
  const auto cycle = make_cycle();
  auto memory = cycle.start(State<6>{});
  decltype(cycle)::Input input;
  return static_cast<int>(cycle.step(memory, input).command.position[0]);
}
