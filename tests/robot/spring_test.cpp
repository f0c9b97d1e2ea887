#include "skinctl/robot/spring.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <type_traits>

#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

static_assert(std::is_same_v<ServoOf<Interface::impedance, 6, double, 8>, Spring<6, double, 8>>);
static_assert(std::is_same_v<ServoOf<Interface::velocity, 6, double, 8>, DelayLag<6, double, 8>>);
static_assert(has_servo<Interface::impedance> && !has_servo<Interface::torque>);
static_assert(std::is_trivially_copyable_v<Spring<6, double, 32>::Memory>);
static_assert(ImpedanceCommand<6>::holds_position && ImpedanceCommand<6>::holds_torque &&
              !ImpedanceCommand<6>::holds_velocity);

namespace {

template <class T>
RobotConfiguration<6, T> springs(Nanoseconds lag) {
  RobotConfiguration<6, T> c{
      .limits = limits_of<ur5::Description, T>(T(20)), .period = 8ms, .delay = 16ms, .lag = lag};
  c.stiffness = JointTorque<6, T>::constant(T(500));
  return c;
}

}  // namespace

TEST_CASE_TEMPLATE("Spring: stands where DelayLag does, and beside it by push over stiffness", T, float,
                   double) {
  const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-14;
  const Spring<6, T, 8> spring(springs<T>(10ms));
  const DelayLag<6, T, 8> plain(16ms, T(0.01));
  const JointPosition<6, T> q = JointPosition<6, T>::constant(T(0.2));
  auto m = spring.start(0ns, q, {});
  auto p = plain.start(0ns, q, {});
  JointTorque<6, T> pushed;
  pushed[0] = T(40), pushed[3] = T(-10);
  for (int k = 1; k < 100; ++k) {
    const auto& due = spring.due(m, k * 8ms, pushed);
    const auto& without = plain.due(p, k * 8ms);
    const double share = 1 - std::exp(-k * 0.8);
    CHECK(double(due[0] - without[0]) == doctest::Approx(0.08 * share).epsilon(1e-5));
    CHECK(double(due[3] - without[3]) == doctest::Approx(-0.02 * share).epsilon(1e-5));
    CHECK(std::abs(double(due[1] - without[1])) <= tolerance);
    const auto next = JointPosition<6, T>::constant(T(0.2 + 0.001 * k));
    spring.send(m, k * 8ms, next, {});
    plain.send(p, k * 8ms, next, {});
  }
  spring.each_under_way(m, [&](const auto& to) { CHECK(double(to[0]) < 0.31); });
}

TEST_CASE("Spring: without lag it is deflected at once; a time that goes back deflects nothing") {
  const Spring<6, double, 8> spring(springs<double>(0ns));
  auto m = spring.start(0ns, {}, {});
  CHECK(spring.due(m, 8ms, JointTorque<6>::constant(20))[2] == doctest::Approx(0.04));
  CHECK(spring.due(m, 4ms, JointTorque<6>::constant(-20))[2] == doctest::Approx(0.04));
  CHECK(spring.due(m, 12ms, {})[2] == 0);
}

TEST_CASE("Spring: a push beyond the torque limit counts as that; one that is no number as the last") {
  const auto c = springs<double>(0ns);
  const Spring<6, double, 8> spring(c);
  auto m = spring.start(0ns, {}, {});
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const double most = c.limits.torque()[0] / 500;
  CHECK(spring.due(m, 1ms, JointTorque<6>::constant(inf))[0] == doctest::Approx(most));
  CHECK(spring.due(m, 2ms, JointTorque<6>::constant(nan))[0] == doctest::Approx(most));
  CHECK(spring.due(m, 3ms, JointTorque<6>::constant(-1e9))[0] == doctest::Approx(-most));
}
