// Promise: two links of one arm never touch, nor a known object, and an arm can always leave
// Tried: UR5 and a table, 120 random scenes with wishes of up to 3 rad/s: nearest 20.0 mm of 20, also
// within limits of jerk and tool speed; no acceleration above the limit; a hand that folds an arm with an
// empty tank: 20.1 mm, without the limit it touches

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/governor_alone.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/sliding_robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Arm = ur5::Model;

/// The tubes of a UR5 and a table; links next to each other and next but one to the wrist always come close.
Clearance clearance() {
  Clearance c;
  for (std::size_t i = 0; i < 6; ++i)
    c.capsules.push_back({i, {ur5::tubes[i].from, ur5::tubes[i].to, ur5::tubes[i].radius}});
  c.capsules.push_back({LinkCapsule::fixed, {{0.5, -0.8, -0.1}, {0.5, 0.8, -0.1}, 0.1}});
  c.pairs = {{0, 2}, {0, 4}, {0, 5}, {1, 4}, {1, 5}, {2, 6}, {4, 6}, {5, 6}};
  c.reach = 1.2;
  return c;
}
/// The least distance of all pairs by points along the segments: nothing shared with what it judges.
double nearest(const Clearance& c, const JointPosition<6>& q) {
  const auto poses = link_poses(Arm{}, q);
  const auto point = [&](const LinkCapsule& capsule, double s) {
    Xyz<double> p = capsule.shape.from + s * (capsule.shape.to - capsule.shape.from);
    const auto place = [&](auto link) {
      constexpr std::size_t i = link.value;
      if (capsule.link == i) p = poses.template get<i>().origin() + poses.template get<i>().axes() * p;
    };
    const auto given = p;
    p = given;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      bool done = false;
      const auto once = [&](auto link) {
        if (!done && capsule.link == link.value) place(link), done = true;
      };
      (once(std::integral_constant<std::size_t, I>{}), ...);
    }(std::make_index_sequence<6>{});
    return p;
  };
  constexpr int points = 24;
  double least = 1e9;
  for (const CapsulePair& pair : c.pairs) {
    const auto &a = c.capsules[pair.a], &b = c.capsules[pair.b];
    for (int i = 0; i <= points; ++i)
      for (int j = 0; j <= points; ++j) {
        const auto way = point(a, double(i) / points) - point(b, double(j) / points);
        least = std::min(least, std::sqrt(dot(way, way)) - a.shape.radius - b.shape.radius);
      }
  }
  return least;
}

}  // namespace

