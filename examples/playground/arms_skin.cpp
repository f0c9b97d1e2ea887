#include "examples/playground/chosen_arms.hpp"

namespace playground {

std::unique_ptr<Arms> arms_by_skin(const job::Settings& s, const Choice& c, const job::PerJoint& q) {
  using skinctl::Interface;
  if (c.interface == 2) return arms_by(UrJob<Interface::torque, job::Sense::skin>{}, s, c, q);
  return arms_without_torque<job::Sense::skin>(s, c, q);
}

}  // namespace playground
