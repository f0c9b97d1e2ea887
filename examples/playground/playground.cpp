// What the page calls: functions over the flat structs of `playground.hpp`.
#include "examples/playground/playground.hpp"

#include <algorithm>

#include "skinctl/core/contract.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace playground {

std::unique_ptr<Arms> make_arms(const Scenario& n, const Choice& c, const compliant_ur5::PerJoint& q) {
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
  if (c.feeling == 2) return arms_by_wrist(s, c, q);
  if (c.feeling == 3) return arms_by_motors(s, c, q);
  return arms_by_skin(s, c, q);
}

}  // namespace playground

namespace {

using namespace playground;

struct {
  Scenario scenario;
  Choice choice;
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
/// Anew by the present choice, where the arm stands.
void playground_start() {
  compliant_ur5::PerJoint q = all.scenario.places.back();
  if (all.arms) std::copy_n(all.view.q, q.size(), q.begin());
  all.arms.reset();
  all.arms = make_arms(all.scenario, all.choice, q);
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
  const auto& t = skinctl::ur5::tubes[std::min<std::size_t>(i, 5)];
  const double out[7] = {t.radius, t.from.x, t.from.y, t.from.z, t.to.x, t.to.y, t.to.z};
  std::copy_n(out, 7, all.cell);
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
