// A UR5 with skin as a whole scene, and stiff joints to run it against.
#pragma once

#include <array>
#include <cmath>
#include <deque>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/tactile/ur5_skin.hpp"
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
  Nanoseconds period = 8_ms;
  Nanoseconds delay = 8_ms;
  double lag = 0;
  double decay = 6;        ///< friction of the virtual robot: B = decay M [1/s]
  double viscous = 0;      ///< and of each virtual joint [N m s/rad]
  double force_gain = 40;  ///< N per unit of reading
  double lambda = 25, K_c = 5, tb = 4;
};

template <class T>
VirtualShape<6, T> shape(const SceneSettings& s) {
  VirtualShape<6, T> out;
  out.decay = T(s.decay);
  for (auto& b : out.viscous) b = T(s.viscous);
  return out;
}

template <Interface I, class T>
ResolverConfiguration<6, T> resolver_configuration(const SceneSettings& s) {
  ResolverConfiguration<6, T> c{.limits = ur5_test_limits<T>(), .period = s.period, .delay = s.delay};
  c.lag = T(s.lag);
  c.shape = shape<T>(s);
  return c;
}

/// Everything but the law.
template <Interface I, std::size_t Cells, class T, class L>
auto make_scene(const L& law, const SceneSettings& s = {}) {
  const auto c = resolver_configuration<I, T>(s);
  GuardConfiguration<6, T> g{.limits = c.limits, .period = s.period};
  g.longest_interval = 10 * s.period;
  SkinSettings skin;
  skin.max_age = 10_s;  // tests send changes only
  return Cycle(Resolver<I, ur5::Model, T>(ur5::Model{}, c), law,
               ur5_skin<Cells, T>({.force = s.force_gain}, skin), Guard<I, 6, T>(g));
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
  settings.dt = T(0.002);
  settings.lambda = T(s.lambda);
  settings.K_c = T(s.K_c);
  settings.tb = T(s.tb);
  settings.shape = shape<T>(s);
  return make_scene<I, Cells, T>(SplineJoint<6, T>(settings) + SkinJointControl{} + GravityControl{}, s);
}

/// Joints that follow their position command stiffly after a delay and with a first-order lag, sampled every
/// `step`.
template <class T = double>
class StiffJoints {
 public:
  StiffJoints(const JointPosition<6, T>& q, Nanoseconds delay, double lag, Nanoseconds step = 1_ms)
      : step_(step),
        delay_(delay),
        alpha_(lag > 0 ? T(1 - std::exp(-1e-9 * static_cast<double>(step) / lag)) : T(1)) {
    state_.q = q;
    target_ = q;
  }
  void command(Nanoseconds now, const JointPosition<6, T>& q) { queue_.push_back({now + delay_, q}); }
  /// Lets time pass until `now`.
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
