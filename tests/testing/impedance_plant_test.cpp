#include "skinctl/testing/impedance_plant.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/energy.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {
const JointPosition<6> pose{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
testing::ImpedanceTruth<6> truth() {
  return {.stiffness = JointTorque<6>::constant(500), .rotors = JointTorque<6>::constant(0.1)};
}
}  // namespace

TEST_CASE("ImpedancePlant: rests where it is, by the push over its stiffness beside, and comes back") {
  testing::ImpedancePlant<ur5::Model> plant(ur5::Model{}, truth(), pose);
  plant.run(0.5);
  for (std::size_t i = 0; i < 6; ++i) CHECK(plant.q()[i] == doctest::Approx(pose[i]).epsilon(1e-12));
  JointTorque<6> push;
  push[0] = 40, push[4] = -5;
  plant.push(push);
  plant.run(3);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(plant.q()[i] - pose[i] - push[i] / 500) < 1e-6);
  // Its motors hold the push and the weight.
  const auto weight = gravity_torque(ur5::Model{}, plant.q());
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(plant.motor_torque()[i] == doctest::Approx(weight[i] - push[i]).epsilon(1e-6));
  plant.push({});
  plant.run(3);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(plant.q()[i] - pose[i]) < 1e-6);
}

TEST_CASE("ImpedancePlant: takes commands after its delay, within a period, with the torque beside them") {
  auto t = truth();
  t.delay = 0.02;
  testing::ImpedancePlant<ur5::Model> plant(ur5::Model{}, t, pose);
  ImpedanceCommand<6> command;
  command.position = pose;
  command.position[0] += 0.01;
  command.torque[1] = 5;
  plant.command(command);
  plant.run(0.019);
  CHECK(plant.reference()[0] == pose[0]);
  plant.run(0.003);
  CHECK(plant.reference()[0] == doctest::Approx(pose[0] + 0.01).epsilon(1e-12));
  plant.run(3);
  CHECK(plant.q()[0] == doctest::Approx(pose[0] + 0.01).epsilon(1e-6));
  CHECK(plant.q()[1] == doctest::Approx(pose[1] + 0.01).epsilon(1e-6));
}
