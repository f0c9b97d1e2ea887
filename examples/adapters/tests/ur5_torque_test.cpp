// The UR driver by torque: the simulated arm, with the friction that its controller leaves over, comes to
// rest at its target.
//
// Promise: by direct torque the simulated UR5 rests at its target and stands there, also where its
// controller compensates dry friction by the measured speed; targets that come in steps make no step of
// jerk
// Tried: without learning 1.80 degrees beside it, and 0.75 with 80 % compensated; with learnt friction
// 0.05 in both, moving by 0.009; positions 50 times a second: the reference's jerk stays below 40
// rad/s^3. Also: program `ur5_torque_study`

#include <doctest/doctest.h>

#include "examples/adapters/tests/under_torque.hpp"

using namespace under_torque;

TEST_CASE("UR driver: by torque the simulated arm rests within 0.1 degree of its target, and stands") {
  // The controller compensates dry friction by the measured speed, none at rest; learning takes what is left
  // over.
  const Rest without = rest(false, 0.8);
  MESSAGE("a fifth of friction left over, without learning: ", without.error / degree, " deg");
  CHECK(without.error > 0.5 * degree);
  for (const double scale : {0.0, 0.8}) {
    const Rest with = rest(true, scale);
    MESSAGE("compensated by the controller: ", scale, ": rests ", with.error / degree,
            " deg beside, moves by ", with.hunting / degree);
    CHECK(with.lost.empty());
    CHECK(with.moved > 0.25);
    CHECK(with.error < 0.1 * degree);
    CHECK(with.hunting < 0.02 * degree);
  }
}

TEST_CASE("UR driver: by torque, targets that come in steps at 50 Hz make no step of jerk") {
  const Following smooth = follow_steps<ReactiveJoint<6>>(0.8);
  MESSAGE("jerk ", smooth.jerk, " rad/s^3, torque step ", smooth.torque_step, " N m, error ",
          smooth.error / degree, " deg");
  CHECK(smooth.lost.empty());
  CHECK(smooth.jerk <= 40.1);  // max_jerk
  CHECK(smooth.error < 2 * degree);
}
