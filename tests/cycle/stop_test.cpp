// A stop always ends, whatever limits a scene has and whichever joint is held fast; so does what follows a
// touch.
//
// Promise: a stop ends with limits of jerk, tool speed and clearance, whichever joint is held fast,
// within V/A + 2 A/J, and a joint that is held makes no arm swing
// Tried: UR5 by position and velocity, 384 runs with random periods, delays, lags, late cycles,
// accelerations and jerks from 20 rad/s^3, 100 beside clearances: below 1e-6 rad/s; velocity,
// acceleration and jerk kept in the servo's time, in stops too, but where cycles come late and the jerk of a
// joint by velocity gives way to its end; 32 robots in groups

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/clearance_limits.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/grouped_scene.hpp"
#include "tests/support/ur5_clearance.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// Torques that turn, until `until`.
struct Push {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  JointTorque<6> tau;
  JointVelocity<6> turn;
  double until = 0;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<6> torque(const Memory&, const K& known) const noexcept {
    const double t = seconds<double>(known.time());
    JointTorque<6> out;
    for (std::size_t i = 0; i < 6 && t < until; ++i) out[i] = tau[i] * std::cos(turn[i] * t);
    return out;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

enum class Ends { by_stop, by_law };  ///< a request, or the torque ends
constexpr double rest_after = 9;      ///< time until all has to be at rest after a law's end [s]
constexpr double rests = 1e-6;        ///< speed of a joint at rest [rad/s]

struct Ending {
  double speed = 0;          ///< fastest joint of the commands after `rest_after`
  Status before, during;     ///< until the end, and after it
  bool keeps_limits = true;  ///< velocity and acceleration, in the servo's time
  double jerk = 0;           ///< largest change of acceleration, as a share of what the limit of jerk allows
  double tool = 0;           ///< largest way of the tool in a period, as a share of its limit
  bool late = false;         ///< whether cycles came late
};

Xyz<double> tool_at(const JointPosition<6>& q) {
  return Poses<ur5::Model, closure<ur5::Model>(link_bit<5>)>(ur5::Model{}, q).get<5>().origin();
}

/// A UR5 with random configuration, limits and torques, whose cycles are late now and then.
enum class Parts { jerk, jerk_and_tool, clearance };
template <Interface I, Parts P>
Ending end_of(std::uint64_t seed, Ends ends, bool held) {
  std::mt19937_64 rng(seed);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  constexpr Nanoseconds periods[] = {1ms, 2ms, 4ms, 8ms, 10ms};
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(roll(3, 40)),
                          .period = periods[rng() % 5],
                          .delay = nanoseconds(roll(0, 0.02)),
                          .lag = nanoseconds(roll(0, 0.02)),
                          .virtual_damping = roll(1, 6)};
  MaxJerk<6> jerk{};
  for (double& j : jerk.jerk) j = 20 * std::pow(5000.0, roll(0, 1));
  Push push;
  for (std::size_t i = 0; i < 6; ++i)
    push.tau[i] = c.limits.torque()[i] * roll(-0.5, 0.5), push.turn[i] = roll(0, 6);
  const std::size_t joint = rng() % 6;
  const double end = roll(0.3, 2), holds = roll(0.1, end);
  push.until = ends == Ends::by_law ? end : 1e9;
  const double tool_speed = roll(0.02, 0.3), late = rng() % 2 == 0 ? 0.0 : 0.1;
  // The quickest stop under A and J, and what is under way.
  double stops_in = 0;
  for (std::size_t i = 0; i < 6; ++i)
    stops_in =
        std::max(stops_in, c.limits.velocity()[i] / c.limits.acceleration()[i] +
                               (P == Parts::clearance ? 0 : 2 * c.limits.acceleration()[i] / jerk.jerk[i]));
  const auto law = push + GravityControl{};
  const auto scene = [&] {
    const auto plain = [&] {
      if constexpr (I == Interface::position) {
        return Cycle(by_position(ur5::Model{}, c), law);
      } else {
        return Cycle(by_velocity(ur5::Model{}, c), law);
      }
    }();
    const MaxToolSpeed<5> tool{.speed = tool_speed, .reach = 1.3};
    if constexpr (P == Parts::clearance) {
      return plain.with(ur5_clearance<1>().own);
    } else if constexpr (P == Parts::jerk_and_tool) {
      return plain.with(jerk, tool);
    } else {
      return plain.with(jerk);
    }
  }();
  using Joints = SimulatedJoints<6>;
  const Joints::Row home{0, -1.2, 1.4, -1.8, -1.57, 0.3};
  Joints robot(I == Interface::position ? Joints::Kind::position : Joints::Kind::velocity,
               seconds<double>(c.delay), seconds<double>(c.lag), home);
  State<6> measured;
  const auto measure = [&](Nanoseconds now) {
    measured.time = now;
    for (std::size_t i = 0; i < 6; ++i) measured.q[i] = robot.q()[i], measured.dq[i] = robot.dq()[i];
  };
  measure(0ns);
  auto memory = scene.start(measured);
  Ending out;
  JointVelocity<6> last;
  JointAcceleration<6> before;
  JointPosition<6> at = measured.q;
  bool stopped = ends == Ends::by_law;
  Nanoseconds now{}, asked{};
  while (seconds<double>(now) < end + rest_after + 1) {
    const bool is_late = roll(0, 1) < late;
    out.late = out.late || is_late;
    now += c.period * (is_late ? 2 + long(rng() % 4) : 1);
    const double t = seconds<double>(now), dt = seconds<double>(c.period);
    robot.advance(t);
    if (held && t > holds) robot.hold_fast(joint, true);
    measure(now);
    typename std::remove_cvref_t<decltype(scene)>::Input input;
    input.now = now;
    input.measured = measured;
    if (t > end && !stopped) input.request = CycleRequest::stop, stopped = true, asked = now;
    const auto result = scene.step(memory, input);
    const auto& v = result.planned.velocity;
    (t > end ? out.during : out.before) |= result.status;
    Joints::Row sent{};
    for (std::size_t i = 0; i < 6; ++i) {
      sent[i] = I == Interface::position ? result.planned.position[i] : v[i];
      out.keeps_limits = out.keeps_limits && std::abs(v[i]) <= 1.0001 * c.limits.velocity()[i] &&
                         std::abs(v[i] - last[i]) <= 1.0001 * c.limits.acceleration()[i] * dt;
      out.jerk = std::max(
          out.jerk, (std::abs(result.planned.acceleration[i] - before[i]) - 1e-9) / (jerk.jerk[i] * dt));
      // A late cycle takes a period of the stop, and leaves the rest to those that follow.
      const double rest_in = ends == Ends::by_stop ? (late > 0 ? 6 : 1) * stops_in + 8 * dt : rest_after;
      const double since = ends == Ends::by_stop ? seconds<double>(now - asked) : t - end;
      if (stopped && since > rest_in) out.speed = std::max(out.speed, std::abs(v[i]));
    }
    if constexpr (I == Interface::position) {
      const auto from = tool_at(at), to = tool_at(result.planned.position);
      out.tool = std::max(out.tool, std::sqrt(dot(to - from, to - from)) / (tool_speed * dt));
      at = result.planned.position;
    }
    last = v;
    before = result.planned.acceleration;
    robot.command(t, sent);
  }
  return out;
}

}  // namespace

