// Promise: a base that gives way is joints like others: metres and radians keep their limits side by side
// Tried: a base by velocity under an arm by position, pushed by up to 400 N, with NaN states and silences:
// base, arm and the tool in the world keep their limits, a wall is kept clear, runs replay bit for bit

#include <doctest/doctest.h>

#include <deque>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/configurations.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/clearance_limits.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/sliding_robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// x, y, yaw, and one joint of an arm that turns about the upward axis, 0.3 m before the middle of the base.
using Tree = ChainOf<slides, slides, turns, turns>;
using Robot = CalibratedModel<Tree>;
Robot robot() {
  auto links = on_wheels<Tree>(40);
  links[3].p[0] = 0.3;
  links[3].inertia = {4, {0.2, 0, 0}, 0.05, 0.05, 0.05};
  return model_of<Tree>(links);
}
constexpr double base_speed = 0.6, base_turn = 0.8, tool_most = 0.4;
const JointLimits<3> base_limits({.lower = {-1.5, -1, -3},
                                  .upper = {1.5, 1, 3},
                                  .velocity = {base_speed, base_speed, base_turn},
                                  .acceleration = {1, 1, 2},
                                  .torque = {300, 300, 100}});
const JointLimits<1> arm_limits({.lower = JointPosition<1>::constant(-2),
                                 .upper = JointPosition<1>::constant(2),
                                 .velocity = JointVelocity<1>::constant(2),
                                 .acceleration = JointAcceleration<1>::constant(10),
                                 .torque = JointTorque<1>::constant(80)});

/// Cells on the four sides of the arm's middle: their axes in the arm's.
const Rotation<double> towards[4] = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                     {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
                                     {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                     {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}};
constexpr double newtons_per_reading = 150;

auto scene() {
  RobotConfiguration<3> base{
      .limits = base_limits, .period = 4ms, .delay = 20ms, .lag = 30ms, .virtual_damping = 0.5};
  base.dead_band = {0.2, 0.2, 0.2};  // its way to stop, v^2/(2 a): the leash holds rest points
  RobotConfiguration<1> arm{.limits = arm_limits, .period = 4ms, .delay = 4ms, .virtual_damping = 0.5};
  std::vector<PlacedCell<3>> cells;
  for (std::uint32_t i = 0; i < 4; ++i) cells.push_back({i + 1, {towards[i], {0.3, 0, 0}}});
  return Cycle(by_groups(robot(), velocity_joints<0b0111>(base), position_joints<0b1000>(arm)),
               Skin<Robot, double, Patch<3, 4>>(Patch<3, 4>(cells, {.force = newtons_per_reading})),
               SkinJointControl{} + GravityControl{});
}
Xyz<double> tool_at(const JointPosition<4>& q) {
  const auto X = link_poses(robot(), q).get<3>();
  return X.origin() + X.axes() * Xyz<double>{0.4, 0, 0};
}

struct Course {
  JointVelocity<4> fastest, hardest;
  double tool = 0, sent = 0, nearest = 1, far = 0, beyond = -1;
  Status said;
  std::uint64_t allocated = 0;
};
/// 24 s of pushes at random cells; `spoil(input, cycle)`.
template <class Scene, class Spoil, class Record>
Course push(const Scene& pushed, const Spoil& spoil, const Record& record) {
  auto rng = seeded(5);
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<4> real;
  pushed.start(*memory, real);
  Course out;
  std::deque<JointVelocity<4>> late(6);
  CellSample samples[4];
  Xyz<double> force{0, 0, 0};
  JointVelocity<4> sent_before;
  for (int k = 1; k <= 6000; ++k) {
    real.time = k * 4ms;
    if (k % 300 == 1) {  // somebody pushes along another direction, or not
      const double turn = uniform(rng, -M_PI, M_PI);
      force = uniform(rng, 0.0, 1.0) < 0.7
                  ? uniform(rng, 20.0, 400.0) * Xyz<double>{std::cos(turn), std::sin(turn), 0}
                  : Xyz<double>{0, 0, 0};
    }
    const Rotation<double> R = link_poses(robot(), real.q).get<3>().axes();
    for (std::uint32_t i = 0; i < 4; ++i) {
      const auto f = float(std::max(0.0, -dot(force, R * towards[i].z)) / (3 * newtons_per_reading));
      samples[i] = {.cell = i + 1, .force = {f, f, f}};
    }
    for (auto& s : samples) s.time = real.time;
    typename Scene::Input input;
    input.now = real.time;
    input.measured = real;
    input.samples = samples;
    spoil(input, k);
    const AllocationGuard guard;
    const auto sent = pushed.step(*memory, input);
    out.allocated += guard.count();
    record(input, sent.planned);
    out.said |= sent.status;
    for (std::size_t i = 0; i < 4; ++i) {
      const double v = sent.planned.velocity[i];
      REQUIRE(std::isfinite(v));
      out.fastest[i] = std::max(out.fastest[i], std::abs(v));
      out.hardest[i] = std::max(out.hardest[i], std::abs(v - sent_before[i]) / 0.004);
      sent_before[i] = v;
    }
    const auto& q = sent.planned.position;
    const auto u = sent.planned.velocity;
    out.sent = std::max(
        out.sent,
        norm(Xyz<double>((1 / 2e-6) * (tool_at(integrate(q, u, 1e-6)) - tool_at(integrate(q, u, -1e-6))))));
    const auto tool = tool_at(real.q);
    late.push_back(sent.planned.velocity);
    for (std::size_t i = 0; i < 3; ++i) {
      real.dq[i] += 0.004 / 0.03 * (late.front()[i] - real.dq[i]);
      real.q[i] += 0.004 * real.dq[i];
    }
    late.pop_front();
    real.dq[3] = (sent.planned.position[3] - real.q[3]) / 0.004;
    real.q[3] = sent.planned.position[3];
    out.tool = std::max(out.tool, norm(Xyz<double>(tool_at(real.q) - tool)) / 0.004);
    out.nearest = std::min(out.nearest, 1.0 - tool_at(real.q).x);
    out.far = std::max(out.far, std::abs(real.q[0]));
    for (std::size_t i = 0; i < 4; ++i) {
      const double end = i < 3 ? base_limits.upper()[i] : arm_limits.upper()[0];
      out.beyond = std::max(out.beyond, std::abs(real.q[i]) - end);
    }
  }
  return out;
}
constexpr auto as_it_is = [](auto&, int) {};
constexpr auto not_recorded = [](const auto&, const auto&) {};
void keeps_limits(const Course& c) {
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(c.fastest[i] <= base_limits.velocity()[i] + 1e-9);
    CHECK(c.hardest[i] <= base_limits.acceleration()[i] * 1.0001);
  }
  CHECK(c.fastest[3] <= 2 + 1e-9);
  CHECK(c.hardest[3] <= 10.001);
  CHECK(c.allocated == 0);
  CHECK(c.beyond < 0.01);  // the base by its lag
}

}  // namespace

