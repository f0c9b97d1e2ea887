#include "skinctl/robot/servo.hpp"

#include <doctest/doctest.h>

#include <random>
#include <type_traits>

#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using testing::SimulatedJoints;

static_assert(std::is_trivially_copyable_v<CommandsUnderWay<6, double, 32>>);

namespace {

template <class T>
JointPosition<2, T> row(double a, double b) {
  return {T(a), T(b)};
}

// Random commands at jittered times to declared and simulated joints; how far they ever are apart.
template <class T>
double apart(SimulatedJoints<2>::Kind kind, Nanoseconds delay, double lag, Nanoseconds period, bool jitter) {
  using Kind = SimulatedJoints<2>::Kind;
  const DelayLag<2, T, 64> servo(delay, T(lag));
  SimulatedJoints<2> joints(kind, seconds<double>(delay), lag, {0.3, -0.2});
  auto memory = servo.start(0ns, row<T>(0.3, -0.2), {});
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  JointPosition<2, double> integral{0.3, -0.2};
  JointVelocity<2, double> last{};
  Nanoseconds now{};
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const Nanoseconds dt = jitter ? nanoseconds(seconds<double>(period) * (1 + 0.9 * unit(rng))) : period;
    now += dt;
    const double t = seconds<double>(now);
    joints.advance(t);
    const auto& q = servo.due(memory, now);
    for (std::size_t i = 0; i < 2; ++i) worst = std::max(worst, std::abs(double(q[i]) - joints.q()[i]));
    const std::array<double, 2> value{std::sin(3 * t) + 0.2 * unit(rng), std::cos(5 * t)};
    joints.command(t, value);
    if (kind == Kind::position) {
      servo.send(memory, now, row<T>(value[0], value[1]), {});
    } else {
      integral = integrate(integral, last, seconds<double>(dt));
      last = {value[0], value[1]};
      servo.send(memory, now, integral.cast<T>(), last.cast<T>());
    }
  }
  return worst;
}

}  // namespace

TEST_CASE_TEMPLATE("DelayLag: predicts joints that do what is declared", T, float, double) {
  using Kind = SimulatedJoints<2>::Kind;
  const double tolerance = std::is_same_v<T, float> ? 2e-5 : 1e-10;
  for (const Kind kind : {Kind::position, Kind::velocity})
    for (const Nanoseconds delay : {300us, 3100us, 8300us, 40700us})
      for (const double lag : {0.0, 1e-6, 0.004, 0.05})
        for (const bool jitter : {false, true}) {
          CAPTURE(delay.count());
          CAPTURE(lag);
          CAPTURE(jitter);
          CHECK(apart<T>(kind, delay, lag, 2ms, jitter) < tolerance);
        }
}

TEST_CASE_TEMPLATE("DelayLag: a steady motion at the start goes on", T, float, double) {
  const DelayLag<2, T, 8> servo(8ms, T(0.01));
  auto memory = servo.start(1s, row<T>(1, 2), {T(0.5), T(-1)});
  const auto& q = servo.due(memory, 1s + 20ms);
  CHECK(double(q[0]) == doctest::Approx(1.01).epsilon(1e-6));
  CHECK(double(q[1]) == doctest::Approx(1.98).epsilon(1e-6));
}

TEST_CASE("DelayLag: times that go back leave the prediction where it was") {
  const DelayLag<1, double, 8> servo(2ms, 0.01);
  auto memory = servo.start(0ns, JointPosition<1>::constant(0), {});
  servo.send(memory, 0ns, JointPosition<1>::constant(1), {});
  const double q = servo.due(memory, 10ms)[0];
  CHECK(servo.due(memory, 4ms)[0] == q);
  CHECK(servo.due(memory, 10ms)[0] == q);
  CHECK(servo.due(memory, 11ms)[0] > q);
}

TEST_CASE("DelayLag: more commands than there is room for count as carried out, from the oldest") {
  const DelayLag<1, double, 4> servo(1s, 0.0);
  auto memory = servo.start(0ns, JointPosition<1>::constant(0), {});
  for (int k = 1; k <= 10; ++k) servo.send(memory, k * 10ms, JointPosition<1>::constant(k), {});
  CHECK(memory.count == 4);
  CHECK(servo.due(memory, 101ms)[0] == 7);  // 8, 9, 10 are still under way
  CHECK(servo.due(memory, 2s)[0] == 10);
}

TEST_CASE("DelayLag: what was not sent as told is corrected") {
  const DelayLag<1, double, 4> servo(1ms, 0.0);
  auto memory = servo.start(0ns, JointPosition<1>::constant(0), {});
  servo.send(memory, 0ns, JointPosition<1>::constant(5), {});
  servo.correct(memory, JointPosition<1>::constant(2), {});
  CHECK(servo.due(memory, 2ms)[0] == 2);
}
