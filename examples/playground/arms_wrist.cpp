#include "examples/playground/chosen_arms.hpp"

namespace playground {

std::unique_ptr<Arms> arms_by_wrist(const job::Settings& s, const Choice& c, const job::PerJoint& q) {
  return arms_without_torque<job::Sense::wrist>(s, c, q);
}

}  // namespace playground
