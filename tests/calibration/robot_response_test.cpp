// runs long: recordings of a robot
#include "skinctl/calibration/robot_response.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/calibration/response_motion.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "skinctl/testing/undeclared_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::array<double, 6> pose{0.1, -1.2, 1.2, -1, -1.5, 0.3};

// The log of a robot that makes the motion, loaded by the gravity of its links where its servos give way.
ResponseLog<6> log_of(const JointTruth<6>& truth, std::uint64_t seed, const ResponseMotion<6>& motion,
                      double period = 0.008) {
  ResponseLog<6> log;
  UndeclaredJoints<6> joints(UndeclaredJoints<6>::Kind::position, truth, pose, seed);
  for (double t = 0; t < motion.settings().duration; t += period) {
    const auto G = gravity_torque(ur5::Model{}, JointPosition<6>(joints.q()));
    std::array<double, 6> load{};
    for (std::size_t i = 0; i < 6; ++i) load[i] = -G[i];
    joints.external(load);
    joints.advance(t);
    const auto& m = joints.measured();
    if (m.fresh) log.measured.push_back({m.time, m.q});
    const auto q = motion.at(t);
    log.sent.push_back({t, q});
    joints.command(t, q);
  }
  std::sort(log.measured.begin(), log.measured.end(),
            [](const auto& a, const auto& b) { return a.time < b.time; });
  return log;
}

}  // namespace

TEST_CASE("Response: delay, lag, gap, stiffness and encoders of a robot come out as they are") {
  int covered = 0, cases = 0;
  const int seeds = sanitized ? 1 : 3;
  for (const double delay : {0.006, 0.021})
    for (const double lag : {0.01, 0.04})
      for (const double stiffness : {2000.0, 1e9})
        for (int seed = 1; seed <= seeds; ++seed) {
          JointTruth<6> truth;
          truth.delay = delay;
          truth.lag = lag;
          truth.stiffness = truth.all(stiffness);
          truth.inertia = truth.all(0.1);
          truth.gap = {0.01, -0.02, 0, 0.03, 0, 0.005};
          truth.noise = 2e-5;
          const auto found =
              identify_response(ur5::Model{}, log_of(truth, std::uint64_t(seed), ResponseMotion<6>(pose)));
          CAPTURE(delay);
          CAPTURE(lag);
          CAPTURE(stiffness);
          CAPTURE(found.delay.value);
          CAPTURE(found.lag.value);
          CHECK(std::abs(found.total_delay.value - delay - lag) < 1e-3);
          CHECK(std::abs(found.delay.value - delay) < 2e-3);
          CHECK(std::abs(found.lag.value - lag) < 0.1 * lag + 1e-3);
          for (std::size_t i = 0; i < 6; ++i) {
            CAPTURE(i);
            CHECK(std::abs(found.joint[i].gap.value - truth.gap[i]) < 1e-3);
            const auto& c = found.joint[i].compliance;
            if (i == 0) CHECK_FALSE(c.known());  // a vertical axis feels no gravity
            if (c.known()) CHECK(std::abs(c.value - 1 / stiffness) < 4 * c.deviation + 1e-5);
            if (i == 1 || i == 2) CHECK(c.deviation < (i == 1 ? 5e-5 : 2e-4));
            covered +=
                std::abs(found.joint[i].gap.value - truth.gap[i]) < 3 * found.joint[i].gap.deviation + 1e-5;
            ++cases;
          }
          CHECK(found.skipped == 0);
          CHECK(found.period == doctest::Approx(0.008));
        }
  CHECK(covered >= 0.9 * cases);
}

TEST_CASE("Response: friction is a hysteresis, steps and lost measurements are counted") {
  JointTruth<6> truth;
  truth.delay = 0.01;
  truth.lag = 0.015;
  truth.stiffness = truth.all(3000);
  truth.inertia = truth.all(0.2);
  truth.coulomb = truth.all(6);
  truth.resolution = 1e-4;
  truth.skipped = 0.05;
  const auto found = identify_response(ur5::Model{}, log_of(truth, 5, ResponseMotion<6>(pose)));
  for (std::size_t i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(found.joint[i].hysteresis.value == doctest::Approx(6.0 / 3000).epsilon(0.15));
    CHECK(found.joint[i].resolution == doctest::Approx(1e-4).epsilon(0.02));
    CHECK(found.joint[i].speed > 0.15);
    CHECK(found.joint[i].speed < 0.45);
  }
  CHECK(std::abs(found.skipped - 0.05) < 0.02);
}

TEST_CASE("Response: a robot that rests shows its gap; nothing else is known") {
  ResponseLog<6> log;
  for (int k = 0; k < 400; ++k) {
    auto q = pose;
    q[2] += 0.02 + 1e-6 * (k % 3);
    log.sent.push_back({0.008 * k, pose});
    log.measured.push_back({0.008 * k, q});
  }
  const auto found = identify_response(ur5::Model{}, log);
  CHECK_FALSE(found.delay.known());
  CHECK_FALSE(found.lag.known());
  CHECK(found.joint[2].gap.value == doctest::Approx(0.02).epsilon(0.001));
  CHECK_FALSE(found.joint[2].hysteresis.known());
}

TEST_CASE("Response: bad logs are refused with the entry") {
  ResponseLog<6> log;
  CHECK_THROWS_AS((void)identify_response(ur5::Model{}, log), ConfigurationError);
  for (int k = 0; k < 300; ++k)
    log.sent.push_back({0.008 * k, pose}), log.measured.push_back({0.008 * k, pose});
  auto bad = log;
  bad.measured[7].q[2] = std::nan("");
  CHECK_THROWS_WITH_AS((void)identify_response(ur5::Model{}, bad), doctest::Contains("measurement = 7"),
                       ConfigurationError);
  bad = log;
  bad.sent[9].time = 0;
  CHECK_THROWS_WITH_AS((void)identify_response(ur5::Model{}, bad), doctest::Contains("command = 9"),
                       ConfigurationError);
}
