#include "skinctl/resolver/configuration.hpp"

#include <doctest/doctest.h>

#include <string>

#include "skinctl/model/ur5.hpp"
#include "skinctl/resolver/detail/virtual_joints.hpp"

using namespace skinctl;

namespace {

// What a resolver builds from its configuration, whatever its model.
using Joints = detail::VirtualJoints<Interface::position, 6, double, 32>;

ResolverConfiguration<6> configuration() {
  ResolverConfiguration<6> c{
      .limits = limits_of<ur5::Description>(40.0), .period = 8_ms, .delay = 8_ms, .lag = 0.008};
  c.shape.viscous = {20, 20, 10, 2, 1, 0.5};
  return c;
}

}  // namespace

TEST_CASE("ResolverConfiguration: refuses that cannot work, with the number and the range") {
  const auto refusal = [](auto&& change) -> std::string {
    auto c = configuration();
    change(c);
    try {
      const Joints joints(c);
    } catch (const ConfigurationError& e) {
      return e.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(refusal([](auto&) {}).empty());
  CHECK(refusal([](auto& c) { c.period = 0; }).find("period [ns] = 0") != std::string::npos);
  CHECK(refusal([](auto& c) { c.delay = -1; }).find("delay") != std::string::npos);
  CHECK(refusal([](auto& c) { c.delay = 300_ms; }) ==
        "skinctl: delay / period = 37.5, allowed: <= History - 2: commands under way");
  CHECK(refusal([&](auto& c) { c.lag = nan; }).find("lag = nan") != std::string::npos);
  CHECK(refusal([](auto& c) { c.observer = 13; }).find("observer w = 13") !=
        std::string::npos);  // 0.3/0.024 = 12.5
  CHECK(refusal([](auto& c) { c.observer = 12.5; }).empty());
  CHECK(refusal([](auto& c) { c.dead_band[3] = 0; }).find("dead band = 0") != std::string::npos);
  CHECK(refusal([](auto& c) { c.dead_band[3] = 0.2; }).find("leash") != std::string::npos);
  CHECK(refusal([](auto& c) { c.leash = 1; }).find("leash = 1") != std::string::npos);
  CHECK(refusal([](auto& c) { c.lead = 0.1; }).find("lead = 0.1") != std::string::npos);
  CHECK(refusal([](auto& c) { c.drift = -1; }).find("drift") != std::string::npos);
  CHECK(refusal([](auto& c) { c.substep = 50_ms; }).find("sub-step") != std::string::npos);
  CHECK(refusal([](auto& c) { c.longest_interval = 1_ms; }).find("longest interval") != std::string::npos);
  CHECK(refusal([](auto& c) { c.stale_after = 0; }).find("stale after") != std::string::npos);
  CHECK(refusal([](auto& c) { c.retry = 0; }).find("retry") != std::string::npos);
  CHECK(refusal([](auto& c) { c.shape.viscous[2] = -3; }).find("viscous friction = -3") != std::string::npos);
  CHECK(refusal([&](auto& c) { c.shape.coulomb[2] = nan; }).find("Coulomb friction") != std::string::npos);
  CHECK(refusal([](auto& c) { c.shape.inertia[2] = -1; }).find("added inertia") != std::string::npos);
  CHECK(refusal([](auto& c) { c.shape.decay = -1; }).find("decay") != std::string::npos);
}

TEST_CASE("Interval: equal parts that leave out and repeat nothing") {
  const Joints robot(configuration());
  auto m = robot.start({5_s, {}, {}});
  for (const Nanoseconds dt : {Nanoseconds(1), 999_us, 2_ms, 2000001_ns, 8_ms, 12345678_ns, 40_ms}) {
    const auto interval = robot.interval(m, 5_s + dt);
    CHECK(interval.from == 5_s);
    CHECK(interval.to == 5_s + dt);
    CHECK(interval.at(0) == interval.from);
    CHECK(interval.at(interval.substeps) == interval.to);
    Nanoseconds least = INT64_MAX, most = 0;
    for (unsigned j = 0; j < interval.substeps; ++j) {
      const Nanoseconds part = interval.at(j + 1) - interval.at(j);
      least = std::min(least, part);
      most = std::max(most, part);
    }
    CHECK(most - least <= 1);
    CHECK((most <= 2_ms || interval.substeps == max_substeps));
    CHECK_FALSE(interval.status.any());
  }
  CHECK(robot.interval(m, 5_s).status == Reason::interval_empty);
  CHECK(robot.interval(m, 5_s).substeps == 0);
  CHECK(robot.interval(m, 5_s - 1).status == Reason::time_backwards);
  CHECK(robot.interval(m, INT64_MIN).status == Reason::time_backwards);
  CHECK(robot.interval(m, INT64_MAX).status == Reason::time_backwards);
  const auto late = robot.interval(m, 7_s);
  CHECK(late.status == Reason::interval_too_long);
  CHECK(late.from == 7_s - 40_ms);
}
