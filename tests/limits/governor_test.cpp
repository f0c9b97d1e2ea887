// Promise: the tool's speed is kept next to the ends of the joints, with a limit of jerk and without
// Tried: 300 arms with six ends within 0.3 rad each, driven at them: at most 0.2493 of 0.25 m/s

#include "skinctl/limits/governor.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>

#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/governor_alone.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Arm = ur5::Model;
constexpr std::size_t forearm = 2;

// Numbers of the test, nobody's recommendation.
LinkContact<forearm> contact(double force, double blow) {
  LinkContact<forearm> c{
      .region = {.force = force, .blow = blow, .first = 100ms, .stiffness = 3e4, .mass = 4, .power = 50},
      .reach = 0.5,
      .reaction_time = 20ms};
  c.newton = 0.2;  // the scene's skin is felt five times as strong as it is
  return c;
}
struct Limited {
  double jerk = 400, speed = 0.15, force = 100, blow = 150;
};
auto governed(const Limited& l = {}) {
  const SceneSettings s;
  const auto c = configuration_of<Interface::position, double>(s);
  SkinSettings skin;
  skin.max_age = 10s;
  return Cycle(by_position(ur5::Model{}, c), ur5_skin<260>({.force = s.force_gain}, skin),
               SkinJointControl{} + GravityControl{})
      .with(contact(l.force, l.blow), MaxToolSpeed<5>{.speed = l.speed, .reach = 1.3},
            MaxJerk{JointJerk<6>::constant(l.jerk)});
}

static_assert(std::is_trivially_copyable_v<decltype(governed())::Memory>);

/// Runs a scene on a robot that follows at once; the forearm is pushed with readings `push(t)`.
template <class Scene, class Push, class Each>
void run(const Scene& scene, double duration, Push&& push, Each&& each) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> state;
  state.q = home_position();
  scene.start(*memory, state);
  for (Nanoseconds now = 8ms; now <= nanoseconds(duration); now += 8ms) {
    typename Scene::Input input;
    input.now = now;
    input.measured = state;
    input.measured.time = now;
    const double t = seconds<double>(now);
    const auto f = static_cast<float>(push(t));
    const CellSample touch{.time = now - 1ms, .cell = 150, .force = {f, f, f}};
    input.samples = std::span(&touch, 1);
    each(t, input, *memory);
    const auto out = scene.step(*memory, input);
    each(t, out);
    state.q = out.command.position;
    state.dq = out.planned.velocity;
  }
}
/// Speed of the tool's flange by differences of poses: independent of Jacobians.
double measured_speed(const JointPosition<6>& q, const JointVelocity<6>& u) {
  const auto at = [&](double h) {
    return link_poses<link_bit<5>>(Arm{}, integrate(q, u, h)).get<5>().origin();
  };
  const Xyz<double> v = (1 / 2e-6) * (at(1e-6) - at(-1e-6));
  return std::sqrt(dot(v, v));
}
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;
const auto nothing = [](double, auto&, auto&) {};

}  // namespace

TEST_CASE(
    "governor: what keeps its limits passes to the bit, what does not is slowed within the joints' limits") {
  const auto limits = ur5_test_limits<double>();
  const auto g =
      governor_alone<Interface::position, Arm>(limits, contact_limits(Arm{}, contact(1e6, 1e6)),
                                               ToolSpeed<Arm, 5>(Arm{}, limits, {.speed = 1, .reach = 1.3}));
  decltype(g)::Memory memory;
  const LinkWrenches<Arm, link_bit<forearm>> untouched;
  State<6> measured;
  measured.q = home_position();
  oracle::Random random(2);
  int slowed = 0;
  for (int k = 0; k < 2000; ++k) {
    JointCommand<6> last, wish;
    last.valid = wish.valid = true;
    last.position = home_position();
    wish.position = last.position;
    wish.time = 8ms;
    for (std::size_t i = 0; i < 6; ++i) {
      last.velocity[i] = random.uniform(-0.3, 0.3);
      wish.velocity[i] = last.velocity[i] + random.uniform(-0.12, 0.12);
      wish.position[i] += 0.004 * (last.velocity[i] + wish.velocity[i]);
      if (k % 2 != 0) wish.velocity[i] = random.uniform(-3, 3);
    }
    const auto out = g.step(memory, last, wish, measured, untouched, std::array<double, 1>{1}, 0.008);
    if (!out.altered) {
      CHECK(out.command.position == wish.position);
      CHECK(out.command.velocity == wish.velocity);
      CHECK_FALSE(out.status.any());
      continue;
    }
    ++slowed;
    CHECK(out.status.has(Reason::tool_speed_limited));
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(std::abs(out.command.velocity[i] - last.velocity[i]) <= 15 * 0.008 * (1 + 1e-9));
  }
  CHECK(slowed > 500);
  CHECK(slowed < 1500);
}

