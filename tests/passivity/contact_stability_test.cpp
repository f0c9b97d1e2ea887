#include "skinctl/passivity/contact_stability.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include "bench/studies/worlds/wall_contact.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

RobotConfiguration<6> configuration(Nanoseconds period, double delay, double lag, double decay,
                                    double lead = 0) {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(1000.0), .period = period, .delay = nanoseconds(delay)};
  c.lag = nanoseconds(lag);
  c.virtual_damping = decay;
  c.force_lead = nanoseconds(lead * seconds<double>(c.total_delay()));
  c.viscous_friction = {20, 20, 10, 2, 1, 0.5};
  return c;
}
constexpr double tool[6] = {0.3, 0.5, 0.4, 0.15, 0.1, 0};
const JointPosition<6> pose{0.1, -1.5, 1.2, -1, -1.5, 0.3};

}  // namespace

TEST_CASE("ContactStability: pure friction and pure delay have the textbook's margin") {
  // With friction that outweighs every mass the loop is w_f k / (B s) exp(-s T), k_max = pi B / (2 T w_f),
  // and sampled tan(x)/x times as much, x = pi dt / (4 T).
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
    "ContactStability: a mass behind a delay that its force lead makes up for bears a wall of 0.5 m / T^2") {
  // One joint that outweighs the others, on a lever of 1 m, a lead of T and friction of 0.1 m/T: STABILITY's
  // bound.
  auto c = configuration(1ms, 0.025, 0, 0, 1);
  constexpr double m = 1e6, T = 0.0265;
  c.virtual_inertia = JointTorque<6>::constant(m);
  c.viscous_friction = JointTorque<6>::constant(0.1 * m / T);
  const double row[6] = {1, 0, 0, 0, 0, 0};
  const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = 1e4});
  CHECK(s.stiffest(pose, row) > 0.5 * m / (T * T));
  c.force_lead = 0ns;
  const ContactStability<ur5::Model> late(ur5::Model{}, c, {.stiffness = 1e4});
  CHECK(late.stiffest(pose, row) < 0.2 * m / (T * T));
}

TEST_CASE("ContactStability: a heavy body is a wall, a light one is borne by a stiffer robot only") {
  const auto c = configuration(8ms, 0.008, 0.008, 4, 1);
  const auto stiffest = [&](double body) {
    return ContactStability<ur5::Model>(ur5::Model{}, c, {.stiffness = 1e4, .body = body})
        .stiffest(pose, tool);
  };
  CHECK(stiffest(1e6) == doctest::Approx(stiffest(0)).epsilon(1e-3));
  for (const double body : {1.0, 3.0, 10.0, 30.0}) CHECK(stiffest(body) < stiffest(3 * body));
}

TEST_CASE("ContactStability: numbers out of their range are refused") {
  const auto c = configuration(8ms, 0.02, 0.008, 4);
  CHECK_THROWS_AS(ContactStability<ur5::Model>(ur5::Model{}, c, {.stiffness = 0}), ConfigurationError);
  CHECK_THROWS_AS(ContactStability<ur5::Model>(ur5::Model{}, c, {.stiffness = 1, .body = -1}),
                  ConfigurationError);
}

TEST_CASE("ContactStability: a resolver on a spring becomes unstable where it says") {
  // Whole periods without lag, where commands just miss a cycle, are the hardest: dt/2 in the place of the
  // wait says 1.4 times too much.
  const RobotConfiguration<6> loops[] = {
      configuration(8ms, 0.008, 0.008, 3),    configuration(2ms, 0.02, 0, 3),
      configuration(8ms, 0.04, 0, 3),         configuration(8ms, 0.008, 0, 3),
      configuration(8ms, 0.016, 0, 3),        configuration(8ms, 0.012, 0, 3),
      configuration(2ms, 0.002, 0, 3),        configuration(8ms, 0.008, 0.002, 3),
      configuration(8ms, 0.008, 0.008, 3, 1), configuration(2ms, 0.02, 0, 3, 1),
      configuration(2ms, 0.02, 0.02, 3, 0.5)};
  for (const auto& c : loops) {
    CAPTURE(c.period);
    CAPTURE(c.delay);
    CAPTURE(c.lag);
    const ContactStability<ur5::Model> s(ur5::Model{}, c, {.stiffness = 1e4});
    const double k = s.stiffest(pose, tool);
    CAPTURE(k);
    CHECK(swings_out(c, pose, tool, 0.975 * k));
    CHECK_FALSE(swings_out(c, pose, tool, 1.025 * k));
    // Who comes in time bears more.
    CHECK(swings_out(c, pose, tool, 0.975 * k, -1e-9));
  }
}
