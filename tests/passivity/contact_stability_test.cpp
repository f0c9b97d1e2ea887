#include "skinctl/passivity/contact_stability.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include "bench/studies/worlds/wall_contact.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

RobotConfiguration<6> configuration(Nanoseconds period, double delay, double lag, double decay) {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(1000.0), .period = period, .delay = nanoseconds(delay)};
  c.lag = nanoseconds(lag);
  c.virtual_damping = decay;
  c.viscous_friction = {20, 20, 10, 2, 1, 0.5};
  return c;
}
constexpr double tool[6] = {0.3, 0.5, 0.4, 0.15, 0.1, 0};
const JointPosition<6> pose{0.1, -1.5, 1.2, -1, -1.5, 0.3};

}  // namespace

TEST_CASE("ContactStability: pure friction and pure delay have the textbook's margin") {
  // With friction that outweighs every mass the loop is w_f k / (B s) exp(-s T), k_max = pi B / (2 T w_f), and
  // sampled tan(x)/x times as much, x = pi dt / (4 T).
  auto c = configuration(8ms, 0.02, 0, 0);
  c.viscous_friction = JointTorque<6>::constant(1e6);
  const double row[6] = {1, 0, 0, 0, 0, 0};
  for (const double gain : {1.0, 2.5}) {
    const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = 1e4, .force_gain = gain});
    CHECK(s.stiffest(pose, row) ==
          doctest::Approx(2 / 0.008 * 1e6 / gain * std::tan(M_PI * 0.008 / (4 * 0.024))).epsilon(1e-4));
  }
}

TEST_CASE("ContactStability: a frictionless robot rests in nothing, a row of zeros feels nothing") {
  auto c = configuration(8ms, 0.02, 0, 0);
  c.viscous_friction = {};
  const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = 1e4});
  const double none[6] = {};
  CHECK(s.stiffest(pose, tool) == 0);
  CHECK(s.stiffest(pose, none) == std::numeric_limits<double>::infinity());
}

TEST_CASE(
    "ContactStability: contact damping of 1.5 k T, a margin of 1.5 for a heavy mass and 2.4 for a light "
    "one") {
  for (const double decay : {0.0, 1.0, 10.0})
    for (const double delay : {0.002, 0.04}) {
      const auto c = configuration(2ms, delay, 0.005, decay);
      for (const double k : {1e2, 1e4, 1e6}) {
        const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = k});
        CHECK(s.margin(pose, tool, contact_damping(k, s.total_delay())) >= 1.5 * M_PI / 2 * 0.99);
        const double least = s.damping_for(pose, tool);
        if (least > 0) CHECK(s.margin(pose, tool, least) == doctest::Approx(2).epsilon(1e-3));
        CHECK(least <= contact_damping(k, s.total_delay()) * 2 / 1.5);
      }
    }
}

TEST_CASE("ContactStability: with friction of 1.5 k T a heavy virtual robot has a margin of 1.5") {
  auto c = configuration(2ms, 0.04, 0, 0);
  c.virtual_inertia = JointTorque<6>::constant(1e5);
  const double row[6] = {0.5, 0, 0, 0, 0, 0}, T = 0.042;
  c.viscous_friction = JointTorque<6>::constant(0.25 * contact_damping(100.0, T));
  const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = 100});
  CHECK(s.total_delay() == doctest::Approx(T));
  CHECK(s.margin(pose, row) == doctest::Approx(1.5).epsilon(0.02));
}

TEST_CASE("ContactStability: refuses what is too stiff, with the numbers") {
  const auto c = configuration(8ms, 0.02, 0.008, 4);
  const ContactStability<ur5::Model> soft(ur5::Model{}, c, {.stiffness = 100}),
      hard(ur5::Model{}, c, {.stiffness = 1e5, .cover = 3e4});
  soft.check(pose, tool);
  try {
    hard.check(pose, tool);
    FAIL_CHECK("nothing was thrown");
  } catch (const ConfigurationError& e) {
    const std::string text = e.what();
    char k[32];
    std::snprintf(k, sizeof k, "stable up to %.6g N/m", hard.stiffest(pose, tool));
    CAPTURE(text);
    CHECK(text.find("= 23076.9") != std::string::npos);
    CHECK(text.find(k) != std::string::npos);
  }
  hard.check(pose, tool, hard.damping_for(pose, tool));
  CHECK_THROWS_AS(ContactStability<ur5::Model>(ur5::Model{}, c, {.stiffness = 0}), ConfigurationError);
  CHECK_THROWS_AS(ContactStability<ur5::Model>(ur5::Model{}, c, {.stiffness = 1, .margin = 0.5}),
                  ConfigurationError);
}

TEST_CASE("ContactStability: a resolver on a spring becomes unstable where it says") {
  // Whole periods without lag, where commands just miss a cycle, are the hardest: dt/2 in the place of the wait
  // says 1.4 times too much.
  const RobotConfiguration<6> loops[] = {
      configuration(8ms, 0.008, 0.008, 3), configuration(2ms, 0.02, 0, 3),
      configuration(8ms, 0.04, 0, 3),      configuration(8ms, 0.008, 0, 3),
      configuration(8ms, 0.016, 0, 3),     configuration(8ms, 0.012, 0, 3),
      configuration(2ms, 0.002, 0, 3),     configuration(8ms, 0.008, 0.002, 3)};
  for (const auto& c : loops) {
    CAPTURE(c.period);
    CAPTURE(c.delay);
    CAPTURE(c.lag);
    const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = 1e4});
    const double k = s.stiffest(pose, tool);
    CAPTURE(k);
    CHECK(swings_out(c, pose, tool, 0.975 * k));
    CHECK_FALSE(swings_out(c, pose, tool, 1.025 * k));
    const double b = s.damping_for(pose, tool), k_damped = s.stiffest(pose, tool, b);
    CHECK(swings_out(c, pose, tool, 0.95 * k_damped, b));
    CHECK_FALSE(swings_out(c, pose, tool, 1.1 * k_damped, b));
    // Who comes in time bears more.
    CHECK(swings_out(c, pose, tool, 0.975 * k, 0, -1e-9));
  }
}
