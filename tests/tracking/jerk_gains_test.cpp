// Promise: gains that a limit of jerk would leave swinging for ever after a touch are refused, and those that
// are taken come to rest
// Tried: UR5 by position, 2 and 8 ms, lag 4 to 40 ms, A/J up to a second, a push of 10 to 60 N on each of six
// cells for a second. With the gains of a scene without `MaxJerk` 289 of 448 such arms swung on with up to
// 0.67 rad/s, those with `lambda K_c (A/J)^2 <= 1` never. With viscous friction of up to 20 N m s on the
// joints of the wrist 146 of 400 of those did; with `(lambda + k) K_c (A/J)^2 <= 1` all come to rest
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "bench/studies/attack/common.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace attacks;

namespace {

constexpr double rests = 0.02;  ///< speed of a joint at rest [rad/s]

struct Drawn {
  RobotConfiguration<6> arm{.limits = limits_of<ur5::Description>(15.0), .period = 8ms};
  MaxJerk<6> jerk{};
  double push = 0;  ///< [N]
  std::size_t cell = 0;

  explicit Drawn(std::uint64_t seed) {
    std::mt19937_64 rng(seed);
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    const double acceleration = roll(5, 30);
    arm.limits = limits_of<ur5::Description>(acceleration);
    arm.period = rng() % 2 == 0 ? 8ms : 2ms;
    arm.lag = nanoseconds(roll(0.004, 0.04));
    arm.virtual_damping = roll(3, 8);
    jerk.jerk = JointJerk<6>::constant(acceleration * std::pow(10, roll(0, 2.5)));
    push = roll(10, 60);
    cell = rng() % cells;
  }
  [[nodiscard]] auto robot() const { return by_position(ur5::Model{}, arm); }
};
/// With viscous friction on the joints of the wrist.
Drawn rubbing(std::uint64_t seed) {
  Drawn d(seed);
  std::mt19937_64 rng(seed + 1000);
  for (std::size_t i = 3; i < 6; ++i)
    d.arm.viscous_friction[i] = std::uniform_real_distribution<>(0, 20)(rng);
  return d;
}
/// The largest speed between two turns of a joint, long after a touch of a second.
template <class Scene>
double swing_after_a_touch(const Scene& scene, const Drawn& d) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> x{0ns, attacks::home, {}};
  scene.start(*memory, x);
  typename SimulatedJoints<6>::Row row{};
  for (std::size_t i = 0; i < 6; ++i) row[i] = attacks::home[i];
  SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, 0.0, seconds<double>(d.arm.lag), row);
  Swings swings(rests);
  for (Nanoseconds now = d.arm.period; now < 20s; now += d.arm.period) {
    joints.advance(seconds<double>(now));
    for (std::size_t i = 0; i < 6; ++i) {
      x.dq[i] = (joints.q()[i] - x.q[i]) / seconds<double>(d.arm.period);
      x.q[i] = joints.q()[i];
    }
    x.time = now;
    Forces force{};
    if (now > 1s && now < 2s) force[d.cell] = d.push;
    const auto sent = samples(force, now);
    typename Scene::Input input;
    input.now = now, input.measured = x, input.samples = sent;
    const auto out = scene.step(*memory, input);
    for (std::size_t i = 0; i < 6; ++i) row[i] = out.planned.position[i];
    joints.command(seconds<double>(now), row);
    if (now > 15s) swings.take(x.dq);
  }
  return swings.worst();
}
/// What a scene of this law and limit is refused with; empty: it is taken.
template <class Law>
std::string refused(const Drawn& d, const Law& law) {
  const auto of = [](const auto& make) -> std::string {
    try {
      static_cast<void>(make());
    } catch (const ConfigurationError& e) {
      return e.what();
    }
    return {};
  };
  const Cycle plain(d.robot(), skin(), law);
  return of([&] { return plain.with(d.jerk); });
}

}  // namespace

