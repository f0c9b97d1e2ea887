// The simulated arm of the playground: drives, skin, wrist sensor and finger, without a controller's
// protocols.
#pragma once

#include <functional>
#include <vector>

#include "examples/adapters/ur5/program.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "examples/playground/playground.hpp"
#include "examples/simulated_ur5/arm.hpp"
#include "examples/simulated_ur5/contact.hpp"
#include "examples/simulated_ur5/force_sensor.hpp"
#include "examples/simulated_ur5/led_finger.hpp"
#include "skinctl/core/command.hpp"
#include "skinctl/sensing/wrench_sample.hpp"

namespace playground {

using simulated_ur5::Joints;
using simulated_ur5::Vec3;

/// Where the links are at some positions of the joints.
using Kinematics = std::function<simulated_ur5::Links(const Joints&)>;

/// What `simulated_ur5::Controller` moves between two of its states, moved by commands alone.
class Body {
 public:
  Body(const simulated_ur5::ArmConfig& arm, simulated_ur5::Nanoseconds cycle,
       std::vector<simulated_ur5::SkinCell> cells, const simulated_ur5::SkinConfig& skin,
       Kinematics kinematics)
      : cycle_(cycle),
        kinematics_(std::move(kinematics)),
        arm_(arm, cycle),
        skin_config_(skin),
        skin_(cells, skin, 1),
        sensor_(simulated_ur5::ForceSensorConfig{}),
        world_({simulated_ur5::LedFinger::touch()}, cells, skin.proximity_distance) {
    samples_.reserve(4 * cells.size());
  }

  void send(const skinctl::PositionCommand<6>& c) noexcept {
    arm_.servo(joints(c.position), adapters::ur5::servoj_lookahead, 2000);
  }
  void send(const skinctl::VelocityCommand<6>& c) noexcept { arm_.speed(joints(c.velocity), 40); }
  void send(const skinctl::TorqueCommand<6>& c) noexcept { arm_.torque(joints(c.torque), viscous, coulomb); }

  /// One cycle of the controller; false: it stopped the arm, as it was told what no such arm does.
  bool step(const Finger& led) noexcept {
    using namespace simulated_ur5;
    const bool fine = arm_.plan(1) == Violation::none;
    samples_.clear();
    const double h = seconds(plant_step);
    const LedFinger::Wish wish{led.stiffness, 1e-3 * led.travel, {led.aside[0], led.aside[1], led.aside[2]}};
    for (Nanoseconds t{}; t < cycle_; t += plant_step) {
      finger_.step(world_, 0, wish, h);
      arm_.advance(world_.load());
      now_ += plant_step;
      links_ = kinematics_(arm_.q());
      world_.advance(seconds(now_), h, links_);
      if (now_ % skin_config_.period == 0) {
        const auto& heard = skin_.sample(now_, links_, world_.stimulus());
        samples_.insert(samples_.end(), heard.begin(), heard.end());
      }
    }
    arm_.measure();
    return fine;
  }

  [[nodiscard]] skinctl::State<6> state() const noexcept {
    return {std::chrono::nanoseconds(now_), skinctl::JointPosition<6>(arm_.measured_q()),
            skinctl::JointVelocity<6>(arm_.measured_dq())};
  }
  [[nodiscard]] std::span<const skinctl::CellSample> samples() const noexcept { return samples_; }
  /// By a sensor in the flange, along the flange's axes.
  skinctl::WrenchSample wrench() noexcept {
    const auto& flange = links_.flange;
    const auto w = sensor_.read({flange.rotate_back(world_.tool_force()),
                                 flange.rotate_back(world_.tool_moment_about(flange.origin))},
                                0, 0);
    return {std::chrono::nanoseconds(now_),
            {w.force.x, w.force.y, w.force.z},
            {w.moment.x, w.moment.y, w.moment.z}};
  }
  [[nodiscard]] skinctl::JointTorque<6> motor_torque() const noexcept {
    skinctl::JointTorque<6> out;
    for (std::size_t i = 0; i < 6; ++i)
      out[i] = arm_.motor_torque()[i] + arm_.torque_noise()[i] - world_.load()[i];
    return out;
  }

  /// From now on this arm is where the other is, and moves like it.
  void begin_like(const Body& other) noexcept { arm_ = other.arm_, links_ = other.links_; }
  void press(std::size_t link, Vec3 point, Vec3 normal, std::size_t cell) noexcept {
    finger_.press(world_, 0, link, point, normal, cell);
  }
  void release() noexcept { finger_.release(); }
  /// Cells that are silent, and cells that stick from now on; both empty: all are whole.
  void hurt(const std::vector<std::uint32_t>& dead, const std::vector<std::uint32_t>& stuck) {
    skin_config_.faults.clear();
    for (const std::uint32_t id : stuck)
      skin_config_.faults.push_back({.cell = id, .from = std::chrono::nanoseconds(now_), .level = 0.08});
    const auto cells = skin_.cells();
    skin_ = simulated_ur5::Skin(cells, skin_config_, 1);
    for (const std::uint32_t id : dead) skin_.set_dead(id, true);
  }

  [[nodiscard]] const simulated_ur5::Arm& arm() const noexcept { return arm_; }
  [[nodiscard]] const simulated_ur5::Links& links() const noexcept { return links_; }
  [[nodiscard]] const simulated_ur5::LedFinger& finger() const noexcept { return finger_; }
  [[nodiscard]] const simulated_ur5::ContactWorld& world() const noexcept { return world_; }
  [[nodiscard]] const std::vector<simulated_ur5::SkinCell>& cells() const noexcept { return skin_.cells(); }

  Joints viscous{}, coulomb{};  ///< shares of friction that the controller compensates, by torque

 private:
  template <class V>
  static Joints joints(const V& v) noexcept {
    Joints out{};
    for (std::size_t i = 0; i < 6; ++i) out[i] = v[i];
    return out;
  }
  simulated_ur5::Nanoseconds cycle_, now_{};
  Kinematics kinematics_;
  simulated_ur5::Arm arm_;
  simulated_ur5::SkinConfig skin_config_;
  simulated_ur5::Skin skin_;
  simulated_ur5::ForceSensor sensor_;
  simulated_ur5::ContactWorld world_;
  simulated_ur5::LedFinger finger_;
  simulated_ur5::Links links_ = kinematics_(arm_.q());
  std::vector<skinctl::CellSample> samples_;
};

}  // namespace playground
