// Springs on robots by torque: heavy arms, and hands and chains whose links are light, coupled, and held by
// friction that nobody has declared. Limits of position and speed hold, and the springs reach their goals.
//
// Promise: joints by torque keep their limits however light and coupled their links are, and reach their
// goals
// Tried: springs of 0.6 N m/rad on all joints of an Allegro hand alone (both sides, goals to 0.5 rad
// beyond its ends), UR5, UR10: speed 1.03 of the limit (arms 1.09), 4 mrad beyond an end (arms 1), no
// torque or change of torque above its limit; with a rotor of 1e-5 kg m^2, 0.005 N m s/rad and 0.02 N m
// of friction that nobody declared 1.25 and 35 mrad

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double dt = 2e-3;

/// Springs on all joints.
template <std::size_t N>
struct Springs : StatelessLaw<Springs<N>> {
  JointPosition<N> goal;
  JointTorque<N> stiffness;  // [N m/rad]

  JointTorque<N> torque(const auto& known) const noexcept {
    JointTorque<N> tau;
    for (std::size_t i = 0; i < N; ++i) tau[i] = stiffness[i] * (goal[i] - known.q()[i]);
    return tau;
  }
};

/// What joints have beside the model, in parts of their torque limit: [s/rad], [1], [s^2/rad].
struct Drives {
  double viscous, dry, rotor;
};

/// A robot for 2 ms under a held torque: symplectic Euler, friction implicit.
template <class M, std::size_t N = M::joints>
void move(const M& model, State<N>& s, const JointTorque<N>& tau, const JointTorque<N>& most,
          const Drives& d) {
  constexpr int steps = 16;
  constexpr double h = dt / steps, slow = 0.05;  // [rad/s] below it dry friction falls to zero
  for (int k = 0; k < steps; ++k) {
    const JointAngles<M, double> angles(model, s.q);
    const auto mass = mass_matrix(model, angles);
    const auto bias = bias_torque(model, angles, s.dq);
    double block[N * N], net[N], next[N];
    for (std::size_t i = 0; i < N; ++i) {
      const double b = most[i] * (d.viscous + d.dry / std::max(std::abs(s.dq[i]), slow));
      net[i] = h * (tau[i] - bias[i]);
      for (std::size_t j = 0; j < N; ++j) {
        const double m = mass(i, j) + (i == j ? most[i] * d.rotor : 0);
        net[i] += m * s.dq[j];
        block[N * i + j] = m + (i == j ? h * b : 0);
      }
    }
    math::Ldlt<N, double>(block).solve(net, next);
    for (std::size_t i = 0; i < N; ++i) s.dq[i] = next[i];
    s.q = integrate(s.q, s.dq, h);
  }
}

struct Worst {
  double speed = 0;   ///< in parts of the limit
  double beyond = 0;  ///< behind an end [rad]
  double missed = 0;  ///< at the end of the run, of goals as far as they lie inside [rad]
  double torque = 0;  ///< in parts of the limit
  double rate = 0;    ///< change in a cycle, in parts of the guard's

  void operator|=(const Worst& w) {
    speed = std::max(speed, w.speed), beyond = std::max(beyond, w.beyond);
    missed = std::max(missed, w.missed), torque = std::max(torque, w.torque), rate = std::max(rate, w.rate);
  }
};

template <class M, std::size_t N = M::joints>
Worst run(const M& model, const JointLimits<N>& limit, const JointTorque<N>& viscous,
          const JointTorque<N>& stiffness, const Drives& drives, std::uint64_t seed, double duration,
          double& free) {
  Random random = seeded(seed);
  State<N> x;
  JointPosition<N> goal;
  for (std::size_t i = 0; i < N; ++i) {
    const double lower = limit.lower()[i], upper = limit.upper()[i];
    x.q[i] = uniform(random, lower + 0.05, upper - 0.05);
    goal[i] = seed % 10 == 0 ? 0.9 : uniform(random, lower - 0.5, upper + 0.5);
  }
  const auto robot = by_torque(model, {.limits = limit, .period = 2ms, .viscous_friction = viscous},
                               FrictionUncompensated{});
  const Cycle scene(robot, Springs<N>{{}, goal, stiffness} + GravityControl{});
  using Scene = std::remove_cv_t<decltype(scene)>;
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, x);
  Worst w;
  JointTorque<N> last = gravity_torque(model, x.q);
  for (int k = 1; k * dt < duration; ++k) {
    typename Scene::Input input;
    input.now = x.time = k * 2ms;
    input.measured = x;
    const auto out = scene.step(*memory, input);
    move(model, x, out.command.torque, limit.torque(), drives);
    for (std::size_t i = 0; i < N; ++i) {
      w.speed = std::max(w.speed, std::abs(x.dq[i]) / limit.velocity()[i]);
      w.beyond = std::max({w.beyond, x.q[i] - limit.upper()[i], limit.lower()[i] - x.q[i]});
      w.torque = std::max(w.torque, std::abs(out.command.torque[i]) / limit.torque()[i]);
      w.rate = std::max(w.rate, std::abs(out.command.torque[i] - last[i]) / (50 * dt * limit.torque()[i]));
      free = std::max(free, stiffness[i] * std::abs(goal[i] - x.q[i]) / limit.torque()[i]);
    }
    last = out.command.torque;
  }
  for (std::size_t i = 0; i < N; ++i)
    w.missed = std::max(w.missed, std::abs(x.q[i] - std::clamp(goal[i], limit.lower()[i], limit.upper()[i])));
  return w;
}

