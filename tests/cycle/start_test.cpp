// runs long: starts of every robot
// A start is an input like any other: a scene that was started elsewhere than the robot stands commands
// nothing.
#include <doctest/doctest.h>

#include <memory>
#include <optional>

#include "skinctl/cycle/configurations.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/grouped_scene.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN(), infinite = HUGE_VAL;
constexpr Nanoseconds period = 2ms;
constexpr double dt = 2e-3, most_speed = 3, most_acceleration = 40, end = 2;  // of `limits`
// With no delay: B0 + A T^2/2 + V (T + t_u).
constexpr double dead_band = 0.02,
                 threshold = dead_band + 0.5 * most_acceleration * dt * dt + most_speed * (dt + 0.05),
                 resting = 0.2 * dead_band / (dt + 0.05);

RobotConfiguration<3> all_alike(bool stiff) {
  RobotConfiguration<3> c{.limits = limits<3>(stiff ? 150 : 30), .period = period};
  if (stiff) c.virtual_damping = 5;
  return c;
}
auto arm_by_position() {
  return by_position(Model3{}, all_alike(true));
}
auto arm_by_velocity() {
  return by_velocity(Model3{}, all_alike(true));
}
auto arm_by_torque() {
  return by_torque(Model3{}, all_alike(false), FrictionUncompensated{});
}
auto arm_in_groups() {
  RobotConfiguration<1> column{.limits = limits<1>(150), .period = period}, finger = column;
  finger.limits = limits<1>(0.7);
  column.virtual_damping = 5;
  return by_groups(Model3{}, velocity_joints<0b001>(column), position_joints<0b010>(column),
                   torque_joints<0b100>(finger));
}
// The joints by velocity and by torque of a robot; the others take positions.
struct Sets {
  LinkMask velocity, torque;
};
template <class Robot>
constexpr Sets sets_of{0, 0};
template <>
constexpr Sets sets_of<decltype(arm_by_velocity())>{0b111, 0};
template <>
constexpr Sets sets_of<decltype(arm_by_torque())>{0, 0b111};
template <>
constexpr Sets sets_of<decltype(arm_in_groups())>{0b001, 0b100};

const Pull holds{{}, {20, 20, 0.1}, {0.3, 0.2, 0.1}};

double beyond_limits(double q) {
  return std::max(0.0, std::abs(q) - end);
}

// A robot that goes on as it is until a valid command comes, and follows at once; joints by torque stay.
template <class Scene, Sets sets>
struct Robot {
  const Scene& scene;
  State<3> state;
  typename Scene::Memory memory{};
  typename Scene::Output out{};
  std::optional<JointCommand<3>> last{};  ///< the last valid command
  Status seen{};

  void start(const State<3>& where) { scene.start(memory, where); }
  const Status& cycle(typename Scene::Input input = {}) {
    input.now = state.time += period;
    if (!last) state.q = integrate(state.q, state.dq, dt);
    input.measured = state;
    return step(input);
  }
  const Status& step(const typename Scene::Input& input) {
    out = scene.step(memory, input);
    seen |= out.status;
    const auto& c = out.planned;
    if (!c.valid) return out.status;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool by_torque = (sets.torque >> i & 1) != 0, by_velocity = (sets.velocity >> i & 1) != 0;
      const double q = c.position[i], v = c.velocity[i];
      if (by_torque) {
        const double most = sets.torque == 0b111 ? 30 : 0.7;
        CHECK(std::abs(c.torque[i]) <= most);
        if (last) CHECK(std::abs(c.torque[i] - last->torque[i]) <= 50 * most * dt * (1 + 1e-9));
        continue;
      }
      const double from = last ? last->velocity[i] : state.dq[i];
      CHECK(std::abs(v - from) <= most_acceleration * dt * (last ? 1 + 1e-9 : 2) + (last ? 0 : resting));
      if (!last) {
        CHECK(std::abs(q - state.q[i]) <= threshold * (1 + 1e-9));
        CHECK(beyond_limits(q) <= beyond_limits(state.q[i]) + dead_band * (1 + 1e-9));
      } else if (!by_velocity) {
        CHECK(std::abs(q - last->position[i]) <= most_speed * dt * (1 + 1e-9));
        const bool brakes = std::abs(v) < std::abs(from);
        CHECK((brakes || beyond_limits(q) <= beyond_limits(last->position[i]) + 1e-12));
      }
      state.q[i] = by_velocity ? state.q[i] + v * dt : q;
      state.dq[i] = v;
    }
    last = c;
    return out.status;
  }
};
template <class Description>
auto robot_of(const Description&, const auto& scene, const State<3>& at) {
  return Robot<std::remove_cvref_t<decltype(scene)>, sets_of<Description>>{scene, at};
}

