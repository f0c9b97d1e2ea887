#include <algorithm>
#include <stdexcept>
#include <string>

#include "examples/packing_oranges/run.hpp"

namespace packing {

WorkSettings by_hand(WorkSettings s) {
  s.hold = 2.5;
  s.max_hold = 4;
  s.lightly = 1.7;
  s.above_near = 0.003;
  s.let_go = 0.015;
  s.aside = 0.04;  // a thumb stands out further than the fingers stand; 10 mm for a bin that is only seen
  s.judge_from = 0.9;
  s.judge_to = 3.4;
  s.judge_span = 1.5;
  s.turns = false;
  const Grasp grasp = around_a_ball();
  s.finger_ways.clear();
  for (std::size_t f = 0; f < 4; ++f)
    if (const auto& way = grasp.away[f]; grasp.takes_part[f] > 0) s.finger_ways.push_back(in_tool(way));
  s.stands_on = 1;  // one fingertip of three stands with 3 N
  s.fingers = {.along = 0.08,
               .across = 0.08,
               .below = 0.015,
               .wall_along = 0.125,
               .wall_across = 0.125,
               .aside = 0.04};
  return s;
}

RunSettings with_binary_grippers(RunSettings s) {
  s.world.binary = true;
  WorkSettings& w = s.work;
  w.presses = true;
  w.hold = w.max_hold = w.lightly = firm_force;
  w.judge_from = 0.7;
  w.judge_to = 4;
  w.judge_span = 1.5;
  w.plan = by_pressing(w.plan, press_border);
  if (const skinctl::TaskFault fault = check(w.plan); fault.any())
    throw std::runtime_error(
        std::string("--gripper binary: step ") + std::to_string(fault.step) + " (" +
        w.plan.steps[fault.step].does->name + "): " + describe(fault.error) +
        (fault.facts.has(firm_below) ? ": what is squeezed must stand on something firm" : ""));
  return s;
}

RunSettings with_tool(RunSettings s, const skinctl::TaughtWays& ways) {
  const auto refuse = [](const char* what, const char* why) {
    throw std::runtime_error(std::string(what) + ": not with a task that uses a tool: " + why);
  };
  if (s.hand[0] || s.hand[1]) refuse("--gripper hand", "three fingertips hold no handle");
  if (s.world.binary || s.work.by_time)
    refuse("--gripper", "only the one that measures its opening is tried");
  if (s.stay) refuse("--stay", "there is one bread for each plate");
  if (s.obstacle > 0) refuse("--obstacle", "an arm that gives way knows nothing of the tool in its hand");
  if (s.detector.ghosts > 0) refuse("--ghosts", "a tool is used over what nobody has touched before");
  if (s.fault == Fault::box_blocked || s.fault == Fault::box_held) refuse("--fault", "there is no box");
  if (s.detector.bias > 0)
    refuse("--bias", "what is taken along its handle does not tell how far the camera is off");
  s.work.ways = ways;
  s.work.turns = false;   // a tool is taken across its handle
  s.work.let_go = 0.003;  // what hangs lower than it was taken
  s.work.in_vain = 6;     // there is one thing to take, not many
  s.supply.oranges = 0;
  if (s.longest == 0) s.longest = 180;
  return s;
}

int Outcome::right() const {
  return static_cast<int>(
      std::count_if(ended.begin(), ended.end(), [](const Packed& p) { return p.right(); }));
}
int Outcome::misjudged() const {
  return static_cast<int>(std::count_if(
      ended.begin(), ended.end(), [](const Packed& p) { return p.end != Packed::End::lost && !p.right(); }));
}
int Outcome::lost() const {
  return static_cast<int>(
      std::count_if(ended.begin(), ended.end(), [](const Packed& p) { return p.end == Packed::End::lost; }));
}
namespace {
template <class Arms>
double most(const Arms& arms, double ArmOutcome::* what) {
  double out = 0;
  for (const ArmOutcome& a : arms) out = std::max(out, a.*what);
  return out;
}
}  // namespace
double Outcome::worst_grip() const {
  return most(arm, &ArmOutcome::worst_grip);
}
double Outcome::worst_force() const {
  return most(arm, &ArmOutcome::worst_force);
}
double Outcome::shake() const {
  return most(arm, &ArmOutcome::shake);
}
double Outcome::seconds_an_orange() const {
  double busy = 0;
  for (const auto& a : arm) busy += a.busy;
  return ended.empty() ? 0 : busy / static_cast<double>(ended.size());
}

namespace {
constexpr struct {
  Fault fault;
  const char *name, *words;
  double lasts;  ///< unless it is said otherwise [s]
} faults[] = {{Fault::none, "none", "nothing goes wrong", 0},
              {Fault::slip, "slip", "a carried orange is wet and slips out of the fingers", 1},
              {Fault::no_detector, "no_detector", "the detector is silent", 2},
              {Fault::box_blocked, "box_blocked", "a person has the box", 30},
              {Fault::touch_held, "touch_held", "a person leans on a forearm", 20},
              {Fault::box_held, "box_held", "a person holds the full box that an arm moves, 80 mm aside", 3},
              {Fault::arm_stopped, "arm_stopped", "the first arm is stopped, for good", 1e6}};
}  // namespace

Fault fault_named(const std::string& name) {
  for (const auto& f : faults)
    if (name == f.name) return f.fault;
  throw std::runtime_error("no such fault: " + name);
}
const char* describe(Fault fault) {
  for (const auto& f : faults)
    if (fault == f.fault) return f.words;
  return "";
}

double duration(Fault fault) {
  for (const auto& f : faults)
    if (fault == f.fault) return f.lasts;
  return 0;
}

}  // namespace packing
