// Four tasks as people do them by leading a hand: packing, pancakes, a sandwich, a table.
#pragma once

#include <array>

#include "examples/worlds/led_hand.hpp"

namespace skinctl::testing {

/// Classes of things; bottle, spatula and knife are tools.
namespace thing {
enum : ObjectClass { orange = 1, box, bin, bottle, pan, spatula, knife, bread, plate, cup, fork };
inline constexpr std::uint64_t tools = (1u << bottle) | (1u << spatula) | (1u << knife);
}  // namespace thing

/// The tasks; a scene has at most six things.
enum class LedTask : std::uint8_t { packing, pancake, sandwich, table };
inline constexpr std::size_t led_tasks = 4, led_things = 6;

struct Thing {
  ObjectClass kind = 0;
  Xyz<double> p{0, 0, 0};
};
/// What happened to a thing: from `time` on it is in the hand, or at `p`.
struct ThingEvent {
  double time;
  std::uint8_t thing;
  bool held;
  Xyz<double> p;  ///< held: from the hand; else in the world
};

/// A task as one person does it once, with everything that is true about it.
struct LedRun {
  LedHand hand;
  std::array<Thing, led_things> things{};
  std::vector<ThingEvent> events;

  /// Where a thing is.
  [[nodiscard]] Xyz<double> place(std::size_t i, double t) const {
    Xyz<double> at = things[i].p;
    for (const auto& e : events)
      if (e.thing == i && e.time <= t) at = e.held ? Xyz<double>(hand.truth(t).p + e.p) : e.p;
    return at;
  }
  [[nodiscard]] double lasts() const { return hand.now(); }
};

namespace led {
class LedActor {
 public:
  LedActor(LedRun& run) : r_(run), h_(run.hand) {}  // NOLINT

  Xyz<double> near(const Xyz<double>& p, double by) {
    auto& random = h_.random();
    return p + Xyz<double>{uniform(random, -by, by), uniform(random, -by, by),
                           uniform(random, -0.3 * by, 0.3 * by)};
  }
  void idle(double time) {
    h_.means(Activity::idle);
    h_.wait(time);
  }
  void take(std::uint8_t thing) {
    const Xyz<double> at = r_.place(thing, h_.now());
    h_.means(Activity::reach);
    h_.go(at + Xyz<double>{0, 0, 0.1});
    h_.go(near(at, 0.008), 1.3);
    h_.wait(0.12);
    h_.means(Activity::take);
    const double closing = h_.now();
    h_.close();
    const Xyz<double> in_hand = at - h_.position();
    r_.events.push_back({closing + 0.5 * h_.person().rise, thing, true, in_hand});
    h_.wait(0.25);
    held_ = thing;
    offset_ = in_hand;
  }
  void carry(const Xyz<double>& to) {
    h_.means(Activity::put);
    h_.go(near(to + Xyz<double>{0, 0, 0.12}, 0.01));
  }
  void hold(double time) {
    h_.means(Activity::hold);
    h_.wait(time);
  }
  void squeeze(double time) {
    h_.means(Activity::squeeze);
    h_.press_by(h_.person().squeeze);
    h_.wait(time);
    h_.press_by(1 / h_.person().squeeze);
    h_.means(Activity::hold);
    h_.wait(0.15);
  }
  void use(int strokes, const Xyz<double>& along, const Xyz<double>& across, double period) {
    h_.means(Activity::use);
    h_.strokes(strokes, along, across, period * uniform(h_.random(), 0.8, 1.3));
    h_.means(Activity::hold);
    h_.wait(0.2);
  }
  void let_go(const Xyz<double>& to) {
    h_.means(Activity::put);
    h_.go(near(to, 0.01), 1.3);
    h_.wait(0.1);
    h_.means(Activity::release);
    const double opening = h_.now();
    h_.open();
    r_.events.push_back({opening + 0.5 * h_.person().rise, held_, false, h_.position() + offset_});
    h_.wait(0.15);
    h_.go(h_.position() + Xyz<double>{0, 0, uniform(h_.random(), 0.06, 0.12)});
  }
  void rest(double time) {
    h_.means(Activity::idle);
    h_.wait(time);
  }

