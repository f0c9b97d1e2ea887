// Scenes of robots whose joints have several interfaces: limits of the whole robot, and configurations.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "skinctl/cycle/configurations.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/arm_with_finger.hpp"
#include "skinctl/testing/grouped_plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Model3 = ArmWithFingerModel;

// A torque of its own, and a spring to a goal.
template <LawRole Role>
struct Drive {
  struct Memory {};
  static constexpr Needs needs{.gravity = true, .touch = true};
  static constexpr LawRole role = Role;
  static constexpr int gravity_laws = 1;
  JointTorque<3> tau, stiffness;
  JointPosition<3> goal;
  double after = 0;  ///< when it begins [s]
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<3> torque(const Memory&, const K& known) const noexcept {
    JointTorque<3> out = known.gravity();
    if (seconds<double>(known.time()) < after) return out;
    for (std::size_t i = 0; i < 3; ++i) out[i] += tau[i] + stiffness[i] * (goal[i] - known.q()[i]);
    return out;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};
using Pull = Drive<LawRole::reactive>;

template <std::size_t N>
JointLimits<N> limits(double torque) {
  return JointLimits<N>({.lower = JointPosition<N>::constant(-2),
                         .upper = JointPosition<N>::constant(2),
                         .velocity = JointVelocity<N>::constant(3),
                         .acceleration = JointAcceleration<N>::constant(40),
                         .torque = JointTorque<N>::constant(torque)});
}
RobotConfiguration<1> one(bool driven) {
  RobotConfiguration<1> c{.limits = limits<1>(driven ? 0.7 : 150), .period = 2ms};
  if (!driven) c.delay = 4ms, c.lag = 4ms, c.viscous_friction[0] = 5;
  return c;
}
// Joint 0 by velocity, 1 by position, the finger by torque.
template <class... Parts>
auto robot(const Parts&... parts) {
  auto column = one(false);
  column.lag = 0ms;
  return by_groups(Model3{}, velocity_joints<0b001>(column), position_joints<0b010>(one(false)),
                   torque_joints<0b100>(one(true)), parts...);
}

constexpr double tip[3] = {0.1, 0, 0};
Xyz<double> tip_at(const JointPosition<3>& q) {
  const auto X = Poses<Model3, all_links(3), double>(Model3{}, q).get<2>();
  const auto p = X.axes() * Xyz<double>{tip[0], tip[1], tip[2]};
  return {p.x + X.origin().x, p.y + X.origin().y, p.z + X.origin().z};
}

template <class Scene>
struct Run {
  Scene scene;
  GroupedPlant<Model3, 0b100, 0b001> plant{Model3{}, {0.2, 0.3, 0.5}, 0.004, 0.004};
  State<3> measured{0ns, {0.2, 0.3, 0.5}, {}};
  typename Scene::Memory memory = scene.start(measured);
  typename Scene::Output out{};
  JointTorque<3> push{};  ///< of the world, on the finger
  bool stuck = false;     ///< a hand holds the finger
  JointPosition<3> held{};
  Status seen{};
  double tip_speed = 0;
  JointVelocity<3> fastest{};
  std::uint64_t allocated = 0;

  auto& cycle(typename Scene::Input input = {}) {
    const auto before = tip_at(plant.q());
    plant.run(2e-3, 10, [&](const auto& q, const auto& dq) {
      auto tau = push;
      if (stuck) tau[2] += 2000 * (held[2] - q[2]) - 2 * dq[2];
      return tau;
    });
    const auto way = tip_at(plant.q()) - before;
    tip_speed = std::max(tip_speed, std::sqrt(dot(way, way)) / 2e-3);
    measured = {measured.time + 2ms, plant.q(), plant.dq()};
    for (std::size_t i = 0; i < 3; ++i) fastest[i] = std::max(fastest[i], std::abs(measured.dq[i]));
    input.now = measured.time;
    input.measured = measured;
    const AllocationGuard guard;
    out = scene.step(memory, input);
    allocated += guard.count();
    plant.command(out.command);
    seen |= out.status;
    return out;
  }
};
template <class Scene>
Run(const Scene&) -> Run<Scene>;

}  // namespace

