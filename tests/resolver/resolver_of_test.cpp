#include "skinctl/resolver/resolver_of.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {
const RobotConfiguration<6> stated{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
template <class... Parts>
auto made(const Parts&... parts) {
  return resolver_of(by_position(ur5::Model{}, stated, parts...));
}
}  // namespace

static_assert(std::is_same_v<decltype(made()), ResolverBy<Interface::position, ur5::Model>>);
static_assert(decltype(made(EnergyTank<>(), PassivityObserver<>()))::has_tank);
static_assert(decltype(made(EnergyTank<>(), PassivityObserver<>()))::has_passivity_observer);
static_assert(std::is_same_v<decltype(made(SemiImplicitEuler{})),
                             ResolverBy<Interface::position, ur5::Model, double, SemiImplicitEuler>>);

TEST_CASE("resolver_of: parts of a description become those of its resolver, in any order") {
  const auto kept = made(SemiImplicitEuler{}, EnergyTank<>({.start = 3}));
  CHECK(kept.passivity().get<EnergyTank<>>().settings().start == 3);
  CHECK(kept.parameters().period == 8ms);
  CHECK(kept.parameters().shape.damping == 4);
}

TEST_CASE("resolver_of: a long delay needs room for the commands under way, and gets it by name") {
  auto far = stated;
  far.period = 1ms;
  far.delay = 60ms;
  CHECK_THROWS_AS(static_cast<void>(resolver_of(by_position(ur5::Model{}, far))), ConfigurationError);
  CHECK_NOTHROW(static_cast<void>(resolver_of(by_position(ur5::Model{}, far, CommandHistory<64>{}))));
}

TEST_CASE("resolver_of: a robot that holds gravity is weightless to its laws") {
  const auto held = resolver_of(by_torque(ur5::Model{}, {.limits = stated.limits, .period = 2ms},
                                          RobotHoldsGravity{}, FrictionUncompensated{}));
  CHECK(gravity_torque(held.model(), JointPosition<6>{0, -1.2, 1.4, 0, 0, 0}) == JointTorque<6>{});
}