TEST_CASE(
    "ClearanceLimits: whatever is wished, links stay clear, commands do not step, and it can always leave") {
  const auto limits = limits_of<ur5::Description>(15.0);
  const Clearance given = clearance();
  const ClearanceLimits<Arm> clear(Arm{}, limits, given);
  const auto alone = governor_alone<Interface::position, Arm>(limits, clear);
  const auto smooth = governor_alone<Interface::position, Arm>(
      limits, clear, JerkLimits<6>(limits, JointJerk<6>::constant(600.0)),
      ToolSpeed<Arm, 5>(Arm{}, limits, {.speed = 0.8, .reach = 1.3}));
  auto rng = seeded(6);
  double least = 1e9, step = 0, held = 0, left = 1e9;
  int scenes = 0, limited = 0;
  const auto run = [&](const auto& g, const JointPosition<6>& start) {
    typename std::remove_cvref_t<decltype(g)>::Memory memory{};
    JointCommand<6> last;
    last.valid = true, last.position = start;
    JointVelocity<6> want;
    const double dt = 0.008;
    const auto cycle = [&] {
      JointCommand<6> wish = last;
      for (std::size_t i = 0; i < 6; ++i) {
        wish.velocity[i] = last.velocity[i] + std::clamp(want[i] - last.velocity[i], -15 * dt, 15 * dt);
        wish.position[i] = last.position[i] + 0.5 * dt * (last.velocity[i] + wish.velocity[i]);
      }
      const State<6> measured{.time = 0ns, .q = last.position, .dq = last.velocity};
      const AllocationGuard guard;
      const auto out = g.step(memory, last, wish, measured, NoTouch{}, NoTouch{}, dt);
      const auto allocated = guard.count();
      REQUIRE(allocated == 0);
      for (std::size_t i = 0; i < 6; ++i)
        step = std::max(step, std::abs(out.command.velocity[i] - last.velocity[i]) / dt);
      limited += out.status.has(Reason::clearance_kept);
      last = out.command;
      if (!out.altered) last = wish;
      return out;
    };
    for (int n = 0; n < 150; ++n) {
      if (n % 40 == 0)
        for (auto& v : want) v = uniform(rng, -3.0, 3.0);
      cycle();
      least = std::min(least, nearest(given, last.position));
    }
    // From wherever it came to rest: along the gradient of the nearest pair, it gets away.
    for (auto& v : want) v = 0;
    for (int n = 0; n < 60; ++n) cycle();
    const auto at = clear.at(last.position);
    if (at.nearest() < 0.05) {
      for (std::size_t i = 0; i < 6; ++i) {
        auto q = last.position;
        q[i] += 1e-4;
        want[i] = (clear.at(q).nearest() - at.nearest()) / 1e-4;
      }
      double size = 0;
      for (const double v : want) size = std::max(size, std::abs(v));
      for (auto& v : want) v *= 0.5 / size;
      const double before = nearest(given, last.position);
      for (int n = 0; n < 60; ++n) cycle();
      left = std::min(left, nearest(given, last.position) - before);
      held += 1;
    }
  };
  while (scenes < (sanitized ? 10 : 120)) {
    JointPosition<6> q;
    for (auto& x : q) x = uniform(rng, -3.0, 3.0);
    if (clear.at(q).nearest() < 0.03) continue;
    ++scenes;
    if (scenes % 2 == 0)
      run(alone, q);
    else
      run(smooth, q);
  }
  MESSAGE(scenes << " scenes, limited in " << limited << " cycles: nearest " << 1e3 * least
                 << " mm of 20; largest acceleration " << step << " of 15 rad/s^2; of " << held
                 << " that rested near something the worst got away by " << 1e3 * left << " mm in 0.48 s");
  CHECK(limited > (sanitized ? 20 : 100));
  CHECK(least >= 0.02 - 1e-6);
  CHECK(least < (sanitized ? 0.022 : 0.021));  // no more is given away
  CHECK(step <= 15 * (1 + 1e-9));
  CHECK(held > (sanitized ? 0 : 5));
  CHECK(left > 0.005);
}

TEST_CASE("ClearanceLimits: a hand that folds an arm whose tank is empty does not make it touch itself") {
  const Clearance given = clearance();
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .lag = 0ms};
  c.virtual_damping = 2;
  const auto skin = ur5_skin<60>(CellGains{40, 0});
  const auto scene = Cycle(by_position(Arm{}, c, EnergyTank<>({.start = 0, .max = 1})), skin,
                           SkinJointControl{} + GravityControl{})
                         .with(given);
  const auto free = Cycle(by_position(Arm{}, c, EnergyTank<>({.start = 0, .max = 1})), skin,
                          SkinJointControl{} + GravityControl{});
  double fold_side = 1;
  const auto fold = [&](const auto& s, double& least, double& step, bool& kept) {
    const auto memory = std::make_unique<typename std::remove_cvref_t<decltype(s)>::Memory>();
    State<6> state;
    state.q = JointPosition<6>{0.0, -1.6, 1.8, -1.8, -1.57, 0.0};
    s.start(*memory, state);
    const auto places = skin.places();
    for (int n = 1; n < 500; ++n) {
      const Nanoseconds now = n * Nanoseconds(8ms);
      // Pushed on the forearm's cells from the side that folds the elbow.
      std::vector<CellSample> samples;
      for (std::size_t i = 0; i < places.size(); ++i) {
        CellSample sample;
        sample.cell = std::uint32_t(i + 1), sample.time = now - 1ms;
        if (places[i].link == 2 && places[i].normal.y * fold_side > 0.6) sample.force = {0.4f, 0.4f, 0.4f};
        samples.push_back(sample);
      }
      typename std::remove_cvref_t<decltype(s)>::Input input;
      input.now = now, input.measured = state, input.measured.time = now, input.samples = samples;
      const auto out = s.step(*memory, input);
      kept = kept || out.status.has(Reason::clearance_kept);
      for (std::size_t i = 0; i < 6; ++i)
        step = std::max(step, std::abs(out.planned.velocity[i] - state.dq[i]) / 0.008);
      state.q = out.planned.position, state.dq = out.planned.velocity;
      least = std::min(least, nearest(given, state.q));
    }
  };
  double without = 1e9, with = 1e9, step = 0, ignored = 0;
  bool kept = false, none = false;
  fold(free, without, ignored, none);
  fold(scene, with, step, kept);
  MESSAGE("nearest without the limit " << 1e3 * without << " mm, with it " << 1e3 * with << " mm of 20; "
                                       << step << " rad/s^2");
  CHECK(without < 0);  // it would touch
  CHECK(with >= 0.02 - 1e-6);
  CHECK(step <= 15 * (1 + 1e-9));
  CHECK(kept);
  CHECK_FALSE(none);
}

