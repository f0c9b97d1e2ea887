// A robot that finds the torque of contacts itself: what it tells is the touch, and no mass of a model enters
// it.

#include "skinctl/tactile/robot_observer.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

using Touch = RobotTouch<ur5::Model>;

const Touch touch(ur5::Model{}, {.observer = {},
                                 .gates = same_gate(ur5::Model{}, EventGate<>::dead_band(2.0)),
                                 .gain = 0.5});

/// After 30 cycles of 4 ms with `told`, on an arm that moves as it likes.
JointTorque<6> felt_after(const JointTorque<6>& told, double speed) {
  auto memory = touch.start(0ns);
  Touch::Wrenches mean;
  for (int k = 1; k <= 30; ++k) {
    State<6> state;
    state.time = k * 4ms;
    for (std::size_t i = 0; i < 6; ++i) {
      state.dq[i] = speed * ((k % 2) != 0 ? 1 : -1);
      state.q[i] = 0.1 * double(i) + 0.004 * k * state.dq[i];
    }
    MotorInput<6> input;
    input.motor_torque = told;
    CHECK_FALSE(touch.receive(memory, {}, input, state, state.time - 4ms, state.time, 1, &mean).any());
  }
  return mean.torque;
}

}  // namespace

TEST_CASE("RobotObserver: the torque told is the torque felt, behind gate and gain, however the arm moves") {
  const JointTorque<6> told{10, -4, 1.5, 2.5, 0, -30};
  for (const double speed : {0.0, 3.0}) {
    CAPTURE(speed);
    const auto felt = felt_after(told, speed);
    const double expected[6] = {4, -1, 0, 0.25, 0, -14};  // (|told| - 2)/2
    for (std::size_t i = 0; i < 6; ++i) CHECK(felt[i] == doctest::Approx(expected[i]));
  }
}

TEST_CASE("RobotObserver: numbers that are not finite and stamps that go back are refused and named") {
  const RobotObserver<ur5::Model> observer{ur5::Model{}};
  RobotObserver<ur5::Model>::Memory memory;
  State<6> state;
  state.time = 8ms;
  JointTorque<6> told{1, 2, 3, 4, 5, 6};
  CHECK_FALSE(observer.observe(memory, state, told).any());
  CHECK(memory.residual == told);
  const auto good = memory;
  CHECK(observer.observe(memory, state, told).has(Reason::time_backwards));
  state.time = 12ms;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    told[4] = bad;
    CHECK(observer.observe(memory, state, told).has(Reason::sample_not_finite));
  }
  told[4] = 0, state.q[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(observer.observe(memory, state, told).has(Reason::sample_not_finite));
  CHECK(memory == good);
}
