// The controllers of the paper's section 6 for the arm of the examples, as a set of skills.
#pragma once

#include "arm.hpp"
#include "skinctl/control/force_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/skills/library.hpp"

namespace examples {

/// Reaching, Putting, Squeezing => force control; `tool` is the frame that they move. It begins led by the
/// hand.
inline auto packing_skills(const Transform<Link<5>, Tool>& tool = tool_on_flange) {
  auto force = force_settings(robot);
  force.carried = 1;  // the world pushes the skin of the very arm that presses
  return skill_set<behaviour::KinestheticJoint>(
      boost::hana::union_(figure_7, section_6), {}, skill_controller<controller::Gravity>(GravityControl{}),
      skill_controller<controller::SkinJoint>(SkinJointControl{}),
      skill_controller<controller::SplineJoint>(SplineJoint(robot)),
      skill_controller<controller::SplineOperational>(SplineOperational(robot, tool)),
      skill_controller<controller::Force>(ForceControl<6, 5>(tool, force)));
}

}  // namespace examples