TEST_CASE("ClearanceLimits: what cannot be is refused") {
  const auto limits = limits_of<ur5::Description>(15.0);
  const auto refused = [&](auto&& change) {
    Clearance c = clearance();
    change(c);
    CHECK_THROWS_AS(ClearanceLimits<Arm>(Arm{}, limits, c), ConfigurationError);
  };
  refused([](Clearance& c) { c.margin = -1; });
  refused([](Clearance& c) { c.reach = 0; });
  refused([](Clearance& c) { c.pairs.push_back({0, 9}); });
  refused([](Clearance& c) { c.pairs.push_back({1, 1}); });
  refused([](Clearance& c) { c.capsules[2].link = 7; });
  refused([](Clearance& c) { c.pairs.resize(65, {0, 2}); });
}

// A base that drives moves all of the robot by metres, however short its levers are.
TEST_CASE("ClearanceLimits: a robot that drives towards a wall stops before it, whatever its reach is") {
  using Tree = ChainOf<slides, slides, turns>;
  const auto model = model_of<Tree>(on_wheels<Tree>(20));
  using Robot = std::remove_const_t<decltype(model)>;
  for (const double reach : {0.1, 0.3, 1.0, 3.0})
    for (const double direction : {1.0, -1.0}) {
      CAPTURE(reach);
      Clearance given;
      given.capsules = {{2, {{0.05, 0, 0}, {0.08, 0, 0}, 0.02}},
                        {LinkCapsule::fixed, {{direction, -1, 0}, {direction, 1, 0}, 0.05}}};
      given.pairs = {{0, 1}};
      given.reach = reach;
      const JointLimits<3> limits({.lower = JointPosition<3>::constant(-10),
                                   .upper = JointPosition<3>::constant(10),
                                   .velocity = JointVelocity<3>::constant(1),
                                   .acceleration = JointAcceleration<3>::constant(1),
                                   .torque = JointTorque<3>::constant(100)});
      const ClearanceLimits<Robot> clear(model, limits, given);
      JointPosition<3> q{};
      JointVelocity<3> u{};
      double nearest = 1, fastest = 0;
      const double h = 0.008;
      for (int k = 0; k < 600; ++k) {
        const auto wish = limits.move(limits.room(q), u, {direction, 0.2, 0.3}, h).velocity;
        const auto next = clear.within({}, q, limits.room(q), u, wish, h, [](const auto&) { return true; });
        q = integrate(q, 0.5 * (u + next.velocity), h);
        u = next.velocity;
        nearest = std::min(nearest, clear.at(q).nearest());
        fastest = std::max(fastest, std::abs(u[0]));
      }
      CHECK(nearest >= given.margin);
      CHECK(nearest < given.margin + 0.02);  // it goes there
      CHECK(fastest > 0.5);
    }
}
