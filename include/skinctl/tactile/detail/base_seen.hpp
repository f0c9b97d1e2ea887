// SPDX-License-Identifier: BSD-3-Clause
// What a sensor of the robot's own weight remembers of a base that moves.
#pragma once

#include "skinctl/dynamics/base_motion.hpp"
#include "skinctl/model/moving_base.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The motion of the base of a robot with the model `M`, as its scene tells it (`follow_robot`); nothing for
/// a base that stands.
template <RobotModel M, Real T>
struct BaseSeen {
  static BaseSeen start(const M&) noexcept { return {}; }
  template <class Model>
  void take(const Model&) noexcept {
    static_assert(!knows_base_motion<Model>,
                  "the robot is OnMovingBase, and the model of this sensor is not: WristSensor, MotorTouch");
  }
  friend bool operator==(const BaseSeen&, const BaseSeen&) noexcept = default;
};
template <RobotModel M, Real T>
  requires base_moves<M>
struct BaseSeen<M, T> {
  BaseMotion<T> motion;

  static BaseSeen start(const M& model) noexcept { return {base_at_rest<T>(model.at_rest())}; }
  template <class Model>
  void take(const Model& model) noexcept {
    static_assert(
        knows_base_motion<Model>,
        "the model of this sensor is OnMovingBase, and the robot's is not: WristSensor, MotorTouch");
    motion = model.base_motion;
  }
  friend bool operator==(const BaseSeen&, const BaseSeen&) noexcept = default;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