TEST_CASE("governor: jerk, tool speed and blow of a pushed arm stay below their limits") {
  const Limited l{.jerk = 400, .speed = 0.15, .force = 1e4, .blow = 1e4};
  const auto scene = governed(l);
  const auto tool = ToolSpeed<Arm, 5>(Arm{}, ur5_test_limits<double>(), {.speed = l.speed, .reach = 1.3});
  JointAcceleration<6> last{};
  double fastest = 0, jerk = 0, moved = 0;
  Status seen;
  int given_way = 0;
  run(
      scene, 6, [](double t) { return std::fmod(t, 2) < 0.7 ? 0.5 : 0; },
      Overloaded{nothing, [&](double, const auto& out) {
                   seen |= out.status;
                   fastest = std::max(fastest, tool.at(out.planned.position).speed(out.planned.velocity));
                   const bool gave_way = out.status.has(Reason::jerk_exceeded);
                   given_way += gave_way;
                   for (std::size_t i = 0; i < 6; ++i) {
                     const double j = std::abs(out.planned.acceleration[i] - last[i]) / 0.008;
                     if (!gave_way) jerk = std::max(jerk, j);
                     moved = std::max(moved, std::abs(out.command.position[i] - home[i]));
                   }
                   last = out.planned.acceleration;
                 }});
  CHECK(seen.has(Reason::tool_speed_limited));
  CHECK(fastest <= 0.15 * 1.001);
  CHECK(fastest > 0.12);
  CHECK(moved > 0.05);
  MESSAGE("tool " << fastest << " m/s, jerk " << jerk << " rad/s^3, gave way in " << given_way << " of 750");
  CHECK(jerk <= l.jerk * 1.0001);  // wherever it is not said that it gave way
  CHECK(given_way < 75);
}

// A joint that brakes for its end takes away what cancelled the motion of the others: braking is planned for
// all of them together. Every joint has an end within 0.3 rad.
TEST_CASE("governor: the tool's speed is kept next to the ends of the joints") {
  oracle::Random random(11);
  constexpr double h = 0.008;
  int near = 0, at_ends = 0;
  for (const bool smooth : {false, true}) {
    double fastest = 0, beyond = 0;
    for (int run = 0; run < (sanitized ? 30 : 300); ++run) {
      auto v = ur5_test_limits<double>().values();
      JointCommand<6> last;
      last.valid = true;
      for (std::size_t i = 0; i < 6; ++i) {
        last.position[i] = random.uniform(-2, 2);
        v.lower[i] = last.position[i] - random.uniform(0, 0.3);
        v.upper[i] = last.position[i] + random.uniform(0, 0.3);
      }
      const JointLimits<6> limits(v);
      const ToolSpeed<Arm, 5> tool(Arm{}, limits, {.speed = 0.25, .reach = 1.3});
      const auto drive = [&](const auto& g) {
        typename std::remove_cvref_t<decltype(g)>::Memory memory{};
        JointVelocity<6> target;
        for (int k = 0; k < 300; ++k) {
          if (k % 25 == 0)
            for (double& x : target) x = random.uniform(-3, 3);
          const auto motion = limits.move(limits.room(last.position), last.velocity, target, h);
          JointCommand<6> wish = last;
          wish.velocity = motion.velocity;
          wish.position = last.position + motion.displacement;
          const auto out = g.step(memory, last, wish, State<6>{}, LinkWrenches<Arm, link_bit<2>>{},
                                  std::array<double, 1>{1}, h);
          last = out.command;
          const double speed = measured_speed(last.position, last.velocity);
          fastest = std::max(fastest, speed);
          near += speed > 0.9 * 0.25;
          for (std::size_t i = 0; i < 6; ++i) {
            beyond = std::max({beyond, last.position[i] - v.upper[i], v.lower[i] - last.position[i]});
            at_ends += std::min(v.upper[i] - last.position[i], last.position[i] - v.lower[i]) < 1e-3;
          }
        }
      };
      if (smooth) {
        drive(governor_alone<Interface::position, Arm>(limits, tool,
                                                       JerkLimits<6>(limits, JointJerk<6>::constant(400))));
      } else {
        drive(governor_alone<Interface::position, Arm>(limits, tool));
      }
    }
    CHECK(fastest <= 0.25 * (1 + 1e-6));
    CHECK(beyond <= 1e-12);
    MESSAGE(std::string(smooth ? "with" : "without")
            << " a limit of jerk: fastest " << fastest << " of 0.25 m/s");
  }
  CHECK(near > (sanitized ? 6000 : 60000));  // the limit is used
  CHECK(at_ends > (sanitized ? 6000 : 60000));
}