TEST_CASE_TEMPLATE("Cycle: with limits of jerk and tool speed every stop ends, whichever joint is held", C,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>) {
  // By velocity the last two met the ends of joints with more speed than their jerk allowed.
  std::vector<std::uint64_t> seeds{1018, 1050};
  for (std::uint64_t seed = 1; seed <= rounds(40u); ++seed) seeds.push_back(seed);
  for (const std::uint64_t seed : seeds)
    for (const Ends ends : {Ends::by_stop, Ends::by_law})
      for (const bool held : {false, true}) {
        if (ends == Ends::by_law && !held) continue;  // a free robot's law decides when it rests
        CAPTURE(seed);
        CAPTURE(ends == Ends::by_stop);
        CAPTURE(held);
        const auto with_jerk = end_of<C::value, Parts::jerk>(seed, ends, held);
        const auto with_both = end_of<C::value, Parts::jerk_and_tool>(seed, ends, held);
        for (const auto& e : {with_jerk, with_both}) {
          CHECK(e.speed < (ends == Ends::by_stop ? rests : 1e-3));  // a law's end leaves the friction
          CHECK(e.keeps_limits);
        }
        const bool says_so = (with_jerk.before | with_jerk.during).has(Reason::jerk_exceeded);
        if (!says_so) CHECK(with_jerk.jerk <= 1.0001);
        if (says_so) CHECK((C::value == Interface::velocity && with_jerk.late));
        CHECK(with_both.tool <= 1.03);  // in cycles in which jerk gives way
      }
}

