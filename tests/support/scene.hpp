// A UR5 with skin as a whole scene, and stiff joints as its robot.
#pragma once

#include <array>
#include <cmath>
#include <deque>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/sanitized.hpp"

namespace skinctl::testing {

inline constexpr std::array<double, 6> home = {0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

template <class T = double>
JointPosition<6, T> home_position() {
  return JointPosition<6>(home).template cast<T>();
}

template <class T = double>
JointLimits<6, T> ur5_test_limits() {
  using D = ur5::Description;
  return JointLimits<6, T>(
      {JointPosition<6>(D::lower).template cast<T>(), JointPosition<6>(D::upper).template cast<T>(),
       JointVelocity<6, T>::constant(T(D::max_velocity)), JointAcceleration<6, T>::constant(T(15)),
       JointTorque<6>(D::max_torque).template cast<T>()});
}

struct SceneSettings {
  Nanoseconds period = 8ms;
  Nanoseconds delay = 8ms;
  Nanoseconds lag{};
  double decay = 6;        ///< friction of the virtual robot: B = decay M [1/s]
  double viscous = 0;      ///< and of each virtual joint [N m s/rad]
  double force_gain = 40;  ///< N per unit of reading
  double lambda = 25, K_c = 5;
  Nanoseconds tb = 4s;
};

template <class T>
VirtualDynamics<6, T> shape(const SceneSettings& s) {
  VirtualDynamics<6, T> out;
  out.damping = T(s.decay);
  for (auto& b : out.viscous) b = T(s.viscous);
  return out;
}

template <Interface I, class T>
RobotConfiguration<6, T> configuration_of(const SceneSettings& s) {
  RobotConfiguration<6, T> c{.limits = ur5_test_limits<T>(), .period = s.period, .delay = s.delay};
  c.lag = s.lag;
  c.set(shape<T>(s));
  return c;
}

/// The robot of the scene.
template <Interface I, class T>
auto test_robot(const SceneSettings& s) {
  const auto c = configuration_of<I, T>(s);
  if constexpr (I == Interface::torque) {
    return by_torque<T>(ur5::Model{}, c, FrictionUncompensated{});
  } else {
    return robot_by<I, T>(ur5::Model{}, c);
  }
}

/// Everything but the law.
template <Interface I, std::size_t Cells, class T, class L>
auto make_scene(const L& law, const SceneSettings& s = {}) {
  SkinSettings skin;
  skin.max_age = 10s;  // tests send only changes
  return Cycle(test_robot<I, T>(s), ur5_skin<Cells, T>({.force = s.force_gain}, skin), law);
}

/// Skin and gravity: the arm is led by hand.
template <Interface I = Interface::position, std::size_t Cells = 260, class T = double>
auto kinesthetic_scene(const SceneSettings& s = {}) {
  return make_scene<I, Cells, T>(SkinJointControl{} + GravityControl{}, s);
}

/// The arm goes to goals and gives way to touch.
template <Interface I = Interface::position, std::size_t Cells = 260, class T = double>
auto reaching_scene(const SceneSettings& s = {}) {
  JointControlSettings<6, T> settings;
  settings.dt = 2500us;  // in late cycles: five periods of 8 ms in sixteen sub-steps
  settings.lambda = T(s.lambda);
  settings.K_c = T(s.K_c);
  settings.tb = s.tb;
  settings.virtual_dynamics = shape<T>(s);
  return make_scene<I, Cells, T>(SplineJoint<6, T>(settings) + SkinJointControl{} + GravityControl{}, s);
}

/// Joints that follow their position command stiffly after a delay and with a first-order lag, sampled every
/// `step`.
template <class T = double>
class StiffJoints {
 public:
  StiffJoints(const JointPosition<6, T>& q, Nanoseconds delay, Nanoseconds lag, Nanoseconds step = 1ms)
      : step_(step),
        delay_(delay),
        alpha_(lag > 0ns ? T(1 - std::exp(-seconds<double>(step) / seconds<double>(lag))) : T(1)) {
    state_.q = q;
    target_ = q;
  }
  void command(Nanoseconds now, const JointPosition<6, T>& q) { queue_.push_back({now + delay_, q}); }
  /// Advances the time to `now`.
  const State<6, T>& run_to(Nanoseconds now) {
    while (state_.time < now) {
      state_.time += step_;
      while (!queue_.empty() && queue_.front().at <= state_.time) {
        target_ = queue_.front().q;
        queue_.pop_front();
      }
      if (blocked_) continue;
      for (std::size_t i = 0; i < 6; ++i) {
        const T before = state_.q[i];
        state_.q[i] += alpha_ * (target_[i] - before);
        state_.dq[i] = (state_.q[i] - before) / seconds<T>(step_);
      }
    }
    return state_;
  }
  const State<6, T>& state() const { return state_; }
  void block(bool blocked) {
    blocked_ = blocked;
    if (blocked) state_.dq = {};
  }

 private:
  struct Queued {
    Nanoseconds at;
    JointPosition<6, T> q;
  };
  Nanoseconds step_, delay_;
  T alpha_;
  State<6, T> state_;
  JointPosition<6, T> target_;
  std::deque<Queued> queue_;
  bool blocked_ = false;
};

}  // namespace skinctl::testing
