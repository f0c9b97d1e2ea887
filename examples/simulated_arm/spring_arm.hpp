// The body of a simulated iiwa or FR3: seven joints on springs, and the torque of the world as its controller
// finds it.
#pragma once

#include <random>

#include "examples/adapters/fri/messages.hpp"
#include "examples/simulated_arm/arm.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/testing/impedance_plant.hpp"

namespace simulated_arm {

using adapters::fri::SevenJoints;

struct SpringArmConfig {
  SevenJoints home{0, 0.5, 0, -1.3, 0, 1.3, 0};  ///< [rad]
  double stiffness = 500;                        ///< of each joint [N m/rad]
  double damping_ratio = 0.7;
  double delay = 0.002;       ///< from an answer until the springs' reference begins to move [s]
  double period = 0.004;      ///< in which the reference goes to a new answer [s]
  double torque_lag = 0.005;  ///< with which torques of the world are found [s]
  double torque_noise = 0.1;  ///< standard deviation of what is found [N m]
  double torque_error = 0.3;  ///< error at rest, as a load told wrong leaves it [N m]
};

class SpringArm {
 public:
  static constexpr std::size_t joints = adapters::fri::joints;
  using Model = skinctl::CalibratedModel<skinctl::Chain<joints>>;

  SpringArm(const Model& model, const Config& config, const SpringArmConfig& own)
      : model_(model),
        config_(config),
        own_(own),
        told_(own.home),
        q_(own.home),
        plant_(model,
               {.stiffness = skinctl::JointTorque<joints>::constant(own.stiffness),
                .damping_ratio = own.damping_ratio,
                .delay = own.delay,
                .period = own.period},
               skinctl::JointPosition<joints>(own.home)) {
    found_.fill(own.torque_error);
  }

  void advance(double t) {
    while (time_ < t - 1e-9) {
      const double dt = std::min(1e-3, t - time_);
      const auto pushed = push();
      plant_.push(pushed);
      plant_.run(dt);
      time_ += dt;
      const double share = own_.torque_lag > 0 ? 1 - std::exp(-dt / own_.torque_lag) : 1;
      for (std::size_t i = 0; i < joints; ++i)
        found_[i] += share * (pushed[i] + own_.torque_error - found_[i]);
    }
    for (std::size_t i = 0; i < joints; ++i) {
      q_[i] = plant_.q()[i], dq_[i] = plant_.dq()[i];
      noisy_[i] = found_[i] + own_.torque_noise * noise_(random_);
    }
  }
  void command(const SevenJoints& q, const SevenJoints& torque = {}) {
    told_ = q;
    skinctl::ImpedanceCommand<joints> c;
    c.position = skinctl::JointPosition<joints>(q);
    c.torque = skinctl::JointTorque<joints>(torque);
    plant_.command(c);
  }
  /// By other springs from here on, about where the arm is; of no stiffness, torques alone move it [N m/rad].
  void hold_by(const SevenJoints& stiffness) {
    plant_.hold_by(skinctl::JointTorque<joints>(stiffness));
    told_ = q_;
  }
  /// The springs hold where they were told to be.
  void halt() {
    if (!std::exchange(halted_, true)) command(told_);
  }
  [[nodiscard]] const SevenJoints& q() const { return q_; }
  [[nodiscard]] const SevenJoints& dq() const { return dq_; }
  [[nodiscard]] const SevenJoints& told() const { return told_; }
  [[nodiscard]] double time() const { return time_; }
  /// Torque of the world at the joints, as the controller finds it [N m].
  [[nodiscard]] const SevenJoints& external() const { return noisy_; }

  /// Force of hands at the flange, along the base's axes [N].
  [[nodiscard]] const skinctl::Xyz<double>& force() const { return force_; }
  /// Of the joints' sensors, with that for the weight [N m].
  [[nodiscard]] SevenJoints motor_torque() const {
    SevenJoints out;
    const auto torque = plant_.motor_torque();
    for (std::size_t i = 0; i < joints; ++i) out[i] = torque[i];
    return out;
  }
  [[nodiscard]] skinctl::Transform<skinctl::Base, skinctl::Link<joints - 1>> flange() const {
    return skinctl::link_poses(model_, plant_.q()).template get<joints - 1>();
  }

 private:
  /// Of hands at the flange, along its axes.
  [[nodiscard]] skinctl::JointTorque<joints> push() {
    using namespace skinctl;
    const auto poses = link_poses(model_, plant_.q());
    const auto& X_BF = poses.template get<joints - 1>();
    Xyz<double> F{};
    for (const Push& p : config_.pushes) {
      const double share = p.share(time_);
      F = F + share * (p.force[0] * X_BF.axis_x() + p.force[1] * X_BF.axis_y() + p.force[2] * X_BF.axis_z());
    }
    force_ = F;
    return transpose(jacobian<joints - 1>(poses)) *
           Wrench<Link<joints - 1>, Link<joints - 1>, Base>{F, {0, 0, 0}};
  }

  Model model_;
  Config config_;
  SpringArmConfig own_;
  SevenJoints told_, q_, dq_{}, found_{}, noisy_{};
  skinctl::testing::ImpedancePlant<Model> plant_;
  std::minstd_rand random_{3};
  std::normal_distribution<double> noise_{0, 1};
  skinctl::Xyz<double> force_{};
  double time_ = 0;
  bool halted_ = false;
};

}  // namespace simulated_arm