TEST_CASE("limit of jerk: gains that fit come to rest after a touch, others are refused") {
  int taken = 0, refusals = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Drawn d(seed);
    const auto gains = tracking_settings(d.robot());
    const double rise = d.arm.limits.acceleration()[0] / d.jerk.jerk[0];
    const bool fits = gains.lambda * gains.K_c * rise * rise <= 1;
    const auto law_of = [](const JointControlSettings<6>& s) {
      return SplineJoint<6>(s) + SkinJointControl{} + GravityControl{};
    };
    CAPTURE(seed);
    const std::string why = refused(d, law_of(gains));
    CHECK(why.empty() == fits);
    if (!fits) {
      ++refusals;
      CHECK(why.find("MaxJerk") != std::string::npos);
      CHECK(why.find("tracking_settings(robot, jerk)") != std::string::npos);
    }
    taken += fits;
    const auto fitting = fits ? gains : tracking_settings(d.robot(), d.jerk.jerk);
    CHECK(refused(d, law_of(fitting)).empty());
    if (seed % 4 == 0)
      CHECK(swing_after_a_touch(Cycle(d.robot(), skin(), law_of(fitting)).with(d.jerk), d) <= rests);
  }
  CHECK(taken > 5);
  CHECK(refusals > 5);
}

TEST_CASE("limit of jerk: friction on a light joint, which the law compensates, is a gain too") {
  int refusals = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Drawn plain(seed), d = rubbing(seed);
    const auto unlike = tracking_settings(plain.robot(), d.jerk.jerk),
               fit = tracking_settings(d.robot(), d.jerk.jerk);
    auto gains = fit;  // of an arm without friction
    gains.lambda = unlike.lambda, gains.K_c = unlike.K_c, gains.K_i1 = unlike.K_i1, gains.K_i2 = unlike.K_i2;
    const auto law_of = [](const JointControlSettings<6>& s) {
      return SplineJoint<6>(s) + SkinJointControl{} + GravityControl{};
    };
    CAPTURE(seed);
    refusals += !refused(d, law_of(gains)).empty();
    CHECK(refused(d, law_of(fit)).empty());
    CHECK(fit.lambda <= unlike.lambda);
    CHECK(fit.K_c <= unlike.K_c);
    if (seed % 4 == 0)
      CHECK(swing_after_a_touch(Cycle(d.robot(), skin(), law_of(fit)).with(d.jerk), d) <= rests);
  }
  CHECK(refusals > 5);
}

TEST_CASE("limit of jerk: gains are looked at in each law that holds them") {
  Drawn d(1);
  d.jerk.jerk = JointJerk<6>::constant(d.arm.limits.acceleration()[0]);  // a second
  const auto gains = tracking_settings(d.robot()), fit = tracking_settings(d.robot(), d.jerk.jerk);
  const auto all = [&](const auto& law_of) {
    CHECK_FALSE(refused(d, law_of(gains)).empty());
    CHECK(refused(d, law_of(fit)).empty());
  };
  all([](const auto& s) { return SplineJoint<6>(s) + GravityControl{}; });
  all([](const auto& s) { return 0.5 * SplineJoint<6>(s) + SkinJointControl{} + GravityControl{}; });
  all([](const auto& s) {
    return task_priority<5>(SplineJoint<6>(s), SkinJointControl{}) + GravityControl{};
  });
}

TEST_CASE("limit of jerk: a robot in groups is told gains that fit, and they are taken") {
  for (const double rise : {0.01, 0.1, 1.0}) {
    Drawn d(1);
    d.jerk.jerk = JointJerk<6>::constant(d.arm.limits.acceleration()[0] / rise);
    // Joints by torque accelerate as they like: their jerk does not count.
    for (std::size_t i = 3; i < 6; ++i) d.jerk.jerk[i] = d.arm.limits.acceleration()[i] / 100;
    const auto part = [&]<LinkMask Set>() {
      using S = JointSubset<6, Set>;
      const auto v = d.arm.limits.values();
      RobotConfiguration<3> c{.limits = JointLimits<3>({.lower = S::of(v.lower),
                                                        .upper = S::of(v.upper),
                                                        .velocity = S::of(v.velocity),
                                                        .acceleration = S::of(v.acceleration),
                                                        .torque = S::of(v.torque)}),
                              .period = d.arm.period};
      if (Set == 0b000111) c.virtual_damping = 4;
      return c;
    };
    const auto robot =
        by_groups(ur5::Model{}, position_joints<0b000111>(part.template operator()<0b000111>()),
                  torque_joints<0b111000>(part.template operator()<0b111000>()));
    const auto scene_of = [&](const auto& gains) {
      return Cycle(robot, SplineJoint<6>(gains) + GravityControl{}).with(d.jerk);
    };
    const auto gains = tracking_settings(robot);
    CAPTURE(rise);
    if (gains.lambda * gains.K_c * rise * rise > 1)
      CHECK_THROWS_AS(static_cast<void>(scene_of(gains)), ConfigurationError);
    CHECK_NOTHROW(static_cast<void>(scene_of(tracking_settings(robot, d.jerk.jerk))));
  }
}
