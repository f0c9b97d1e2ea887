// Closed loops by torque with the default gains: the declared delay, and masses that are not as told.
#include <doctest/doctest.h>

#include <cmath>
#include <deque>
#include <memory>
#include <string>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// A 7-joint arm with the joints of an FR3; masses are made up.
struct SevenDescription {
  static constexpr std::size_t joints = 7;
  static constexpr auto parents = chain_parents<7>();
  static constexpr auto kinds = all_of_kind<7>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 7> links = {
      make_link({.p = {0, 0, 0.333}}, {3, {0, -0.03, -0.07}, 0.02, 0.02, 0.01}),
      make_link({.alpha = Angle::quarter(-1)}, {3, {0, -0.07, 0.03}, 0.02, 0.01, 0.02}),
      make_link({.p = {0, -0.316, 0}, .alpha = Angle::quarter(1)},
                {2.5, {0.04, 0.03, -0.05}, 0.01, 0.01, 0.01}),
      make_link({.p = {0.0825, 0, 0}, .alpha = Angle::quarter(1)},
                {2.5, {-0.04, 0.05, 0.03}, 0.01, 0.01, 0.01}),
      make_link({.p = {-0.0825, 0.384, 0}, .alpha = Angle::quarter(-1)},
                {2, {0, 0.04, -0.1}, 0.02, 0.02, 0.005}),
      make_link({.alpha = Angle::quarter(1)}, {1.5, {0.05, 0, 0}, 0.003, 0.005, 0.005}),
      make_link({.p = {0.088, 0, 0}, .alpha = Angle::quarter(1)}, {0.7, {0, 0, 0.08}, 0.002, 0.002, 0.001})};
  static constexpr std::array<double, 7> lower = {-2.8, -1.7, -2.8, -3.0, -2.8, 0.0, -2.8};
  static constexpr std::array<double, 7> upper = {2.8, 1.7, 2.8, -0.1, 2.8, 3.7, 2.8};
  static constexpr std::array<double, 7> max_velocity = {2.1, 2.1, 2.1, 2.1, 2.6, 2.6, 2.6};
  static constexpr std::array<double, 7> max_torque = {87, 87, 87, 87, 12, 12, 12};
};

struct Ur5 {
  using Arm = Loaded<ur5::Model, 5>;
  using Description = ur5::Description;
  static constexpr JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
  static Arm with(const LinkInertia& load) { return Arm(ur5::Model{}, load); }
};
struct Seven {
  using Arm = Loaded<StaticModel<SevenDescription>, 6>;
  using Description = SevenDescription;
  static constexpr JointPosition<7> home{0.0, -0.4, 0.0, -2.0, 0.0, 1.7, 0.0};
  static Arm with(const LinkInertia& load) { return Arm(StaticModel<SevenDescription>{}, load); }
};

LinkInertia gripped(double mass) {
  if (mass == 0) return {};
  return {.mass = mass, .c = {0, 0, 0.15}, .xx = 0.002 * mass, .yy = 0.002 * mass, .zz = 0.002 * mass};
}

/// The declared times, which are the true ones.
struct Loop {
  Nanoseconds period, delay;
};
constexpr Loop fr3_loop{1ms, 2ms};
/// What is told and what is so.
struct Truth {
  Loop loop;
  double told = 0, carried = 0;        ///< payload [kg]
  double rotors = 0, real_rotors = 0;  ///< at each joint [kg m^2]
  bool may_be_empty = false;           ///< told: the gains are those for a robot that may carry nothing
};
struct Seen {
  double peak = 0;  ///< greatest speed of a joint [rad/s]
  double late = 0;  ///< the same from 6 to 8 s
  double off = 0;   ///< largest distance of a joint from its goal at the end [rad]
};