// A resolver that computes a cycle in substeps may hurry between them: the speed at the end says nothing of
// that.
TEST_CASE("governor: a motion that is faster on its way than at its end keeps the tool's speed") {
  constexpr double h = 0.014, most = 0.05;
  const auto limits = ur5_test_limits<double>();
  const ToolSpeed<Arm, 5> tool(Arm{}, limits, {.speed = most, .reach = 1.3});
  oracle::Random random(31);
  const auto tool_at = [](const JointPosition<6>& q) {
    return link_poses<link_bit<5>>(Arm{}, q).get<5>().origin();
  };
  for (const bool smooth : {false, true}) {
    double fastest = 0;
    int slowed = 0, passed = 0;
    const auto drive = [&](const auto& g) {
      for (int k = 0; k < (sanitized ? 300 : 3000); ++k) {
        typename std::remove_cvref_t<decltype(g)>::Memory memory{};
        JointCommand<6> last, wish;
        last.valid = wish.valid = true;
        for (std::size_t i = 0; i < 6; ++i) {
          last.position[i] = random.uniform(-2, 2);
          last.velocity[i] = random.uniform(-0.02, 0.02);
          wish.velocity[i] = random.uniform(-0.02, 0.02);
          const double bulge = 0.25 * limits.acceleration()[i] * h * h;  // full acceleration, full braking
          wish.position[i] = last.position[i] + h / 2 * (last.velocity[i] + wish.velocity[i]) +
                             random.uniform(-bulge, bulge);
        }
        const auto out = g.step(memory, last, wish, State<6>{}, LinkWrenches<Arm, link_bit<2>>{},
                                std::array<double, 1>{1}, h);
        const Xyz<double> way = tool_at(out.command.position) - tool_at(last.position);
        fastest = std::max(fastest, std::sqrt(dot(way, way)) / h);
        CHECK(out.altered == out.status.has(Reason::tool_speed_limited));
        (out.altered ? slowed : passed)++;
      }
    };
    if (smooth) {
      drive(governor_alone<Interface::position, Arm>(limits, tool,
                                                     JerkLimits<6>(limits, JointJerk<6>::constant(5000))));
    } else {
      drive(governor_alone<Interface::position, Arm>(limits, tool));
    }
    CHECK(fastest <= most);
    CHECK(fastest > 0.9 * most);
    CHECK(slowed > (sanitized ? 15 : 150));
    CHECK(passed > (sanitized ? 15 : 150));
    MESSAGE(std::string(smooth ? "with" : "without")
            << " a limit of jerk: fastest " << fastest << " m/s, " << slowed << " slowed");
  }
}

TEST_CASE("governor: a jerk limit alone is kept by every command") {
  const auto scene = governed({.jerk = 300, .speed = 50, .force = 1e6, .blow = 1e6});
  JointAcceleration<6> last{};
  double jerk = 0;
  int gave_way = 0, altered = 0;
  run(
      scene, 6, [](double t) { return std::fmod(t, 1.1) < 0.4 ? 0.6 : 0; },
      Overloaded{nothing, [&](double, const auto& out) {
                   gave_way += out.status.has(Reason::jerk_exceeded);
                   altered += out.status.has(Reason::step_limited) || out.status.has(Reason::outside_limits);
                   for (std::size_t i = 0; i < 6; ++i)
                     jerk = std::max(jerk, std::abs(out.planned.acceleration[i] - last[i]) / 0.008);
                   last = out.planned.acceleration;
                 }});
  CHECK(gave_way == 0);
  CHECK(altered == 0);  // the guard agrees
  CHECK(jerk <= 300 * 1.0001);
  CHECK(jerk > 200);
}