TEST_CASE("Groups: a finger by torque keeps its own limits, and has its whole torque for what it holds") {
  const Pull pull{{0, 0, 0.6}, {}, {}};
  // Free: it runs to its end, and stays below its speed.
  Run run{Cycle(robot(), pull)};
  for (int k = 0; k < 1000; ++k) run.cycle();
  CHECK(run.fastest[2] < 1.02 * 3);
  CHECK(run.plant.q()[2] < 2 + 1e-3);
  CHECK(run.plant.q()[2] > 1.9);
  CHECK(run.seen.has(Reason::velocity_limited));
  CHECK(run.seen.has(Reason::position_limited));
  CHECK(run.allocated == 0);
  // Without a governor it is too fast: so the test can fail.
  Run bare{Cycle(robot(), pull, NoGovernor{})};
  for (int k = 0; k < 100; ++k) bare.cycle();
  CHECK(bare.fastest[2] > 2 * 3);
  // Held fast by a hand.
  Run grasp{Cycle(robot(), pull)};
  grasp.stuck = true;
  grasp.held = grasp.plant.q();
  for (int k = 0; k < 200; ++k) grasp.cycle();
  const double gravity = gravity_torque(Model3{}, grasp.plant.q())[2];
  CHECK(grasp.out.command.torque[2] - gravity > 0.599);
}

TEST_CASE("Groups: the tool's speed and the joints' jerk are limited, whoever moves the tool") {
  const double most = 0.25;
  const JointJerk<3> jerk = JointJerk<3>::constant(400);
  for (const Pull& pull : {Pull{{6, 0, 0}, {}, {}}, Pull{{0, 5, 0}, {}, {}}, Pull{{5, -4, 0.3}, {}, {}}}) {
    CAPTURE(pull.tau[0]);
    Run run{Cycle(robot(), pull).with(MaxToolSpeed<2>{most, {tip[0], tip[1], tip[2]}, 0.7}, MaxJerk{jerk})};
    JointVelocity<3> last;
    JointAcceleration<3> before;
    double roughest = 0;
    for (int k = 0; k < 600; ++k) {
      const auto& out = run.cycle();
      for (std::size_t i = 0; i < 2; ++i) {
        const double a = (out.command.velocity[i] - last[i]) / 2e-3;
        // Over two cycles: a jerk limit bounds the change of mean accelerations.
        if (k > 1 && !out.status.has(Reason::jerk_exceeded))
          roughest = std::max(roughest, std::abs(a - before[i]) / 2e-3);
        before[i] = a;
        last[i] = out.command.velocity[i];
      }
    }
    CHECK(run.tip_speed < 1.01 * most);
    CHECK(run.tip_speed > 0.9 * most);
    CHECK(roughest < 1.001 * 400);
    CHECK(run.seen.has(Reason::tool_speed_limited));
    CHECK(run.allocated == 0);
    Run bare{Cycle(robot(), pull)};
    for (int k = 0; k < 600; ++k) bare.cycle();
    CHECK(bare.tip_speed > 1.5 * most);
  }
}

