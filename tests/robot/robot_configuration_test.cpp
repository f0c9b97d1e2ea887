#include "skinctl/robot/robot_configuration.hpp"

#include <doctest/doctest.h>

#include <string>

#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;

namespace {

// What a resolver builds from its configuration, whatever its model.
using Joints = detail::VirtualJoints<Interface::position, 6, double, 32>;

RobotConfiguration<6> configuration() {
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(40.0),
                          .period = 8ms,
                          .delay = 8ms,
                          .lag = 8ms,
                          .virtual_damping = 0};
  c.viscous_friction = {20, 20, 10, 2, 1, 0.5};
  return c;
}

}  // namespace

TEST_CASE("RobotConfiguration: refuses that cannot work, with the number and the range") {
  const auto refusal = [](auto&& change) -> std::string {
    auto c = configuration();
    change(c);
    return complaint_of([&] { const Joints joints(c); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(refusal([](auto&) {}).empty());
  CHECK(refusal([](auto& c) { c.period = 0ns; }).find("period = 0, allowed: 0.1 to 1000 ms") !=
        std::string::npos);
  CHECK(refusal([](auto& c) { c.delay = -1ns; }).find("delay") != std::string::npos);
  CHECK(refusal([](auto& c) { c.delay = 300ms; }) ==
        "skinctl: delay / period = 37.5, allowed: <= History - 2: commands under way");
  CHECK(refusal([](auto& c) { c.lag = -1ms; }).find("lag = -1, allowed: 0 to 1000 ms") != std::string::npos);
  CHECK(refusal([](auto& c) { c.lag = 2s; }).find("lag = 2000") != std::string::npos);
  CHECK(refusal([](auto& c) { c.drift = 13; }).find("drift = 13") != std::string::npos);  // 0.3/0.024 = 12.5
  CHECK(refusal([](auto& c) { c.drift = 12.5; }).empty());
  CHECK(refusal([](auto& c) { c.dead_band = JointPosition<6>::constant(0); }).find("dead band = 0") !=
        std::string::npos);
  CHECK(refusal([](auto& c) { c.undeclared_lag = 2s; }).find("undeclared lag = 2000") != std::string::npos);
  CHECK(refusal([](auto& c) { c.force_lead = 100ms; }).find("skinctl: force lead = 100") !=
        std::string::npos);
  CHECK(refusal([](auto& c) { c.drift = -1; }).find("drift") != std::string::npos);
  CHECK(refusal([](auto& c) { c.substep = 50ms; }).find("sub-step") != std::string::npos);
  CHECK(refusal([](auto& c) { c.longest_interval = 1ms; }).find("longest interval") != std::string::npos);
  CHECK(refusal([](auto& c) { c.stale_after = 0ns; }).find("stale after") != std::string::npos);
  CHECK(refusal([](auto& c) { c.viscous_friction[2] = -3; }).find("viscous friction = -3") !=
        std::string::npos);
  CHECK(refusal([&](auto& c) { c.coulomb_friction[2] = nan; }).find("Coulomb friction") != std::string::npos);
  CHECK(refusal([](auto& c) { c.virtual_inertia[2] = -1; }).find("virtual inertia") != std::string::npos);
  CHECK(refusal([](auto& c) { c.virtual_damping = -1; }).find("virtual damping") != std::string::npos);
}

TEST_CASE("Interval: equal parts that leave out and repeat nothing") {
  const ResolverBy<Interface::position, ur5::Model> robot(ur5::Model{}, configuration());
  auto m = robot.start({5s, {}, {}});
  for (const Nanoseconds dt :
       std::initializer_list<Nanoseconds>{1ns, 999us, 2ms, 2000001ns, 8ms, 12345678ns, 40ms}) {
    const auto interval = robot.interval(m, 5s + dt);
    CHECK(interval.from == 5s);
    CHECK(interval.to == 5s + dt);
    CHECK(interval.at(0) == interval.from);
    CHECK(interval.at(interval.substeps) == interval.to);
    Nanoseconds least = Nanoseconds::max(), most{};
    for (unsigned j = 0; j < interval.substeps; ++j) {
      const Nanoseconds part = interval.at(j + 1) - interval.at(j);
      least = std::min(least, part);
      most = std::max(most, part);
    }
    CHECK(most - least <= 1ns);
    CHECK((most <= 2ms || interval.substeps == max_substeps));
    CHECK_FALSE(interval.status.any());
  }
  CHECK(robot.interval(m, 5s).status == Status(Reason::interval_empty));
  CHECK(robot.interval(m, 5s).substeps == 0);
  CHECK(robot.interval(m, 5s - 1ns).status == Status(Reason::time_backwards));
  CHECK(robot.interval(m, Nanoseconds::min()).status == Status(Reason::time_backwards));
  CHECK(robot.interval(m, Nanoseconds::max()).status == Status(Reason::time_backwards));
  const auto late = robot.interval(m, 7s);
  CHECK(late.status == Status(Reason::interval_too_long));
  CHECK(late.from == 7s - 40ms);
}