// A state that no start should be believed from, and whether one number of it suffices to tell.
State<3> somewhere(Random& random, const State<3>& robot, int kind) {
  State<3> s = robot;
  const auto i = static_cast<std::size_t>(random() % 3);
  switch (kind) {
    case 0:  // never read
      s.q = {}, s.dq = {};
      break;
    case 1:
      for (double& q : s.q) q += uniform(random, -2 * threshold, 2 * threshold);
      break;
    case 2:
      s.q[i] = uniform<double>(random, 0, 1) < 0.5 ? no_number : infinite;
      break;
    case 3:
      s.q[i] = uniform(random, -9.0, 9.0);
      break;
    case 4:
      s.dq[i] = uniform<double>(random, 0, 1) < 0.3 ? no_number : uniform(random, -100.0, 100.0);
      break;
    case 5:  // in degrees
      for (double& q : s.q) q *= 57.3;
      break;
    case 6:
      for (double& q : s.q) q += uniform(random, -0.3, 0.3) * dead_band;
      break;
    default:
      for (double& v : s.dq) v = uniform(random, -4.0, 4.0);
  }
  return s;
}

template <class Description>
void any_start_is_safe(const Description& arm) {
  const Cycle scene(arm, holds);
  Random random = seeded(31);
  const int runs = sanitized ? 300 : 3000;
  int refused = 0, begun = 0;
  for (int run = 0; run < runs; ++run) {
    State<3> at;
    at.time = 1s;
    for (double& q : at.q) q = uniform(random, -2.2, 2.2);
    if (run % 3 == 0)
      for (double& v : at.dq) v = uniform(random, -2.0, 2.0);
    auto robot = robot_of(arm, scene, at);
    const int kind = run % 8;
    const State<3> where = somewhere(random, at, kind);
    CAPTURE(run);
    robot.start(where);
    bool wrong = false;
    for (std::size_t i = 0; i < 3; ++i)
      wrong = wrong || !(std::abs(where.q[i] - at.q[i]) <= threshold + 2 * dt) || !std::isfinite(where.dq[i]);
    for (int k = 0; k < 20; ++k) {
      robot.cycle();
      CHECK(robot.out.command.valid == !robot.out.status.has(Reason::start_refused));
    }
    if (wrong) CHECK_FALSE(robot.last);
    bool inside = true;
    for (const double q : at.q) inside = inside && std::abs(q) < 1.9;
    if (kind == 6 && inside) CHECK(robot.last);
    (robot.last ? begun : refused) += 1;
    if (robot.last) continue;
    // The way on: with the next request it begins where it stands.
    typename decltype(scene)::Input resume;
    resume.request = CycleRequest::resume;
    robot.cycle(resume);
    CHECK_FALSE(robot.out.status.has(Reason::start_refused));
    for (int k = 0; k < 20; ++k) robot.cycle();
    CHECK(robot.out.command.valid);
    CHECK_FALSE(robot.out.status.has(Reason::displaced));
  }
  CHECK(refused > runs / 4);
  CHECK(begun > runs / 8);
}

}  // namespace

TEST_CASE("start: wherever a scene is started, it commands nothing unless the robot stands there") {
  SUBCASE("by position") {
    any_start_is_safe(arm_by_position());
  }
  SUBCASE("by velocity") {
    any_start_is_safe(arm_by_velocity());
  }
  SUBCASE("by torque") {
    any_start_is_safe(arm_by_torque());
  }
  SUBCASE("in groups") {
    any_start_is_safe(arm_in_groups());
  }
}