TEST_CASE("governor: a contact above its limit stops the arm, and only consent lets it go on") {
  const auto scene = governed({.speed = 50, .force = 3, .blow = 6});
  bool stopped = false, moving_again = false;
  double speed = 0;
  int slowed = 0;
  Status seen;
  // 40 N a unit of reading, a fifth of it true: 4.8 N from 0.5 s on, which is too long; nothing from 1 s on.
  run(
      scene, 4, [](double t) { return t > 0.5 && t < 1 ? 0.2 : (t > 2.5 && t < 3 ? 0.1 : 0); },
      Overloaded{[](double t, auto& input, auto&) {
                   if (t > 2 && t < 2.009) input.request = CycleRequest::resume;
                 },
                 [&](double t, const auto& out) {
                   seen |= out.status;
                   slowed += out.status.has(Reason::contact_slowed);
                   speed = 0;
                   for (const double u : out.planned.velocity) speed = std::max(speed, std::abs(u));
                   const bool waits = out.status.has(Reason::consent_awaited);
                   if (t > 0.7 && t < 2) {
                     CHECK(waits);
                     stopped = stopped || speed == 0;
                   }
                   if (t > 1.5 && t < 2) CHECK(speed == 0);
                   if (t > 2.01) CHECK_FALSE(waits);
                   moving_again = moving_again || (t > 2.5 && speed > 0.001);
                 }});
  CHECK(seen.has(Reason::contact_force));
  CHECK(stopped);
  CHECK(moving_again);
}

TEST_CASE("governor: whatever bits come in, commands stay finite, within limits and free of steps") {
  const auto scene = governed();
  const auto memory = std::make_unique<decltype(scene)::Memory>();
  const auto limits = ur5_test_limits<double>();
  oracle::Random random(5);
  const auto any_number = [&](double usual) {
    const double special[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, -5e-324, -0.0};
    const auto kind = random.index(12);
    return kind < 6 && random.index(4) == 0 ? special[kind]
           : kind == 6                      ? std::bit_cast<double>(random.bits())
                                            : usual;
  };
  int bad = 0, steps = 0;
  Status seen;
  for (int run = 0; run < (sanitized ? 20 : 200); ++run) {
    State<6> state;
    state.q = home_position();
    scene.start(*memory, state);
    auto last = memory->robot.command();
    bool begun = false;
    Nanoseconds now{};
    for (int k = 0; k < 100; ++k) {
      now += 8ms;
      typename decltype(scene)::Input input;
      input.now = random.index(20) == 0 ? static_cast<Nanoseconds>(random.bits()) : now;
      input.measured = state;
      input.measured.time = random.index(20) == 0 ? static_cast<Nanoseconds>(random.bits()) : now;
      for (double& x : input.measured.q) x = any_number(x);
      for (double& x : input.measured.dq) x = any_number(x);
      std::array<CellSample, 3> samples;
      for (auto& s : samples)
        s = {.time = now,
             .cell = static_cast<std::uint32_t>(1 + random.index(260)),
             .force = {static_cast<float>(any_number(0.3)), 0.2f, static_cast<float>(any_number(0))},
             .proximity = static_cast<float>(any_number(0.1))};
      input.samples = samples;
      if (random.index(40) == 0) input.observed = Status::from_bits(random.bits());
      input.request = random.index(10) == 0 ? CycleRequest::resume : CycleRequest::none;
      const auto out = scene.step(*memory, input);
      seen |= out.status;
      begun = begun || out.command.valid;
      bad += out.command.valid != begun;
      if (!begun) {  // no state yet, or one elsewhere; then it begins where it is asked to
        last = scene.guard().last(memory->guard);
        continue;
      }
      for (std::size_t i = 0; i < 6; ++i) {
        const double q = out.planned.position[i], v = out.planned.velocity[i];
        bad += !(q >= limits.lower()[i] && q <= limits.upper()[i]);
        bad += !(std::abs(v) <= limits.velocity()[i] * 1.0001);
        steps += !(std::abs(v - last.velocity[i]) <= limits.acceleration()[i] * 0.0801);
        steps += !(std::abs(q - last.position[i]) <= limits.velocity()[i] * 0.0801);
      }
      last = out.planned;
      state.q = out.command.position;
      state.dq = out.planned.velocity;
    }
  }
  CHECK(bad == 0);
  CHECK(steps == 0);
  for (const Reason r :
       {Reason::jerk_limited, Reason::tool_speed_limited, Reason::contact_force, Reason::state_stale,
        Reason::state_out_of_range, Reason::state_not_finite, Reason::consent_awaited}) {
    const std::string reason = describe(r);
    CAPTURE(reason);
    CHECK((sanitized || seen.has(r)));
  }
}

