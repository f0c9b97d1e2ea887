// budget over ur5_cycle_spline: 5 s 200 MB
#include "skinctl/control/force_control.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/skills/library.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

using namespace skinctl;

// The scene of ur5_cycle_spline.cpp with all ten skills of Fig. 7 and section 6: at most 0.5 s a skill. Most
// of it are the eight controllers; a skill more of them costs some hundredths of a second.
auto make_cycle() {
  const auto limits = limits_of<ur5::Description>(15.0);
  const auto tool = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1);
  const OperationalSettings<6> settings;
  const OperationalSpace<6, 5> space(tool, settings);
  const auto skills = skill_set<behaviour::KinestheticJoint>(
      boost::hana::union_(figure_7, section_6), {}, as<controller::Gravity>(GravityControl{}),
      as<controller::SkinJoint>(SkinJointControl{}),
      as<controller::SkinCartesian>(SkinCartesianControl<5>(tool)), as<controller::Joint>(JointControl<6>()),
      as<controller::SplineJoint>(SplineJoint<6>()),
      as<controller::Operational>(OperationalControl<6, 5>(space, settings)),
      as<controller::SplineOperational>(SplineOperational<6, 5>(space, settings)),
      as<controller::Force>(ForceControl<6, 5>(tool)));
  static_assert(decltype(skills)::skills == 10);
  return Cycle(Resolver<Interface::position, ur5::Model>(
                   ur5::Model{}, ResolverConfiguration<6>{.limits = limits, .period = 8_ms, .delay = 8_ms}),
               skills, ur5_skin<260>({.force = 20}),
               Guard<Interface::position, 6>({.limits = limits, .period = 8_ms}));
}

int main() {
  const auto cycle = make_cycle();
  auto memory = cycle.start(State<6>{});
  decltype(cycle)::Input input;
  return static_cast<int>(cycle.step(memory, input).command.position[0]);
}