TEST_CASE("start: no state, no command: the first good one decides") {
  const auto check = [](const auto& arm) {
    const Cycle scene(arm, holds);
    const State<3> at{1s, {0.3, 0.2, 0.1}, {}};
    for (const bool near : {true, false}) {
      auto robot = robot_of(arm, scene, at);
      robot.start({1s, near ? at.q : JointPosition<3>{}, {}});
      for (int k = 0; k < 100; ++k) {
        auto bad = at;
        bad.time = at.time + k * period;
        typename decltype(scene)::Input input;
        input.now = bad.time;
        if (k % 3 == 0) bad.q[1] = no_number;
        if (k % 3 == 1) bad.dq[2] = 1e6;
        if (k % 3 == 2) bad.time = at.time - 1ms;
        input.measured = bad;
        robot.step(input);
        CHECK_FALSE(robot.out.command.valid);
        CHECK(robot.out.status.any());
      }
      robot.state.time += 200 * period;
      robot.cycle();
      CHECK(robot.out.command.valid == near);
      CHECK(robot.out.status.has(Reason::start_refused) == !near);
    }
  };
  check(arm_by_position());
  check(arm_by_velocity());
  check(arm_by_torque());
  check(arm_in_groups());
}

TEST_CASE(
    "start: a command that must not be sent lets the robot stand where it is, if it is sent all the same") {
  const auto check = [](const auto& arm) {
    const Cycle scene(arm, holds);
    const State<3> at{1s, {0.3, 0.2, 0.1}, {1, 1, 1}};
    auto robot = robot_of(arm, scene, at);
    robot.start({1s, {}, {}});
    for (const double q : {0.3, no_number, infinite, 9.0}) {
      typename decltype(scene)::Input input;
      input.now = robot.state.time += period;
      input.measured = robot.state;
      input.measured.q[0] = q;
      robot.step(input);
      const auto& sent = robot.out.command;
      REQUIRE_FALSE(sent.valid);
      for (std::size_t i = 0; i < 3; ++i) {
        if constexpr (requires { sent.velocity; }) CHECK(sent.velocity[i] == 0);
        if constexpr (requires { sent.position; }) {
          const bool nowhere = std::isnan(sent.position[i]), stands = sent.position[i] == at.q[i];
          CHECK((q == 0.3 ? stands : nowhere));
        }
      }
    }
  };
  check(arm_by_position());
  check(arm_by_velocity());
  check(arm_by_torque());
  check(arm_in_groups());
}

TEST_CASE("start: a memory that is started twice is as one that is started once") {
  const auto check = [](const auto& arm) {
    const Cycle scene(arm, holds);
    const State<3> at{1s, {0.3, 0.2, 0.1}, {}}, nowhere{1s, {}, {}};
    auto robot = robot_of(arm, scene, at);
    robot.start(nowhere);
    robot.start(at);
    robot.cycle();
    CHECK(robot.out.command.valid);
    for (int k = 0; k < 50; ++k) robot.cycle();
    robot.start({robot.state.time, {}, {}});
    robot.last.reset();
    for (int k = 0; k < 50; ++k) CHECK(robot.cycle().has(Reason::start_refused));
    CHECK_FALSE(robot.out.command.valid);
    robot.start(robot.state);
    robot.cycle();
    CHECK(robot.out.command.valid);
    CHECK_FALSE(robot.out.status.has(Reason::start_refused));
  };
  check(arm_by_position());
  check(arm_by_velocity());
  check(arm_by_torque());
  check(arm_in_groups());
}

TEST_CASE("start: refused, a scene changes its configuration only after it has begun again") {
  const Cycle one(arm_by_position(), holds);
  const Configurations scene(one, one);
  Robot<std::remove_cvref_t<decltype(scene)>, Sets{}> robot{scene, {1s, {0.3, 0.2, 0.1}, {}}};
  robot.start({1s, {}, {}});
  robot.cycle();
  decltype(scene)::Input other;
  other.configuration = 1;
  for (int k = 0; k < 5; ++k) {
    robot.cycle(other);
    CHECK(robot.out.status.has(Reason::start_refused));
    CHECK(robot.out.status.has(Reason::configuration_refused));
    CHECK_FALSE(robot.out.command.valid);
  }
  other.request = CycleRequest::resume;
  robot.cycle(other);
  other.request = CycleRequest::none;
  for (int k = 0; k < 5; ++k) robot.cycle(other);
  CHECK(robot.out.command.valid);
  CHECK_FALSE(robot.out.status.has(Reason::configuration_refused));
  CHECK(robot.memory.configuration == 1);
}

