// Promise: the memory of another scene commands nothing: limits, times, mounting, cells tell them apart
// Tried: two arms whose memories are swapped while they run, by position, velocity and torque; gains may
// differ

#include <doctest/doctest.h>

#include <memory>
#include <utility>

#include "skinctl/cycle/configurations.hpp"
#include "skinctl/model/mounted.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Arm = Mounted<ur5::Model>;

struct Setting {
  Nanoseconds period = 8ms, delay = 8ms;
  double torque = 1, velocity = 1, force = 20,
         weight = 1;     ///< limits as shares of the UR5's; gains of the skin
  double tilt = 0;       ///< of the base about x [rad]
  double shift = 0;      ///< of the cells along their link [m]
  std::uint32_t id = 1;  ///< of the cell
};

template <Interface I>
auto scene_of(const Setting& s) {
  auto values = ur5_test_limits().values();
  for (double& x : values.torque) x *= s.torque;
  for (double& x : values.velocity) x *= s.velocity;
  const RobotConfiguration<6> c{.limits = JointLimits<6>(values),
                                .period = s.period,
                                .delay = s.delay,
                                .virtual_damping = I == Interface::torque ? 0.0 : 4.0};
  const Arm model(ur5::Model{}, exp_so3(Xyz<double>{s.tilt, 0, 0}));
  const Patch<5, 1> patch({{s.id, Transform<Link<5>, Cell>::translation_xyz(0, s.shift, 0.1)}},
                          {.force = s.force});
  const Skin<Arm, double, Patch<5, 1>> skin(patch);
  const auto law = s.weight * SkinJointControl{} + GravityControl{};
  if constexpr (I == Interface::torque) {
    return Cycle(by_torque(model, c, FrictionUncompensated{}), skin, law);
  } else {
    return Cycle(robot_by<I>(model, c), skin, law);
  }
}

// A robot that does at once what it is told, and stands while it is told nothing.
template <class Scene>
struct Robot {
  const Scene& scene;
  State<6> state;
  typename Scene::Memory memory = scene.start(state);
  typename Scene::Output out{};
  double largest_step = 0;  ///< of a command that may be sent, from where the robot stands [rad]

  void cycle(CycleRequest request = CycleRequest::none) {
    typename Scene::Input input;
    input.now = state.time += 8ms;
    input.measured = state;
    input.request = request;
    const AllocationGuard guard;
    out = scene.step(memory, input);
    if (!out.command.valid) return;
    for (std::size_t i = 0; i < 6; ++i)
      largest_step = std::max(largest_step, std::abs(out.planned.position[i] - state.q[i]));
    if constexpr (!requires { out.command.torque; }) state.q = out.planned.position;
  }
};

template <Interface I>
void swapped(const Setting& one, const Setting& other) {
  const auto a = scene_of<I>(one), b = scene_of<I>(other);
  CHECK(a.mark() != b.mark());
  auto beside = home_position();
  beside[0] += 0.5;
  Robot<std::remove_cvref_t<decltype(a)>> left{a, {1s, home_position(), {}}}, right{b, {1s, beside, {}}};
  for (int k = 0; k < 20; ++k) left.cycle(), right.cycle();
  REQUIRE(left.out.command.valid);
  REQUIRE(right.out.command.valid);
  std::swap(left.memory, right.memory);
  for (auto* robot : {&left, &right}) {
    robot->cycle();
    CHECK(robot->out.status.has(Reason::memory_refused));
    CHECK(robot->out.status.has(Reason::start_refused));
    for (int k = 0; k < 20; ++k) {
      CHECK_FALSE(robot->out.command.valid);
      robot->cycle();
      CHECK(robot->out.status.has(Reason::start_refused));
    }
    for (int k = 0; k < 3; ++k) robot->cycle(CycleRequest::resume);
    for (int k = 0; k < 20; ++k) robot->cycle();
    CHECK(robot->out.command.valid);
    CHECK_FALSE(robot->out.status.has(Reason::memory_refused));
    if (I != Interface::torque) CHECK(robot->largest_step < 1e-3);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("Memory: of another scene it commands nothing until the user resumes", Way,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>,
                   std::integral_constant<Interface, Interface::torque>) {
  constexpr Interface I = Way::value;
  const Setting one;
  swapped<I>(one, {.period = 4ms});
  swapped<I>(one, {.delay = 4ms});
  swapped<I>(one, {.torque = 0.99});
  swapped<I>(one, {.velocity = 0.99});
  swapped<I>(one, {.tilt = 0.5});
  swapped<I>(one, {.shift = 0.01});
  swapped<I>(one, {.id = 2});
}

TEST_CASE("Memory: a scene with other gains goes on with it") {
  const auto a = scene_of<Interface::position>({}),
             b = scene_of<Interface::position>({.force = 5, .weight = 0.3});
  CHECK(a.mark() == b.mark());
  Robot<std::remove_cvref_t<decltype(a)>> left{a, {1s, home_position(), {}}},
      right{b, left.state, left.memory};
  for (int k = 0; k < 20; ++k) right.cycle();
  CHECK(right.out.command.valid);
}

TEST_CASE("Memory: one that no scene has started commands nothing") {
  const auto scene = scene_of<Interface::position>({});
  Robot<std::remove_cvref_t<decltype(scene)>> robot{scene, {1s, home_position(), {}}, {}};
  robot.cycle();
  CHECK(robot.out.status.has(Reason::memory_refused));
  CHECK_FALSE(robot.out.command.valid);
}

TEST_CASE("Memory: configurations go on with that of each other, not with that of others") {
  const auto flat = scene_of<Interface::position>({}), tilted = scene_of<Interface::position>({.tilt = 0.5}),
             slow = scene_of<Interface::position>({.velocity = 0.5});
  const Configurations both(flat, tilted), others(slow, slow);
  using Scene = std::remove_cvref_t<decltype(both)>;
  Scene::Input input;
  input.measured = {1s, home_position(), {}};
  Scene::Memory memory = both.start(input.measured);
  const auto step = [&](const Scene& scene) {
    input.now = input.measured.time += 8ms;
    return scene.step(memory, input);
  };
  for (const std::uint32_t k : {0u, 1u, 1u, 0u, 1u}) {
    input.configuration = k;
    const auto out = step(both);
    CHECK(out.command.valid);
    CHECK_FALSE(out.status.has(Reason::memory_refused));
    CHECK_FALSE(out.status.has(Reason::configuration_refused));
  }
  for (const std::uint32_t k : {0u, 1u}) {
    input.configuration = k;
    auto copy = memory;
    const auto out = step(others);
    CHECK(out.status.has(Reason::memory_refused));
    CHECK_FALSE(out.command.valid);
    memory = copy;
  }
}