TEST_CASE("A base that gives way: limits of metres and of radians, each its own") {
  const Course c = push(scene(), as_it_is, not_recorded);
  keeps_limits(c);
  CHECK(c.fastest[0] > 0.99 * base_speed);  // it uses them
  CHECK(c.fastest[3] > 0.5);
  CHECK(c.far > 1);
  CHECK(c.said.has(Reason::position_limited));
}

TEST_CASE("A base that gives way: the tool's speed is that in the world, of base and arm together") {
  const MaxToolSpeed<3> slow{.speed = tool_most, .point = {0.4, 0, 0}, .reach = 0.75};
  const auto limited = scene().with(slow);
  const Course c = push(limited, as_it_is, not_recorded);
  keeps_limits(c);
  CHECK(c.said.has(Reason::tool_speed_limited));
  CHECK(c.sent < 1.001 * tool_most);
  CHECK(c.sent > 0.95 * tool_most);
  CHECK(c.tool < 1.3 * tool_most);  // the base follows 50 ms later than the arm
  const Course bare = push(limited.without<ToolSpeedLimit>(), as_it_is, not_recorded);
  CHECK(bare.sent > 1.5 * tool_most);
}

TEST_CASE(
    "A base that gives way: stays clear of a wall, whether base or arm would reach it; jerk limited beside") {
  Clearance wall;
  wall.capsules = {{3, {{0, 0, 0}, {0.4, 0, 0}, 0.03}},
                   {2, {{-0.2, 0, 0}, {0.2, 0, 0}, 0.2}},
                   {LinkCapsule::fixed, {{1.1, -3, 0}, {1.1, 3, 0}, 0.1}}};
  wall.pairs = {{0, 2}, {1, 2}};
  wall.reach = 0.75;
  const auto check = [&](const auto& clear) {
    const Course c = push(clear, as_it_is, not_recorded);
    keeps_limits(c);
    CHECK(c.said.has(Reason::clearance_kept));
    CHECK(c.nearest > 0.03);  // the surface of the arm's end; the base comes later by its lag
    CHECK(c.nearest < 0.2);
  };
  check(scene().with(wall));
  check(scene().with(wall, MaxJerk{JointJerk<4>{10, 10, 20, 100}}));
  CHECK(push(scene(), as_it_is, not_recorded).nearest < -0.3);
}

TEST_CASE("A base that gives way: states that are no number, silence and stops; it replays bit for bit") {
  const auto spoil = [](auto& input, int k) {
    if (k % 97 < 3) input.measured.q[std::size_t(k) % 4] = std::nan("");
    if (k % 131 < 2) input.measured.dq[std::size_t(k) % 4] = HUGE_VAL;
    if (k % 1001 > 900) input.measured.time -= 2s;
    if (k % 1500 == 700) input.request = CycleRequest::stop;
    if (k % 1500 == 900) input.request = CycleRequest::resume;
  };
  const auto pushed = scene().with(MaxToolSpeed<3>{.speed = tool_most, .point = {0.4, 0, 0}, .reach = 0.75});
  using Scene = std::remove_const_t<decltype(pushed)>;
  Recording<Scene> recording(std::size_t(8) << 20);
  recording.start(State<4>{});
  const Course c =
      push(pushed, spoil, [&](const auto& input, const auto& sent) { recording.add(input, sent); });
  keeps_limits(c);
  CHECK(c.said.has(Reason::state_not_finite));
  CHECK(c.said.has(Reason::state_stale));
  const auto again = replay(pushed, recording);
  CHECK(again.cycles == 6000);
  CHECK(again.different == 0);
  // And as one of two configurations.
  const Configurations both(pushed, pushed);
  const Course changes =
      push(both, [](auto& input, int k) { input.configuration = unsigned(k) / 500 % 2; }, not_recorded);
  keeps_limits(changes);
}
