#include "skinctl/resolver/following_monitor.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/closed_loop.hpp"
#include "skinctl/testing/undeclared_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<FollowingMonitor<6>::Memory>);

namespace {

constexpr std::array<double, 6> pose{0.1, -1.2, 1.2, -1, -1.5, 0.3};

struct Outcome {
  Following<6> found;
  Nanoseconds proposed_delay{}, proposed_lag{};
  Status seen;
};

// An arm that is led to and fro for `time` seconds; from `blocked_from` on, joint 0 is held fast now and then.
Outcome lead(const JointTruth<6>& truth, double time, double swing = 1, double blocked_from = 1e9,
             std::uint64_t seed = 1) {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(20.0), .period = 8ms, .delay = 8ms, .lag = 8ms};
  c.virtual_damping = 4;
  using Robot = Resolver<Interface::position, ur5::Model>;
  const Robot robot(ur5::Model{}, c);
  const FollowingMonitor monitor(c);
  UndeclaredJoints<6> joints(UndeclaredJoints<6>::Kind::position, truth, pose, seed);
  const auto measure = [&](Nanoseconds now) {
    const auto m = joints.measured();
    return State<6>{now, JointPosition<6>(m.q), JointVelocity<6>(m.dq)};
  };
  auto memory = robot.start(measure(0ns));
  decltype(monitor)::Memory watched;
  Yield law;
  Yield::Memory law_memory;
  Outcome out;
  for (Nanoseconds now = 8ms; now < nanoseconds(time); now += 8ms) {
    const double t = seconds<double>(now);
    joints.advance(t);
    joints.hold_fast(0, t > blocked_from && std::fmod(t, 2) > 1);
    Pushed<6, double> push;
    push.torque = {swing * 12 * std::sin(3 * t),
                   swing * 8 * std::sin(2.2 * t),
                   swing * 5 * std::sin(4 * t),
                   swing * std::sin(5 * t),
                   0,
                   0};
    std::array<Pushed<6, double>, max_substeps> pushes;
    pushes.fill(push);
    const auto result = robot.step(memory, law, law_memory, measure(now), robot.interval(memory, now),
                                   std::span<const Pushed<6, double>>(pushes));
    monitor.step(watched, memory);
    out.seen |= result.status;
    std::array<double, 6> q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = result.command.position[i];
    joints.command(t, q);
  }
  out.found = monitor.estimate(watched);
  const auto proposed = monitor.proposed(c, watched);
  out.proposed_delay = proposed.delay;
  out.proposed_lag = proposed.lag;
  return out;
}

}  // namespace

TEST_CASE("Following: finds the lag and the gap that were not declared") {
  int within = 0, cases = 0;
  for (const double lag : {0.004, 0.008, 0.018, 0.038, 0.058})
    for (const double gap : {0.0, 0.02, -0.03})
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        JointTruth<6> truth;
        truth.delay = 0.008;
        truth.lag = lag;
        truth.gap[1] = gap;
        truth.noise = 1e-4;
        truth.resolution = 5e-5;
        const auto out = lead(truth, 20, 1, 1e9, seed);
        CAPTURE(lag);
        CAPTURE(gap);
        CAPTURE(out.found.lag);
        CAPTURE(out.found.lag_deviation);
        CHECK(std::abs(out.found.lag - (lag - 0.008)) < 1.5e-3);
        CHECK(std::abs(out.found.gap[1] - gap) < 2e-3);
        CHECK(std::abs(out.found.gap[0]) < 2e-3);
        CHECK(std::abs(seconds<double>(out.proposed_delay + out.proposed_lag) - 0.008 - lag) < 1.5e-3);
        ++cases;
        within += std::abs(out.found.gap[1] - gap) < 3 * out.found.gap_deviation[1] + 2e-4 ? 1 : 0;
      }
  CHECK(within >= 0.9 * cases);
}

TEST_CASE("Following: a robot that rests shows its gap, and nothing of its lag") {
  JointTruth<6> truth;
  truth.delay = truth.lag = 0.008;
  truth.gap[2] = 0.04;
  truth.noise = 1e-4;
  const auto out = lead(truth, 10, 0);
  CHECK(out.found.gap[2] == doctest::Approx(0.04).epsilon(0.01));
  CHECK(out.found.lag_deviation > 1);
  CHECK(out.proposed_lag == 8ms);
}

TEST_CASE("Following: obstacles are not taken for a lag") {
  JointTruth<6> truth;
  truth.delay = truth.lag = 0.008;
  const auto out = lead(truth, 40, 1, 5);
  CHECK(out.seen.has(Reason::blocked));
  CAPTURE(out.found.lag);
  CHECK(std::abs(out.found.lag) < 3e-3);
}

TEST_CASE("Following: before it has seen anything it knows nothing") {
  const RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(20.0), .period = 8ms};
  const FollowingMonitor monitor(c);
  const auto found = monitor.estimate({});
  CHECK(found.observed == 0);
  CHECK(found.lag == 0);
  CHECK(std::isinf(found.lag_deviation));
  CHECK_THROWS_AS(FollowingMonitor(c, 1ms), ConfigurationError);
}
