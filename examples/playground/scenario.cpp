#include "examples/playground/playground.hpp"
#include "skinctl/core/contract.hpp"

namespace playground {

Scenario read_scenarios(const std::string& with_skin, const std::string& without_skin) {
  compliant_ur5::Settings s, other;
  read_scenario(with_skin, s);
  read_scenario(without_skin, other);
  Scenario out;
  out.control = s.control, out.torque = s.torque;
  out.wrist = other.wrist, out.motors = other.motors;
  out.control.virtual_inertia = other.control.virtual_inertia;  // the skin needs none
  out.newtons_per_reading = s.newtons_per_reading, out.rest_reading = s.rest_reading,
  out.force_delta = s.force_delta;
  skinctl::require(s.task.size() >= out.places.size(), "goals of the scenario",
                   static_cast<double>(s.task.size()), "at least 2");
  for (std::size_t i = 0; i < out.places.size(); ++i) out.places[i] = s.task[i].q;
  return out;
}

}  // namespace playground