TEST_CASE("Groups: a contact on the finger above its limit stops arm and finger, until consent") {
  const std::vector<PlacedCell<2>> cells{{1, {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0.05, 0, 0}}}};
  const Skin<Model3, double, Patch<2, 1>> skin{Patch<2, 1>(cells, {.force = 100})};
  BodyRegion region{};
  region.force = 20, region.blow = 40, region.power = 1e3, region.mass = 1, region.stiffness = 1e4,
  region.first = 500ms;
  Run run{Cycle(robot(), skin, Pull{{5, 3, 0}, {}, {}})
              .with(LinkContact<2>{.region = region, .reach = 0.1, .reaction = 20ms})};
  const auto touch = [&](float force, CycleRequest request = CycleRequest::none) {
    const CellSample sample{.time = run.measured.time + 1ms, .cell = 1, .force = {force, force, force}};
    decltype(run.scene)::Input input;
    input.samples = std::span(&sample, 1);
    input.request = request;
    run.cycle(input);
  };
  for (int k = 0; k < 200; ++k) touch(0);
  CHECK(std::abs(run.plant.dq()[0]) > 0.3);
  for (int k = 0; k < 100; ++k) touch(0.2f);  // 60 N
  CHECK(run.seen.has(Reason::contact_force));
  for (int k = 0; k < 300; ++k) touch(0);
  CHECK(run.out.status.has(Reason::consent_awaited));
  for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(run.plant.dq()[i]) < 1e-3);
  for (int k = 0; k < 200; ++k) touch(0, CycleRequest::resume);
  CHECK(std::abs(run.plant.dq()[0]) > 0.3);
}

TEST_CASE("Groups: with all parts at once, whatever comes in, commands stay finite and within their steps") {
  const std::vector<PlacedCell<2>> cells{{1, {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0.05, 0, 0}}}};
  const Skin<Model3, double, Patch<2, 1>> skin{Patch<2, 1>(cells, {.force = 100})};
  const auto scene =
      Cycle(robot(EnergyTank{}, PassivityObserver{}, ContactDamper<>({.max = 50})), skin,
            Pull{{5, 3, 0.1}, {}, {}})
          .with(MaxToolSpeed<2>{0.5, {tip[0], tip[1], tip[2]}, 0.7}, MaxJerk{JointJerk<3>::constant(2000)});
  static_assert(std::is_trivially_copyable_v<decltype(scene)::Memory>);
  std::mt19937_64 rng(5);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  const double wrong[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          -1e300, 1e-310, 7};
  Run run{scene};
  JointCommand<3> last = run.memory.robot.command;
  std::uint64_t allocated = 0;
  bool good = true;
  for (int k = 0; k < 20000; ++k) {
    run.plant.run(2e-3, 4, [](const auto&, const auto&) { return JointTorque<3>{}; });
    decltype(run.scene)::Input input;
    input.measured = {run.measured.time += 2ms, run.plant.q(), run.plant.dq()};
    input.now = run.measured.time;
    const bool bad = k % 1000 < 200;
    if (bad && rng() % 4 == 0) input.measured.q[rng() % 3] = wrong[rng() % 5];
    if (bad && rng() % 4 == 0) input.measured.dq[rng() % 3] = wrong[rng() % 5];
    if (bad && rng() % 16 == 0) input.now += Nanoseconds(std::int64_t(roll(-1e8, 1e8)));
    if (k % 1000 == 300) input.request = CycleRequest::resume;
    const float f = bad && rng() % 8 == 0 ? float(wrong[rng() % 5]) : float(roll(0, 0.1));
    const CellSample sample{.time = input.now - 1ms, .cell = 1, .force = {f, f, f}};
    input.samples = std::span(&sample, 1);
    const AllocationGuard guard;
    const auto out = run.scene.step(run.memory, input);
    allocated += guard.count();
    for (std::size_t i = 0; i < 3; ++i) {
      good = good && std::isfinite(out.command.position[i]) && std::isfinite(out.command.velocity[i]) &&
             std::isfinite(out.command.torque[i]);
      // The longest interval is five periods.
      if (i < 2)
        good = good && std::abs(out.command.velocity[i] - last.velocity[i]) <= 40 * 0.01 * (1 + 1e-9) &&
               std::abs(out.command.velocity[i]) <= 3 * (1 + 1e-9);
      if (i == 2)
        good = good && std::abs(out.command.torque[i] - last.torque[i]) <= 50 * 0.7 * 0.01 * (1 + 1e-9) &&
               std::abs(out.command.torque[i]) <= 0.7;
    }
    if (!good) {
      CAPTURE(k);
      CHECK(good);
      break;
    }
    if (k % 1000 == 999) CHECK_FALSE(out.status.has(Reason::consent_awaited));  // it goes on again
    last = out.command;
    run.plant.command(out.command);
  }
  CHECK(allocated == 0);
  // A robot by torque has the damper too.
  const auto whole = by_torque(Model3{}, RobotConfiguration<3>{.limits = limits<3>(50), .period = 2ms},
                               RobotCompensatesFriction{}, EnergyTank{}, ContactDamper<>({.max = 50}));
  Run torques{Cycle(whole, skin, Pull{{1, 1, 0}, {}, {}})};
  torques.cycle();
  CHECK(torques.out.command.valid);
}