TEST_CASE(
    "Cycle: an arm that holds a goal comes back to it and rests, with gains that fit its limit of jerk") {
  for (const double jerk : {100.0, 500.0, 1e4})
    for (const Nanoseconds period : {1ms, 8ms}) {
      CAPTURE(jerk);
      CAPTURE(period.count());
      const RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0),
                                    .period = period,
                                    .delay = period,
                                    .lag = 20ms,
                                    .virtual_damping = 4};
      const auto arm = by_position(ur5::Model{}, c);
      const auto limit = JointJerk<6>::constant(jerk);
      // With the gains of a robot without this limit it swings by 0.3 rad/s after the push, at 100 rad/s^3.
      const auto fitting = tracking_settings(arm, limit);
      const auto speed_left = [&](const JointControlSettings<6>& gains) {
        const auto scene =
            Cycle(arm, SplineJoint<6>(gains) + Push{{30, -40, 20, 5, 5, 2}, {}, 4} + GravityControl{})
                .with(MaxJerk<6>{limit});
        using Scene = std::remove_const_t<decltype(scene)>;
        const JointPosition<6> home{0, -1.2, 1.4, -1.8, -1.57, 0.3};
        SimulatedJoints<6> robot(SimulatedJoints<6>::Kind::position, seconds<double>(c.delay), 0.02,
                                 std::to_array(home.data));
        const auto memory = std::make_unique<Scene::Memory>();
        scene.start(*memory, {0ns, home, {}});
        double fastest = 0;
        const double ends = 10 + 5 / gains.K_i1;  // the integrals leave last
        for (int k = 1; seconds<double>(k * period) < ends; ++k) {
          const double t = seconds<double>(k * period);
          robot.advance(t);
          Scene::Input input;
          input.now = input.measured.time = k * period;
          for (std::size_t i = 0; i < 6; ++i)
            input.measured.q[i] = robot.q()[i], input.measured.dq[i] = robot.dq()[i];
          if (k == 1) input.goal = {home, 1s};
          const auto out = scene.step(*memory, input);
          for (std::size_t i = 0; t > ends - 1 && i < 6; ++i)
            fastest = std::max(fastest, std::abs(out.planned.velocity[i]));
          robot.command(t, std::to_array(out.planned.position.data));
        }
        return fastest;
      };
      CHECK(speed_left(fitting) < 1e-3);
      if (jerk == 100) CHECK_THROWS_AS(speed_left(tracking_settings(arm)), ConfigurationError);
    }
}

TEST_CASE("Cycle: a stop beside a clearance ends, whichever joint is held") {
  for (std::uint64_t seed = 1; seed <= rounds(100u); ++seed) {
    CAPTURE(seed);
    const auto e = end_of<Interface::position, Parts::clearance>(seed, Ends::by_stop, true);
    CHECK(e.speed < rests);
    CHECK(e.keeps_limits);
  }
}

TEST_CASE("Groups: with a limit of jerk every stop ends, whichever joint is held") {
  for (std::uint64_t seed = 1; seed <= rounds(40u); ++seed) {
    CAPTURE(seed);
    std::mt19937_64 rng(seed);
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    const auto joint = [&](bool driven) {
      auto c = one(driven);
      auto v = c.limits.values();
      v.acceleration[0] = roll(3, 40);
      c.limits = JointLimits<1>(v);
      return c;
    };
    auto column = joint(false);
    column.lag = 0ms;
    const auto arm = by_groups(Model3{}, velocity_joints<0b001>(column), position_joints<0b010>(joint(false)),
                               torque_joints<0b100>(one(true)));
    MaxJerk<3> jerk{};
    for (double& j : jerk.jerk) j = 20 * std::pow(5000.0, roll(0, 1));
    Run run{Cycle(arm, Pull{{roll(-8, 8), roll(-8, 8), roll(-0.2, 0.2)}, {}, {}}).with(jerk)};
    const std::size_t held = rng() % 3;  // 2: none
    for (int k = 0; k < 150 + int(rng() % 150); ++k) {
      if (k == 100 && held < 2) run.plant.hold_fast(held);
      run.cycle();
    }
    decltype(run.scene)::Input input;
    input.request = CycleRequest::stop;
    run.cycle(input);
    double speed = 0;
    for (int k = 0; k < 3000; ++k) {
      const auto& v = run.cycle().command.velocity;
      if (k > 2500) speed = std::max(speed, std::max(std::abs(v[0]), std::abs(v[1])));
    }
    CHECK(speed < rests);
  }
}