/// A goal for all joints, 0.4 rad away in 1.5 s.
template <class Robot>
Seen reach(const Truth& t) {
  using Arm = typename Robot::Arm;
  constexpr std::size_t N = Arm::joints;
  const auto describe = [&](double load) {
    return by_torque(Robot::with(gripped(load)),
                     {.limits = limits_of<typename Robot::Description>(15.0),
                      .period = t.loop.period,
                      .delay = t.loop.delay,
                      .virtual_inertia = JointTorque<N>::constant(t.rotors)},
                     FrictionUncompensated{});
  };
  const auto arm = describe(t.told);
  const auto gains = t.may_be_empty ? tracking_settings(arm, describe(0)) : tracking_settings(arm);
  const Cycle cycle(arm, SplineJoint<N>(gains) + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(cycle)>;

  const Arm real = Robot::with(gripped(t.carried));
  const auto rotors = JointTorque<N>::constant(t.real_rotors);
  State<N> x{0ns, Robot::home, {}};
  const auto memory = std::make_unique<typename Scene::Memory>();
  cycle.start(*memory, x);
  JointTorque<N> tau = memory->robot.command().torque;
  std::deque<std::pair<Nanoseconds, JointTorque<N>>> under_way;
  auto goal = Robot::home;
  for (std::size_t i = 0; i < N; ++i) goal[i] += i % 2 == 0 ? 0.4 : -0.3;
  typename Scene::Input input;
  Seen seen;
  constexpr Nanoseconds step = 100us;
  for (Nanoseconds now = t.loop.period; now <= 8s; now += t.loop.period) {
    for (; x.time < now; x.time += step) {
      for (; !under_way.empty() && under_way.front().first <= x.time; under_way.pop_front())
        tau = under_way.front().second;
      x.dq = integrate(x.dq, acceleration(real, x, tau, rotors), seconds<double>(step));
      x.q = integrate(x.q, x.dq, seconds<double>(step));
      for (const double v : x.dq) {
        seen.peak = std::max(seen.peak, std::abs(v));
        if (now > 6s) seen.late = std::max(seen.late, std::abs(v));
      }
    }
    input.now = now;
    input.measured = x;
    input.goal.reset();
    if (now == 50 * t.loop.period) input.goal = {goal, 1500ms};
    under_way.push_back({now + t.loop.delay, cycle.step(*memory, input).command.torque});
  }
  for (std::size_t i = 0; i < N; ++i) seen.off = std::max(seen.off, std::abs(x.q[i] - goal[i]));
  return seen;
}
constexpr double fastest = 0.75;  ///< [rad/s]: the spline's peak is 0.5

}  // namespace

TEST_CASE("by torque: the default gains suit the delay that is declared, and the arm rests") {
  for (const auto& loop : {Loop{1ms, 0ms}, {1ms, 5ms}, {1ms, 6ms}, {2ms, 8ms}, {2ms, 12ms}, {8ms, 20ms}})
    for (const double rotors : {0.0, 0.1}) {
      CAPTURE(milliseconds(loop.period));
      CAPTURE(milliseconds(loop.delay));
      CAPTURE(rotors);
      const Seen seen = reach<Ur5>({.loop = loop, .rotors = rotors, .real_rotors = rotors});
      CHECK(seen.peak < fastest);
      CHECK(seen.late < 1e-3);
      CHECK(seen.off < 2e-3);
    }
}

TEST_CASE("by torque: with rotors that nobody declared no joint runs away") {
  for (const auto& loop : {Loop{1ms, 6ms}, {2ms, 8ms}, {2ms, 12ms}, {8ms, 20ms}}) {
    CAPTURE(milliseconds(loop.period));
    CAPTURE(milliseconds(loop.delay));
    CHECK(reach<Ur5>({.loop = loop, .real_rotors = 0.05}).peak < 1);
  }
}

TEST_CASE("by torque: a payload that is told but not in the gripper, and one that is there untold, rest") {
  for (const double rotors : {0.0, 0.05})  // undeclared
    for (const double mass : {1.5, 2.0}) {
      CAPTURE(rotors);
      CAPTURE(mass);
      const Seen lost = reach<Seven>({.loop = fr3_loop, .told = mass, .real_rotors = rotors});
      CHECK(lost.peak < fastest);
      CHECK(lost.late < 1e-3);
      CHECK(lost.off < 2e-3);
      CHECK(reach<Seven>({.loop = fr3_loop, .carried = mass, .real_rotors = rotors}).peak < 1);
    }
}

TEST_CASE("by torque: gains for a robot that may be lighter than told hold a payload that is lost") {
  for (const double mass : {0.0, 1.5, 3.0})
    for (const double carried : {0.0, 0.5 * mass, mass})
      for (const auto& loop : {Loop{1ms, 2ms}, {2ms, 8ms}}) {
        CAPTURE(mass);
        CAPTURE(carried);
        CAPTURE(milliseconds(loop.period));
        const Seen seen = reach<Seven>({.loop = loop,
                                        .told = mass,
                                        .carried = carried,
                                        .rotors = 0.1,
                                        .real_rotors = 0.1,
                                        .may_be_empty = true});
        CHECK(seen.peak < 1);
        CHECK(seen.late < 5e-3);
      }
  // Without the rotors' inertia the wrist may be lighter by any factor.
  std::string why;
  try {
    reach<Seven>({.loop = fr3_loop, .told = 3, .may_be_empty = true});
  } catch (const ConfigurationError& e) {
    why = e.what();
  }
  CAPTURE(why);
  CHECK(why.find("mass ratio = ") != std::string::npos);
  CHECK(why.find("declare the rotors' inertia") != std::string::npos);
}