TEST_CASE("Groups: the rate of what laws ask for by themselves is bounded for all joints") {
  using Track = Drive<LawRole::tracking>;
  Track law{{100, 100, 0.6}, {}, {}};
  law.after = 0.1;
  auto slow = [] {
    auto column = one(false), arm = one(false), finger = one(true);
    column.lag = 0ms;
    column.torque_rate = arm.torque_rate = finger.torque_rate = 5;
    return by_groups(Model3{}, velocity_joints<0b001>(column), position_joints<0b010>(arm),
                     torque_joints<0b100>(finger));
  };
  Run run{Cycle(slow(), law).with(GuardSettings<3>{.torque_rate = 1e5})};
  run.stuck = true;
  run.held = run.plant.q();
  JointTorque<3> last = run.memory.robot.command.torque;
  JointTorque<3> most;
  for (int k = 0; k < 120; ++k) {
    const auto& out = run.cycle();
    for (std::size_t i = 0; i < 3; ++i) {
      const double step = std::abs(out.command.torque[i] - last[i]);
      if (k > 1) most[i] = std::max(most[i], step);
      last[i] = out.command.torque[i];
    }
  }
  const JointTorque<3> bound{5 * 150 * 2e-3, 5 * 150 * 2e-3, 5 * 0.7 * 2e-3};
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(most[i] > 0.9 * bound[i]);
    CHECK(most[i] < 1.1 * bound[i]);
  }
  CHECK(run.seen.has(Reason::torque_limited));
}

TEST_CASE("Configurations: of a robot in groups, gains change without a jump of any joint") {
  const auto scene = [](double gain) {
    return Cycle(robot(), Drive<LawRole::tracking>{{}, {8 * gain, 8 * gain, 0.4 * gain}, {0.6, 0.1, 0.9}});
  };
  const Configurations both(scene(1), scene(2.5));
  using Scene = std::remove_cv_t<decltype(both)>;
  Run<Scene> run{both}, other{both};
  for (int k = 0; k < 40; ++k) run.cycle(), other.cycle();
  Scene::Input input;
  input.configuration = 1;
  for (int k = 0; k < 200; ++k) {
    const auto a = run.cycle(input), b = other.cycle();
    if (k == 0) {
      // The cycle of the change gives the command that it would have given without it.
      CHECK(std::abs(a.command.velocity[0] - b.command.velocity[0]) < 1e-9);
      CHECK(std::abs(a.command.position[1] - b.command.position[1]) < 1e-9);
      CHECK(std::abs(a.command.torque[2] - b.command.torque[2]) < 1e-3 * 0.7);
      CHECK(a.status.has(Reason::bumpless_transfer));
    }
    if (k == 199) CHECK(std::abs(a.command.velocity[0] - b.command.velocity[0]) > 1e-2);
  }
  CHECK_FALSE(run.out.status.has(Reason::bumpless_transfer));
  // While the robot is stopped its gravity must not step: refused.
  Scene::Input stop;
  stop.request = CycleRequest::stop;
  stop.configuration = 1;
  run.cycle(stop);
  input.configuration = 0;
  CHECK(run.cycle(input).status.has(Reason::configuration_refused));
}
