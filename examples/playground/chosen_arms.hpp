// From a choice to the arms of one sense.
#pragma once

#include "examples/playground/arms.hpp"

namespace playground {

/// The settings of a choice, by one interface and one sense.
template <class Job>
std::unique_ptr<Arms> arms_by(const Job& robot, job::Settings s, const Choice& c, const job::PerJoint& q) {
  using skinctl::Interface;
  s.interface = Job::interface;
  s.sense = Job::sense;
  s.rate = Job::interface == Interface::torque || Job::sense != job::Sense::skin ? 500 : 125;
  s.rigid = c.feeling == 0;
  s.control.decay = c.damping;
  s.control.delay = 1e-3 * c.delay;
  s.control.lag = 1e-3 * c.declared_lag;
  if constexpr (Job::interface != Interface::torque)
    if (c.felt_mass > 0) s.control.heavier_than_needed = std::max(1.0, c.felt_mass / robot.felt_mass(s));
  return std::make_unique<ArmsBy<Job>>(robot, s, c, q);
}
template <job::Sense S>
std::unique_ptr<Arms> arms_without_torque(const job::Settings& s, const Choice& c, const job::PerJoint& q) {
  using skinctl::Interface;
  return c.interface == 0 ? arms_by(UrJob<Interface::position, S>{}, s, c, q)
                          : arms_by(UrJob<Interface::velocity, S>{}, s, c, q);
}

}  // namespace playground