TEST_CASE("start: a request to resume does not start a scene at a state that no robot can have") {
  const Cycle scene(arm_by_position(), holds);
  auto robot = robot_of(arm_by_position(), scene, {1s, {0.3, 0.2, 0.1}, {}});
  robot.start({1s, {}, {}});
  for (const double wrong : {no_number, infinite, 9.0}) {
    robot.cycle();
    typename decltype(scene)::Input input;
    input.now = robot.state.time += period;
    input.measured = robot.state;
    input.measured.q[1] = wrong;
    input.request = CycleRequest::resume;
    CHECK(robot.step(input).has(Reason::start_refused));
    CHECK_FALSE(robot.out.command.valid);
  }
}

TEST_CASE("start: what a scene saw while its start was refused does not move the robot afterwards") {
  const Cycle scene(arm_by_position(), holds);
  auto robot = robot_of(arm_by_position(), scene, {1s, {0.3, 0.2, 0.1}, {}});
  auto start = robot.state;
  start.q[0] += 0.5 * dead_band;
  robot.start(start);
  for (int k = 0; k < 500; ++k) {  // it stands there, and says that it moves
    typename decltype(scene)::Input input;
    input.now = robot.state.time += period;
    input.measured = robot.state;
    input.measured.dq[1] = 2;
    CHECK(robot.step(input).has(Reason::start_refused));
  }
  typename decltype(scene)::Input resume;
  resume.request = CycleRequest::resume;
  const auto stands = robot.state.q;
  for (int k = 0; k < 2; ++k) robot.cycle(resume);
  REQUIRE(robot.out.command.valid);
  for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(robot.out.command.position[i] - stands[i]) < 2e-4);
}

TEST_CASE("start: a goal that comes with the request to resume counts") {
  const auto scene = reaching_scene();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  State<6> state;
  state.q = home_position();
  auto memory = std::make_unique<Scene::Memory>();
  scene.start(*memory, State<6>{});
  Scene::Output out;
  for (int k = 1; k < 2000; ++k) {
    Scene::Input input;
    input.now = state.time = k * 8ms;
    input.measured = state;
    if (k == 5) {
      input.request = CycleRequest::resume;
      input.goal = {home_position(), 3s};
      input.goal->q_g[0] += 0.3;
    }
    out = scene.step(*memory, input);
    CHECK(out.command.valid == (k > 5));
    if (!out.command.valid) continue;
    if (k == 6)
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out.command.position[i] - home[i]) < 1e-3);
    state.q = out.command.position;
    state.dq = out.planned.velocity;
  }
  CHECK(std::abs(state.q[0] - home[0] - 0.3) < 1e-2);
}

TEST_CASE(
    "start: told by more than a gap to which a user can agree, it does not begin where it is measured") {
  const auto scene = reaching_scene();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  State<6> state;
  state.q = home_position();
  for (const double gap : {0.1, 0.2}) {
    auto told = home_position();
    told[2] += gap;
    auto memory = std::make_unique<Scene::Memory>();
    auto elsewhere = state;
    elsewhere.q[1] += gap < 0.15 ? 1 : 0;
    auto told_there = told;
    told_there[1] += gap < 0.15 ? 1 : 0;
    scene.start(*memory, elsewhere, told_there);
    for (int k = 1; k < 20; ++k) {
      Scene::Input input;
      input.now = state.time = k * 8ms;
      input.measured = state;
      if (k == 10) input.request = CycleRequest::resume;
      const auto out = scene.step(*memory, input);
      CHECK(out.command.valid == (k > 10 && gap < 0.15));
      if (!out.command.valid) continue;
      // It was told to be elsewhere by the gap, and does not step.
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out.command.position[i] - told[i]) < 1e-3);
    }
  }
}
