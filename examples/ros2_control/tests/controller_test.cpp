// The controller, loaded by class_loader as pluginlib loads it: its commands are those of `run_loop`, to the
// bit.
//
// Promise: a controller of ros2_control commands what `run_loop` does, to the bit
// Tried: 500 cycles with touches, loaded by class_loader. Also: `examples/ros2_control/tests`

#include <doctest/doctest.h>

#include <bit>
#include <class_loader/class_loader.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "examples/ros2_control/src/scene.hpp"
#include "examples/ros2_control/src/skin_controller.hpp"
#include "skinctl/hardware/loop.hpp"

using namespace skinctl;
using skinctl_controller::make_scene;

namespace {

constexpr int cycles = 500;

/// The samples of a cycle, the same for both: touches that come and go.
std::vector<CellSample> samples_at(Nanoseconds now) {
  std::mt19937 random(static_cast<std::uint32_t>(now / 8ms));
  std::vector<CellSample> out(random() % 20);
  for (auto& s : out)
    s = {.time = now - Nanoseconds(random() % 5'000'000),
         .cell = std::uint32_t(1 + random() % 260),
         .force = {now / 400ms % 2 == 1 ? 0.3f * float(random() % 1024) / 1024 : 0.0f, 0, 0}};
  return out;
}
/// An arm that follows; the same for both.
struct Arm {
  State<6> state;
  Arm() { state.q = JointPosition<6>(std::array{0.0, -1.2, 1.4, -1.8, -1.57, 0.3}); }
  void follow(const JointPosition<6>& q) {
    for (std::size_t i = 0; i < 6; ++i) {
      state.dq[i] = (q[i] - state.q[i]) / 0.016;
      state.q[i] += 0.5 * (q[i] - state.q[i]);
    }
  }
};
struct Driver {
  Arm arm;
  int left = cycles + 1;
  std::vector<JointPosition<6>> commands;
  Heard wait(State<6>& state) noexcept {
    if (left-- == 0) return Heard::lost;
    arm.state.time += 8ms;
    state = arm.state;
    return Heard::state;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    commands.push_back(command.position);
    arm.follow(command.position);
    return true;
  }
  void stop() noexcept {}
};
struct Skin {
  const Driver& driver;
  std::vector<CellSample> samples;
  std::span<const CellSample> poll() noexcept { return samples = samples_at(driver.arm.state.time); }
};

std::vector<JointPosition<6>> by_loop() {
  const auto scene = make_scene();
  const auto memory = std::make_unique<decltype(make_scene())::Memory>();
  Driver driver;
  Skin skin{driver, {}};
  run_loop(
      scene, *memory, driver, skin, {.period = 8ms, .warm = 0ns}, [](auto&, auto&) { return true; },
      [](const auto&, const auto&, const auto&) {});
  return driver.commands;
}

}  // namespace

TEST_CASE("ros2_control: the controller is loaded by name, and commands what run_loop does, to the bit") {
  std::vector<CellSample> samples;
  class_loader::ClassLoader loader(SKIN_CONTROLLER_LIBRARY);
  REQUIRE(loader.isClassAvailable<controller_interface::ControllerInterface>(
      "skinctl_controller::SkinController"));
  skinctl_controller::set_skin_source(
      [&](Nanoseconds now) -> std::span<const CellSample> { return samples = samples_at(now); });
  {
    const auto controller = loader.createUniqueInstance<controller_interface::ControllerInterface>(
        "skinctl_controller::SkinController");
    REQUIRE(controller->on_init() == controller_interface::CallbackReturn::SUCCESS);
    const auto states = controller->state_interface_configuration().names,
               commands = controller->command_interface_configuration().names;
    REQUIRE(states.size() == 12);
    REQUIRE(commands.size() == 6);
    CHECK(states[7] == "shoulder_lift_joint/velocity");
    CHECK(commands[5] == "wrist_3_joint/position");

    Arm arm;
    std::array<double, 12> measured{};
    std::array<double, 6> commanded{};
    std::vector<hardware_interface::LoanedStateInterface> loaned;
    for (std::size_t i = 0; i < 12; ++i) loaned.emplace_back(states[i], &measured[i]);
    std::vector<hardware_interface::LoanedCommandInterface> told;
    for (std::size_t i = 0; i < 6; ++i) told.emplace_back(commands[i], &commanded[i]);
    CHECK(controller->on_activate({}) == controller_interface::CallbackReturn::ERROR);
    controller->assign_interfaces(told, loaned);
    REQUIRE(controller->on_activate({}) == controller_interface::CallbackReturn::SUCCESS);
    const auto expected = by_loop();
    REQUIRE(expected.size() == cycles);
    std::size_t different = 0;
    double moved = 0;
    for (int k = 0; k <= cycles; ++k) {
      arm.state.time += 8ms;
      for (std::size_t i = 0; i < 6; ++i) measured[i] = arm.state.q[i], measured[6 + i] = arm.state.dq[i];
      REQUIRE(controller->update(rclcpp::Time(arm.state.time.count()), rclcpp::Duration(8'000'000)) ==
              controller_interface::return_type::OK);
      if (k == 0) continue;
      JointPosition<6> q(commanded);
      for (std::size_t i = 0; i < 6; ++i) {
        different += std::bit_cast<std::uint64_t>(q[i]) !=
                     std::bit_cast<std::uint64_t>(expected[static_cast<std::size_t>(k - 1)][i]);
        moved = std::max(moved, std::abs(q[i] - expected[0][i]));
      }
      arm.follow(q);
    }
    CHECK(different == 0);
    CHECK(moved > 0.1);
  }
}