 private:
  LedRun& r_;
  LedHand& h_;
  std::uint8_t held_ = 0;
  Xyz<double> offset_{0, 0, 0};
};
}  // namespace led

/// The task, done once. Places, speeds, pauses and forces differ from run to run.
[[nodiscard]] inline LedRun led_run(LedTask task, const Person& person, std::uint64_t seed) {
  LedRun run{LedHand(person, seed, {0.4, 0, 0.35}), {}, {}};
  led::LedActor act(run);
  using P = Xyz<double>;
  const auto put = [&](std::size_t i, ObjectClass kind, const P& p) {
    run.things[i] = {kind, act.near(p, 0.04)};
  };
  act.idle(1);
  switch (task) {
    case LedTask::packing:
      put(0, thing::orange, {0.6, -0.35, 0.05});
      put(1, thing::orange, {0.7, -0.15, 0.05});
      put(2, thing::orange, {0.5, -0.15, 0.05});
      put(3, thing::box, {0.55, 0.3, 0.0});
      put(4, thing::bin, {0.25, 0.4, 0.0});
      for (std::uint8_t i = 0; i < 3; ++i) {
        act.take(i);
        act.carry({0.5, 0.05, 0.15});
        act.hold(0.4);
        act.squeeze(0.7);
        const P to = run.things[i == 1 ? 4 : 3].p + P{0.03 * i, 0, 0.06};
        act.carry(to);
        act.let_go(to);
        if (i == 1) act.rest(0.8);
      }
      break;
    case LedTask::pancake:
      put(0, thing::bottle, {0.7, -0.3, 0.1});
      put(1, thing::pan, {0.5, 0.2, 0.03});
      put(2, thing::spatula, {0.4, -0.35, 0.05});
      put(3, thing::plate, {0.25, 0.35, 0.01});
      act.take(0);
      act.carry(run.things[1].p);
      act.hold(0.25);
      act.use(3, {0.03, 0, 0}, {0, 0.03, 0}, 1.1);  // pours in circles
      act.let_go({0.7, -0.3, 0.1});
      act.rest(1.5);
      act.take(2);
      act.carry(run.things[1].p);
      act.use(2, {0.05, 0, 0.02}, {0, 0, 0.04}, 0.9);  // turns it
      act.let_go({0.4, -0.35, 0.05});
      break;
    case LedTask::sandwich:
      put(0, thing::knife, {0.7, -0.25, 0.03});
      put(1, thing::bread, {0.5, 0.15, 0.05});
      put(2, thing::bread, {0.65, 0.1, 0.03});
      put(3, thing::plate, {0.3, 0.35, 0.01});
      act.take(0);
      act.carry(run.things[1].p);
      act.use(4, {0.05, 0.01, 0}, {0, 0, 0.006}, 0.8);  // cuts
      act.let_go({0.7, -0.25, 0.03});
      act.take(2);
      act.carry(run.things[3].p);
      act.let_go(run.things[3].p + P{0, 0, 0.03});
      act.rest(0.8);
      break;
    case LedTask::table:
      put(0, thing::plate, {0.7, -0.2, 0.02});
      put(1, thing::cup, {0.6, -0.35, 0.05});
      put(2, thing::fork, {0.45, -0.3, 0.01});
      act.take(0);
      act.carry({0.5, 0.25, 0.02});
      act.let_go({0.5, 0.25, 0.02});
      act.take(1);
      act.carry({0.65, 0.4, 0.05});
      act.hold(0.5);
      act.let_go({0.65, 0.4, 0.05});
      act.rest(1);
      act.take(2);
      act.carry({0.35, 0.25, 0.01});
      act.let_go({0.35, 0.25, 0.01});
      break;
  }
  act.rest(1);
  return run;
}

}  // namespace skinctl::testing