TEST_CASE("governor: a contact lasts by the clock, whatever time its command has") {
  // 4 N above 3 N for longer than 100 ms: at 40 ms a cycle that is the third, though each command has 8 ms.
  const auto limits = ur5_test_limits<double>();
  auto region = contact(3, 1e6);
  region.newton = 1;
  const auto g = governor_alone<Interface::position, Arm>(limits, contact_limits(Arm{}, region));
  using Alone = std::remove_const_t<decltype(g)>;
  JointCommand<6> last;
  last.valid = true;
  last.position = home_position();
  State<6> measured;
  measured.q = home_position();
  LinkWrenches<Arm, link_bit<forearm>> touch;
  touch.data[0][0] = 4;
  const std::array<double, 1> near{1};
  const TouchOf<decltype(touch), std::array<double, 1>> seen{touch, near};
  Alone::Memory memory{};
  int cycles = 0;
  for (bool stopped = false; !stopped && cycles < 50; ++cycles) {
    const auto out = g.Alone::Base::step(
        memory, {.last = last, .measured = measured, .span = 0.008, .dt = 0.04}, last, {}, seen);
    stopped = out.status.has(Reason::contact_force);
  }
  CHECK(cycles == 3);
}

TEST_CASE("governor: what is no command, or comes from none, passes to the bit: the guard refuses it") {
  const auto limits = ur5_test_limits<double>();
  const auto g = governor_alone<Interface::position, Arm>(
      limits, contact_limits(Arm{}, contact(100, 150)),
      ToolSpeed<Arm, 5>(Arm{}, limits, {.speed = 0.001, .reach = 1.3}),
      JerkLimits<6>(limits, JointJerk<6>::constant(1)));
  JointCommand<6> last, wish;
  last.valid = wish.valid = true;
  last.position = wish.position = home_position();
  wish.velocity = JointVelocity<6>::constant(1);
  const auto step = [&](double dt) {
    decltype(g)::Memory memory{};
    State<6> measured;
    measured.q = home_position();
    return g.step(memory, last, wish, measured, LinkWrenches<Arm, link_bit<forearm>>{},
                  std::array<double, 1>{1}, dt);
  };
  CHECK(step(0.008).altered);
  const auto passes = [&](double dt = 0.008) {
    const auto out = step(dt);
    CHECK_FALSE(out.altered);
    CHECK_FALSE(out.status.any());
    CHECK(out.command.velocity == wish.velocity);
    CHECK(out.command.position == wish.position);
    CHECK(out.command.valid == wish.valid);
  };
  passes(0);
  for (const double span : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    CAPTURE(span);
    using Alone = std::remove_const_t<decltype(g)>;
    Alone::Memory memory{};
    State<6> measured;
    measured.q = home_position();
    const LinkWrenches<Arm, link_bit<forearm>> untouched{};
    const std::array<double, 1> near{1};
    const auto out = g.Alone::Base::step(
        memory, {.last = last, .measured = measured, .span = span, .dt = 0.008}, wish, {},
        TouchOf<LinkWrenches<Arm, link_bit<forearm>>, std::array<double, 1>>{untouched, near});
    CHECK_FALSE(out.altered);
    CHECK(out.command.velocity == wish.velocity);
    CHECK(out.command.position == wish.position);
  }
  last.valid = false;
  passes();
  last.valid = true, wish.valid = false;
  passes();
}

namespace {
// A limit that slows every motion a little: the governor makes all of them.
template <class T>
struct SlowsAlways {
  using Kind = SlowsAlways;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::free;
  template <class Going, class Seen, class U>
  SpeedShare<T> share(Memory&, const Going&, const Seen&, const U&) const noexcept {
    return {T(0.999), {}};
  }
};
}  // namespace