// The maker's ends of the joints [rad].
constexpr double finger[4][2] = {{-0.47, 0.47}, {-0.196, 1.61}, {-0.174, 1.709}, {-0.227, 1.618}},
                 thumb[4][2] = {{0.263, 1.396}, {-0.105, 1.163}, {-0.189, 1.644}, {-0.162, 1.719}};
JointLimits<16> hand_limits() {
  JointPosition<16> lower, upper;
  for (std::size_t i = 0; i < 16; ++i) {
    lower[i] = (i < 12 ? finger : thumb)[i % 4][0];
    upper[i] = (i < 12 ? finger : thumb)[i % 4][1];
  }
  return JointLimits<16>({.lower = lower,
                          .upper = upper,
                          .velocity = JointVelocity<16>::constant(7),
                          .acceleration = JointAcceleration<16>::constant(500),
                          .torque = JointTorque<16>::constant(0.7)});
}

constexpr int runs = sanitized ? 1 : 8;
constexpr Drives exact{0, 0, 0};

}  // namespace

TEST_CASE("A hand alone by torque: springs take it to their goals, within all limits of its joints") {
  const auto limit = hand_limits();
  const auto viscous = JointTorque<16>::constant(0.02), stiffness = JointTorque<16>::constant(0.6);
  for (const auto side : {allegro::Side::right, allegro::Side::left}) {
    const auto hand = allegro::hand(side);
    CAPTURE(static_cast<int>(side));
    Worst declared, undeclared;
    double free = 0;
    for (int k = 0; k < runs; ++k) {
      const std::uint64_t seed = 10 * (side == allegro::Side::left ? 2 : 1) + static_cast<std::uint64_t>(k);
      declared |= run(hand, limit, viscous, stiffness, exact, seed, 1.5, free);
      // 0.005 N m s/rad with a rotor as heavy as the last link; then 0.02 N m of dry friction.
      undeclared |= run(hand, limit, viscous, stiffness, {0.005 / 0.7, 0, 1e-5 / 0.7}, seed, 1.5, free);
      undeclared |= run(hand, limit, viscous, stiffness, {0.005 / 0.7, 0.02 / 0.7, 0}, seed, 1.5, free);
    }
    CHECK(declared.speed <= 1.03);
    CHECK(declared.beyond <= 0.004);
    CHECK(declared.missed <= 0.004);
    CHECK(undeclared.speed <= 1.25);
    CHECK(undeclared.beyond <= 0.035);
    CHECK(undeclared.missed <= 0.035);  // what 0.02 N m hold against 0.6 N m/rad
    CHECK(std::max(declared.torque, undeclared.torque) <= 1);
    CHECK(std::max(declared.rate, undeclared.rate) <= 1 + 1e-9);
    CHECK(free >
          (sanitized ? 0.9 : 1.0));  // one run there; the springs ask for more than the joints may give
  }
}

TEST_CASE_TEMPLATE("Arms by torque: the same of heavy links", Which, ur5::Description, ur10::Description) {
  using Arm = StaticModel<Which>;
  auto v = limits_of<Which>(15.0).values();
  v.lower = JointPosition<6>{-2, -2.5, -2, -2.5, -2.2, -2};
  v.upper = JointPosition<6>{2, -0.3, 2, 1, 1, 2};
  const JointLimits<6> limit(v);
  const auto viscous = 0.1 * limit.torque(), stiffness = 0.6 * limit.torque();
  Worst declared, undeclared;
  double free = 0;
  for (int k = 0; k < runs; ++k) {
    const auto seed = static_cast<std::uint64_t>(11 + k);
    declared |= run(Arm{}, limit, viscous, stiffness, exact, seed, 4.0, free);
    undeclared |= run(Arm{}, limit, viscous, stiffness, {0.02, 0.03, 1e-3}, seed, 4.0, free);
  }
  CHECK(declared.speed <= 1.09);
  CHECK(declared.beyond <= 1e-3);
  CHECK(declared.missed <= 0.02);
  CHECK(undeclared.speed <= 1.13);
  CHECK(undeclared.beyond <= 2e-3);
  CHECK(undeclared.missed <= 0.05);  // 3 % of the torque hold against 60 % a radian
  CHECK(std::max(declared.torque, undeclared.torque) <= 1);
  CHECK(std::max(declared.rate, undeclared.rate) <= 1 + 1e-9);
  CHECK(free > 1);
}
