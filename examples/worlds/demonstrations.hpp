// Recordings of simulated people who pack oranges, by kind of person and of sensing; and whether a learnt
// task is theirs.
#pragma once

#include <functional>

#include "examples/worlds/led_tasks.hpp"
#include "skinctl/semantics/learn.hpp"

namespace skinctl::testing {

/// How a demonstration is sensed, and what disturbs it.
struct ShownBy {
  double rate = 250;            ///< of the hand [Hz]
  double sigma = 0.0002;        ///< of its position along each axis [m]
  double force_noise = 0.1;     ///< [N]
  double opening_noise = 1e-4;  ///< [m]
  double camera_sigma = 0.005;  ///< of things, at 30 Hz [m]
  double sway = 0;              ///< of the person, at 1 Hz [m]
  double wander = 0;            ///< of the grip, as a share of it
  double shake = 0;             ///< of the force while the hand moves, as a share of it
  double bounce = 0;            ///< contact is lost again for so long [s]
  double warp = 0;              ///< time is stretched and squeezed by this share
  double off = 0;               ///< things are seen this far beside their places [m]
  bool regrips = false;         ///< the fingers grip anew on the way
};
/// Force over the way of the fingers, of a hard and of a soft orange [N/m]: both sides of an orange give, so
/// this is half of a side's stiffness.
inline constexpr double hard_orange = 3000, soft_orange = 1250;

/// Records a run. `stiffness[i]` of thing i [N/m]; 0: of a hard one.
[[nodiscard]] inline Demonstration<> shown(const LedRun& run, const ShownBy& by, std::uint64_t seed,
                                           const std::array<double, led_things>& stiffness = {}) {
  Demonstration<> out;
  auto random = seeded(seed);
  std::normal_distribution<double> noise(0, 1);
  const double pi = 3.14159265358979323846, phase = uniform(random, 0.0, 6.28);
  const Person& person = run.hand.person();
  const auto around = [&](const Xyz<double>& p, double s) {
    return Xyz<double>(p + Xyz<double>{s * noise(random), s * noise(random), s * noise(random)});
  };
  const auto warped = [&](double t) {
    return t + by.warp / (2 * pi * 0.2) * std::sin(2 * pi * 0.2 * t + phase);
  };
  const double begins = warped(0);
  double last_force = 0, pressed_at = -1;
  for (int k = 0; k / by.rate < run.lasts(); ++k) {
    const double t = k / by.rate, a = 2 * pi * person.tremor_rate * t + phase;
    const auto now = run.hand.truth(t);
    double force = now.force;
    const double speed = norm(now.v);
    if (by.regrips && speed > 0.4 * person.speed && std::fmod(t + phase, 0.9) < 0.15) force *= 0.7;
    force *= 1 + by.wander * std::sin(2 * pi * 0.4 * t + phase);
    force *= 1 + by.shake * std::min(1.0, speed / person.speed) * std::sin(2 * pi * 5 * t);
    if (last_force == 0 && now.force > 0) pressed_at = t;
    if (by.bounce > 0 && t > pressed_at + 0.03 && t < pressed_at + 0.03 + by.bounce) force = 0;
    last_force = now.force;
    std::size_t held = led_things;
    for (const auto& e : run.events)
      if (e.time <= t) held = e.held ? e.thing : led_things;
    const double hard = held < led_things && stiffness[held] > 0 ? stiffness[held] : hard_orange;
    const double opening = force > 0 ? 0.076 - force / hard : 0.09;
    const Xyz<double> tremor{person.tremor * std::sin(a), person.tremor * std::sin(a + 2),
                             person.tremor * std::sin(a + 4)};
    const Xyz<double> sway{by.sway * std::sin(2 * pi * t + phase), by.sway * std::cos(2 * pi * t), 0.0};
    const auto p = around(now.p + tremor + sway, by.sigma);
    out.hand.push_back({nanoseconds(warped(t) - begins) + 1ns,
                        Transform<World, Tool>::translation_xyz(p.x, p.y, p.z),
                        force + by.force_noise * noise(random), opening + by.opening_noise * noise(random)});
  }
  for (const auto& thing : run.things)
    if (thing.kind != 0) out.kinds.push_back(thing.kind);
  const Xyz<double> off{by.off * std::cos(phase), by.off * std::sin(phase), 0};
  for (int k = 0; k / 30.0 < run.lasts(); ++k)
    for (std::size_t i = 0; i < out.kinds.size(); ++i) {
      const double t = k / 30.0;
      const auto p = run.place(i, t);
      if (uniform(random, 0.0, 1.0) < 0.05) continue;
      if (norm(Xyz<double>(p - run.hand.truth(t).p)) < 0.08 && uniform(random, 0.0, 1.0) < 0.8) continue;
      const auto at = around(p + off, by.camera_sigma);
      out.seen.push_back({static_cast<std::uint8_t>(i), ObjectPose<>::translation_xyz(at.x, at.y, at.z),
                          by.camera_sigma, nanoseconds(warped(t) - begins) + 1ns});
    }
  return out;
}

/// Whether a task packs as was shown: oranges until none is left; taken and squeezed; the harder ones into
/// the box, the others into the bin, with a border between the two kinds, where the people let go to within
/// 40 mm. Walks the graph.
template <std::size_t C>
[[nodiscard]] bool packs(const TaughtTask<C>& t) {
  std::uint8_t at = 0;
  const auto follows = [&](std::initializer_list<const char*> names) {
    for (const char* name : names) {
      if (at >= t.size || std::string(t.steps[at].does->name) != name || t.steps[at].role != thing::orange)
        return false;
      at = t.steps[at].done;
    }
    return true;
  };
  const auto ends = [&](ObjectClass mark) {
    if (!follows({"find"}) || at >= t.size) return false;
    const TaughtPlace place = t.places[t.steps[at].place];
    const auto p = place.X_MH.origin();
    constexpr double middle = 0.03;  // of box and bin
    return place.mark == mark && std::hypot(p.x - middle, p.y) < 0.04 && std::abs(p.z - 0.06) < 0.04 &&
           follows({"put", "release"}) && at == 0;
  };
  if (t.steps[0].no != finish || !follows({"look", "reach_above", "reach", "take", "carry"})) return false;
  const Step squeeze = t.steps[at];
  if (!follows({"squeeze"}) || squeeze.border >= t.border_count || !ends(thing::box)) return false;
  at = squeeze.no;
  return ends(thing::bin) && t.borders[squeeze.border] > 1.1 * soft_orange &&
         t.borders[squeeze.border] < hard_orange / 1.1;
}

/// A kind of people, and how they are sensed.
struct Kind {
  const char* name;
  std::function<void(Person&, ShownBy&)> change;
};
[[nodiscard]] inline std::vector<Kind> kinds_of_people() {
  return {{"ordinary", [](Person&, ShownBy&) {}},
          {"0.12 m/s", [](Person& p, ShownBy&) { p.speed = 0.12; }},
          {"0.06 m/s", [](Person& p, ShownBy&) { p.speed = 0.06; }},
          {"1.2 m/s", [](Person& p, ShownBy&) { p.speed = 1.2; }},
          {"tremor 1.5 mm", [](Person& p, ShownBy&) { p.tremor = 0.0015; }},
          {"tremor 3 mm", [](Person& p, ShownBy&) { p.tremor = 0.003; }},
          {"hand noise 1 mm", [](Person&, ShownBy& by) { by.sigma = 0.001; }},
          {"hand by camera 2 mm, 60 Hz", [](Person&, ShownBy& by) { by.sigma = 0.002, by.rate = 60; }},
          {"hand by camera 5 mm, 30 Hz", [](Person&, ShownBy& by) { by.sigma = 0.005, by.rate = 30; }},
          {"re-grips on the way", [](Person&, ShownBy& by) { by.regrips = true; }},
          {"sway 3 mm at 1 Hz", [](Person&, ShownBy& by) { by.sway = 0.003; }},
          {"often pauses", [](Person& p, ShownBy&) { p.hesitates = 0.9; }},
          {"impatient", [](Person& p, ShownBy&) { p.patience = 0.4; }},
          {"slow fingers", [](Person& p, ShownBy&) { p.rise = 0.3; }},
          {"grips with 1.2 N", [](Person& p, ShownBy&) { p.grip = 1.2; }},
          {"squeezes by half", [](Person& p, ShownBy&) { p.squeeze = 1.5; }}};
}
/// Signals unlike those of any person here.
[[nodiscard]] inline std::vector<Kind> perturbed_signals() {
  return {{"grip wanders 10 %", [](Person&, ShownBy& by) { by.wander = 0.1; }},
          {"grip wanders 20 %", [](Person&, ShownBy& by) { by.wander = 0.2; }},
          {"force shakes 15 % with the motion", [](Person&, ShownBy& by) { by.shake = 0.15; }},
          {"contact bounces 12 ms", [](Person&, ShownBy& by) { by.bounce = 0.012; }},
          {"time warped by 20 %", [](Person&, ShownBy& by) { by.warp = 0.2; }},
          {"things seen 20 mm off", [](Person&, ShownBy& by) { by.off = 0.02; }}};
}
/// A packing demonstration by a person of a kind.
[[nodiscard]] inline Demonstration<> packing_shown(const Kind& kind, std::uint64_t seed) {
  auto random = seeded(seed);
  Person person = Person::any(random);
  ShownBy by;
  kind.change(person, by);
  return shown(led_run(LedTask::packing, person, seed * 10 + 1), by, seed * 10 + 2,
               {hard_orange, soft_orange, hard_orange});
}
/// The same with oranges that are all alike.
[[nodiscard]] inline Demonstration<> alike_shown(const Kind& kind, std::uint64_t seed) {
  auto random = seeded(seed);
  Person person = Person::any(random);
  ShownBy by;
  kind.change(person, by);
  return shown(led_run(LedTask::packing, person, seed * 10 + 1), by, seed * 10 + 2);
}
/// An orange that is dropped on its way, taken again, squeezed and put into the box; then one for the bin.
[[nodiscard]] inline Demonstration<> dropped_shown(std::uint64_t seed) {
  auto random = seeded(seed);
  LedRun run{LedHand(Person::any(random), seed * 10 + 1, {0.4, 0, 0.35}), {}, {}};
  led::LedActor act(run);
  run.things[0] = {thing::orange, act.near({0.6, -0.35, 0.05}, 0.04)};
  run.things[1] = {thing::orange, act.near({0.7, -0.15, 0.05}, 0.04)};
  run.things[2] = {thing::box, act.near({0.55, 0.3, 0.0}, 0.04)};
  run.things[3] = {thing::bin, act.near({0.25, 0.4, 0.0}, 0.04)};
  act.idle(1);
  act.take(0);
  act.let_go(act.near({0.5, 0.0, 0.05}, 0.05));
  for (std::uint8_t i = 0; i < 2; ++i) {
    act.take(i);
    act.carry({0.5, 0.05, 0.15});
    act.hold(0.4);
    act.squeeze(0.7);
    act.let_go(run.things[2u + i].p + Xyz<double>{0.0, 0.0, 0.06});
  }
  act.rest(1);
  return shown(run, {}, seed * 10 + 2, {hard_orange, soft_orange});
}
/// Another task of the simulated kitchen, as any person shows it; `noise` of the hand by camera at 60 Hz [m],
/// 0: of the robot.
[[nodiscard]] inline Demonstration<> kitchen_shown(LedTask task, std::uint64_t seed, double tremor = 0,
                                                   double noise = 0) {
  auto random = seeded(seed);
  Person person = Person::any(random);
  if (tremor > 0) person.tremor = tremor;
  ShownBy by;
  if (noise > 0) by.sigma = noise, by.rate = 60;
  return shown(led_run(task, person, seed * 10 + 1), by, seed * 10 + 2);
}
/// A task without branches in one line: "look 4 reach_above 4 ... use 4 at 5 ... release 4 at 0 end".
template <std::size_t C>
[[nodiscard]] std::string in_line(const TaughtTask<C>& t) {
  std::string out;
  std::uint8_t at = 0;
  for (int i = 0; i < 100 && at < t.size; ++i) {
    const Step& s = t.steps[at];
    const std::string name = s.does->name;
    if (s.no != nowhere && s.no != ask_person) out += "(or) ";
    if (name != "look" && name != "reach_above" && name != "reach" && name != "find" && name != "carry" &&
        name != "put")
      out += name + " " + std::to_string(s.role) + " at " + std::to_string(t.places[s.place].mark) + ", ";
    at = s.done;
  }
  return out + (at == finish ? "end" : "?");
}
/// What `in_line` says of the tasks as they were meant: a bottle, a spatula used at the pan, a knife at the
/// bread, a slice of bread put on the plate; three things put on the table.
[[nodiscard]] inline const char* meant_in_line(LedTask task) {
  return task == LedTask::pancake
             ? "take 4 at 4, use 4 at 5, release 4 at 0, take 6 at 6, use 6 at 5, release 6 at 0, end"
         : task == LedTask::sandwich
             ? "take 7 at 7, use 7 at 8, release 7 at 0, take 8 at 8, release 8 at 9, end"
             : "";
}
/// The containers of the simulated kitchen.
[[nodiscard]] inline LearnSettings kitchen() {
  LearnSettings s;
  s.deeds.containers = (1u << thing::box) | (1u << thing::bin) | (1u << thing::pan) | (1u << thing::plate);
  return s;
}

/// Found, wrong and refused.
struct TaskScore {
  int found = 0, wrong = 0, refused = 0;
  Refusal last = Refusal::none;
  template <std::size_t C>
  void add(const Learnt<C>& learnt) {
    if (learnt.why != Refusal::none) {
      ++refused;
      last = learnt.why;
    } else {
      ++(packs(learnt.task) ? found : wrong);
    }
  }
};

}  // namespace skinctl::testing