TEST_CASE_TEMPLATE("governor: a slow motion arrives, and none goes past an end, not by a rounding", T, float,
                   double) {
  static constexpr T h = T(0.002);
  const auto drive = [](const JointLimits<6, T>& limits, JointCommand<6, T>& last, const T& target,
                        int cycles, auto&& each) {
    const auto g = governor_alone<Interface::position, Arm>(
        limits, SlowsAlways<T>{}, JerkLimits<6, T>(limits, JointJerk<6, T>::constant(T(400))));
    typename std::remove_cvref_t<decltype(g)>::Memory memory{};
    for (int k = 0; k < cycles; ++k) {
      JointCommand<6, T> wish = last;
      wish.velocity = JointVelocity<6, T>::constant(target);
      last = g.step(memory, last, wish, State<6, T>{}, LinkWrenches<Arm, link_bit<forearm>, T>{},
                    std::array<T, 1>{T(1)}, h)
                 .command;
      each();
    }
  };
  JointCommand<6, T> last;
  last.valid = true;
  last.position = JointPosition<6, T>::constant(T(2));
  const auto free = ur5_test_limits<T>();
  // 4e-8 rad a cycle is a sixth of what a float at 2 rad can resolve.
  drive(free, last, T(2e-5 / 0.999), 5000, [] {});
  for (const T q : last.position) CHECK(std::abs(double(q) - 2.0002) <= 5e-7);
  oracle::Random random(4);
  int beyond = 0, at_ends = 0;
  for (int run = 0; run < 15; ++run) {
    auto v = free.values();
    last = {};
    last.valid = true;
    for (std::size_t i = 0; i < 6; ++i) {
      last.position[i] = T(random.uniform(-2, 2));
      v.lower[i] = last.position[i] - T(random.uniform(0.01, 0.1));
      v.upper[i] = last.position[i] + T(random.uniform(0.01, 0.1));
    }
    for (const T target : {T(3), T(-3), T(0.1), T(-0.1)})
      drive(JointLimits<6, T>(v), last, target, 400, [&] {
        for (std::size_t i = 0; i < 6; ++i) {
          beyond += last.position[i] > v.upper[i] || last.position[i] < v.lower[i];
          at_ends += last.position[i] == v.upper[i] || last.position[i] == v.lower[i];
        }
      });
  }
  CHECK(beyond == 0);
  CHECK(at_ends > 0);
  // Who starts beyond an end comes back as a motion, not as a jump.
  for (const T side : {T(1), T(-1)}) {
    auto v = free.values();
    last = {};
    last.valid = true;
    v.upper = JointPosition<6, T>::constant(T(1)), v.lower = JointPosition<6, T>::constant(T(-1));
    last.position = JointPosition<6, T>::constant(side * T(1.1));
    JointPosition<6, T> before = last.position;
    drive(JointLimits<6, T>(v), last, -side, 200, [&] {
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(last.position[i] - before[i]) <= h * v.velocity[i]);
      before = last.position;
    });
    for (const T q : last.position) CHECK(side * q < T(1));
  }
}

TEST_CASE("governor: a cycle allocates nothing") {
  const auto scene = governed();
  const auto memory = std::make_unique<decltype(scene)::Memory>();
  std::uint64_t allocated = 0;
  std::optional<AllocationGuard> guard;
  run(
      scene, 0.5, [](double) { return 0.3; },
      Overloaded{[&](double, auto&, auto&) { guard.emplace(); },
                 [&](double, const auto&) { allocated += guard->count(); }});
  CHECK(allocated == 0);
}

TEST_CASE(
    "governor: how near somebody is tells the nearest cell of the link, and a silent one tells nothing") {
  const auto scene = governed();
  const auto& skin = scene.skin();
  auto memory = skin.start(0ns);
  CHECK(skin.max_proximity<1>(memory) == 1);
  const auto hear = [&](std::uint32_t id, float proximity, Nanoseconds now) {
    const CellSample sample{.time = now, .cell = id, .proximity = proximity};
    decltype(scene)::Wrenches mean;
    skin.receive(memory, std::span(&sample, 1), now - 1ms, now, 1, &mean);
  };
  std::uint32_t id = 1;  // ids run through the links
  for (std::size_t link = 0; link < 6; ++link)
    for (std::size_t k = 0; k < ur5::skin_cells<260>[link]; ++k, ++id) {
      if (link == 1 && k + 1 == ur5::skin_cells<260>[1]) CHECK(skin.max_proximity<1>(memory) == 1);
      hear(id, link == 2 && k == 3 ? 0.625f : 0, 2ms);
      if (link == 1 && k + 1 == ur5::skin_cells<260>[1])
        CHECK(skin.max_proximity<1>(memory) == doctest::Approx(0.05).epsilon(1e-3));
    }
  CHECK(skin.max_proximity<2>(memory) == 0.625);  // the gate passes less: 0.05 is taken off
  CHECK(skin.max_proximity<1>(memory) == doctest::Approx(0.05).epsilon(1e-3));
}
