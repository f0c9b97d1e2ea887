// What the page calls: functions over the flat structs of `playground.hpp`.
#include "examples/playground/playground.hpp"

#include <algorithm>

#include "skinctl/core/contract.hpp"

namespace playground {

namespace {

/// The settings of the main job. Throws `skinctl::ConfigurationError` for a choice out of range.
compliant_ur5::Settings settings(const Scenario& n, const Choice& c) {
  using skinctl::require;
  const auto one_of = [](double x, int count) { return x >= 0 && x < count && x == static_cast<int>(x); };
  require(one_of(c.feeling, 4), "feeling", c.feeling, "0, 1, 2, 3");
  require(one_of(c.interface, 3), "interface", c.interface, "0, 1, 2");
  require(c.interface < 2 || c.feeling < 2, "interface torque", c.interface, "with the skin");
  require(c.felt_mass >= 0 && c.felt_mass <= 1000, "felt mass", c.felt_mass, "0 to 1000 kg");
  require(c.damping >= 0 && c.damping <= 50, "damping", c.damping, "0 to 50 1/s");
  require(c.delay >= 0 && c.delay <= 100, "delay", c.delay, "0 to 100 ms");
  require(c.declared_lag >= 0 && c.declared_lag <= 100, "declared lag", c.declared_lag, "0 to 100 ms");
  require(c.real_lag >= 0 && c.real_lag <= 100, "lag", c.real_lag, "0 to 100 ms");
  compliant_ur5::Settings s;
  s.control = n.control, s.torque = n.torque, s.wrist = n.wrist, s.motors = n.motors;
  s.newtons_per_reading = n.newtons_per_reading, s.rest_reading = n.rest_reading,
  s.force_delta = n.force_delta;
  for (const auto& place : n.places) s.task.push_back({.at = 0, .q = place, .duration = 0});
  return s;
}

}  // namespace

std::unique_ptr<Arms> make_arms(const Scenario& n, const Choice& c, const compliant_ur5::PerJoint& q) {
  const compliant_ur5::Settings s = settings(n, c);
  if (c.feeling == 2) return arms_by_wrist(s, c, q);
  if (c.feeling == 3) return arms_by_motors(s, c, q);
  return arms_by_skin(s, c, q);
}
std::unique_ptr<Arms> make_arms(const Scenario& n, const Choice& c, const Robot& robot,
                                const compliant_ur5::PerJoint* q) {
  skinctl::require(c.feeling < 2 && c.interface < 2, "feeling or interface of an own robot",
                   std::max(c.feeling, c.interface), "0 or 1: its skin, by position and velocity");
  return arms_of_own_robot(settings(n, c), c, robot, q);
}

}  // namespace playground

namespace {

using namespace playground;

struct {
  Scenario scenario;
  Choice choice;
  Robot robot;
  bool begins = true;  ///< another robot than that of the arms
  View view;
  double press[6] = {}, cell[7] = {};
  std::unique_ptr<Arms> arms;
  Finger finger;  ///< while there is no arm
} all;

}  // namespace

// Indices that come from a page are checked; a number that is refused throws, which ends the module.
extern "C" {

Scenario* playground_scenario() {
  return &all.scenario;
}
Choice* playground_choice() {
  return &all.choice;
}
/// The robot of the next start, which begins at its task.
Robot* playground_robot() {
  all.begins = true;
  return &all.robot;
}
/// Anew by the present choice, where the arm stands.
void playground_start() {
  compliant_ur5::PerJoint q = all.scenario.places.back();
  if (!all.begins) std::copy_n(all.view.q, q.size(), q.begin());
  all.arms.reset();
  all.arms = all.robot.given > 0 ? make_arms(all.scenario, all.choice, all.robot, all.begins ? nullptr : &q)
                                 : make_arms(all.scenario, all.choice, q);
  all.begins = false;
  all.view = View{};
  all.arms->cycle(all.view);
}
Finger* playground_finger() {
  return all.arms ? &all.arms->finger : &all.finger;
}
View* playground_view() {
  return &all.view;
}
/// Point and normal in the frame of a link, for `playground_press`.
double* playground_place() {
  return all.press;
}
void playground_press(std::size_t link) {
  if (all.arms) all.arms->press(link, all.press, all.press + 3);
}
void playground_release() {
  if (all.arms) all.arms->release();
}
void playground_hurt(int on) {
  if (all.arms) all.arms->hurt(on != 0);
}
void playground_cycle(int count) {
  for (int k = 0; all.arms && k < count; ++k) all.arms->cycle(all.view);
}
const char* playground_words() {
  return all.arms ? all.arms->words() : "";
}
/// Of link `i`: radius, and the two ends of its tube in its frame [m].
const double* playground_tube(std::size_t i) {
  if (all.arms && i < Robot::joints) {
    const auto t = all.arms->tube(i);
    std::copy(t.begin(), t.end(), all.cell);
  }
  return all.cell;
}
/// Of cell `i`: link, place, normal.
const double* playground_cell(std::size_t i) {
  if (all.arms && i < static_cast<std::size_t>(all.view.cells)) {
    const auto c = all.arms->cell(i);
    std::copy(c.begin(), c.end(), all.cell);
  }
  return all.cell;
}
}
