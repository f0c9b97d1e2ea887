// Energy of a robot whose arm takes positions and whose wrist takes torques.
//
// Promise: what watches over energy, contact, speed and jerk goes with groups of joints
// Tried: a UR5 whose arm takes positions and whose wrist takes torques, 40 random scenes, with friction
// in the wrist and without: active torques do no more than one tank of 3 J held: at most 2.90 and 2.997 J
// (35 and 36 scenes do more without), contacts get no more from the arm's joints than the account held;
// limits of tool speed (1.01), jerk (1.001), a finger's speed (1.02) and end (1 mrad); a contact above
// its limit stops all; a change of gains moves no command. Also: `cycle/group_cycle_test.cpp`,
// `cycle/group_parts_test.cpp`, `guard/guard_test.cpp`

#include <doctest/doctest.h>

#include "skinctl/limits/governor.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "tests/support/contact_scene.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/grouped_plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
// Fewer where the sanitizers slow it down.
constexpr std::uint64_t scenes = SKINCTL_MANY_DIGITS ? 40 : 4;
constexpr LinkMask wrist = 0b111000;
using Arm = JointSubset<6, wrist>::Others;
using Wrist = JointSubset<6, wrist>;

struct Given {
  double by_arm = 0;  ///< the most that contacts have got from the arm's joints [J]
  double drawn = 0;   ///< the most that the active torques of all joints have done [J]
  double path = 0;
  bool finite = true;
  Status status;
};

template <class... Parts>
Given run_groups(const RandomScene& scene, bool friction, const Parts&... parts) {
  constexpr Nanoseconds period = 1ms;
  auto law = scene.law;
  for (TimedSkill& s : law.skills) s.damping *= 0.1;  // for a wrist that is commanded every millisecond
  const auto limits = scene.configuration.limits;
  const auto part = [&](auto set) { return limits.part<decltype(set)>(); };
  RobotConfiguration<3> arm{.limits = part(Arm{}), .period = period, .delay = scene.delay * period};
  arm.substep = period;
  arm.lag = 4ms;
  arm.virtual_damping = scene.configuration.virtual_damping;
  RobotConfiguration<3> hand{.limits = part(Wrist{}), .period = period};
  if (friction) hand.viscous_friction = Wrist::of(scene.configuration.viscous_friction);
  const auto robot = resolver_of(
      by_groups(ur5::Model{}, position_joints<Arm::set>(arm), torque_joints<Wrist::set>(hand), parts...));
  GroupedPlant<ur5::Model, wrist, 0> plant(ur5::Model{}, JointPosition<6>(scene.pose), 0.004,
                                           seconds<double>(arm.delay));
  State<6> state{0ns, plant.q(), {}};
  auto memory = robot.start(state);
  RandomSkills::Memory law_memory;
  Given out;
  double by_arm = 0, drawn = 0;
  for (Nanoseconds now = period; now < 2s; now += period) {
    plant.command(memory.command());
    const double from = seconds<double>(now - period);
    int j = 0;
    const auto push_at = [&](const JointPosition<6>& q, const JointVelocity<6>& dq, double t) {
      testing::SceneTouch touch;
      std::array<double, 6> x{}, v{};
      for (std::size_t i = 0; i < 6; ++i) x[i] = q[i], v[i] = dq[i];
      for (const StiffBody& o : scene.obstacles) {
        auto& contact = touch.contacts.list[touch.contacts.count];
        contact.link = 2 + touch.contacts.count++;
        contact.force = o.force(x, scene.pose, v, t);
        std::copy(std::begin(o.row), std::end(o.row), contact.row);
        o.keep_off(x, scene.pose, t, touch.seen);
      }
      return touch;
    };
    JointPosition<6> last = plant.q();
    const JointTorque<6> active = memory.command().torque - gravity_torque(ur5::Model{}, last);
    for (; j < 10; ++j) {
      const double t = from + 1e-4 * j;
      const auto before = push_at(plant.q(), plant.dq(), t);
      plant.run(1e-4, 1, [&](const auto& q, const auto& dq) {
        return skin_torque(0, 0, contact_part(push_at(q, dq, t)));
      });
      const auto after = push_at(plant.q(), plant.dq(), t + 1e-4);
      const JointTorque<6> mean =
          0.5 * (skin_torque(0, 0, contact_part(before)) + skin_torque(0, 0, contact_part(after)));
      for (const std::size_t i : Arm::index) by_arm -= mean[i] * (plant.q()[i] - last[i]);
      for (const std::size_t i : Wrist::index) drawn += active[i] * (plant.q()[i] - last[i]);
      last = plant.q();
      out.by_arm = std::max(out.by_arm, by_arm);
    }
    state = {now, plant.q(), plant.dq()};
    const testing::SceneTouch touch = push_at(plant.q(), plant.dq(), seconds<double>(now));
    const auto virtual_before = robot.state(memory);
    const auto result = robot.step(memory, law, law_memory, state, robot.interval(memory, now),
                                   std::span<const testing::SceneTouch>(&touch, 1));
    const auto moved = robot.state(memory).q - virtual_before.q;
    // What laws are read at: the virtual arm, and the wrist as measured now.
    auto seen = virtual_before.q;
    Wrist::put(Wrist::of(state.q), seen);
    const JointTorque<6> asked = result.command.torque - gravity_torque(ur5::Model{}, seen);
    for (const std::size_t i : Arm::index) {
      drawn += asked[i] * moved[i];
      out.path += i == 0 ? std::abs(moved[i]) : 0;
    }
    out.drawn = std::max(out.drawn, drawn);
    out.finite =
        out.finite && power(result.command.torque, state.dq) - power(result.command.torque, state.dq) == 0;
    out.status |= result.status;
  }
  return out;
}

EnergyTank<> tank(double energy) {
  return EnergyTank<>({.start = energy, .max = energy, .port_gain = 0});
}
}  // namespace

// Without friction nothing takes up what a prediction leaves out: recoil of an arm that moves in jerks,
// limits that cut a motion.
TEST_CASE(
    "Resolver in groups: one tank pays for an arm by position and a wrist by torque, with friction or "
    "without") {
  constexpr double energy = 3;
  for (const bool friction : {true, false}) {
    CAPTURE(friction);
    int broken = 0, empty = 0;
    double most = 0;
    for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
      CAPTURE(seed);
      const RandomScene scene(seed);
      const auto kept = run_groups(scene, friction, tank(energy));
      CHECK(kept.finite);
      CHECK(kept.drawn <= energy * (1 + 1e-12));  // rounding of sums
      most = std::max(most, kept.drawn);
      empty += kept.status.has(Reason::tank_empty);
      const auto bare = run_groups(scene, friction, tank(1e5));
      broken += bare.drawn > energy;
      CHECK_FALSE(bare.status.has(Reason::tank_empty));
    }
    MESSAGE("friction " << friction << ": empty in " << empty << " scenes, at most " << most << " J of "
                        << energy << "; without it more in " << broken);
    CHECK(empty > 0);
    if (scenes > 10) CHECK(broken > 0);  // so the test can fail
  }
}

TEST_CASE(
    "Resolver in groups: no contact gets more from the arm's joints than it gave and the account held") {
  int broken = 0, held = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    CAPTURE(seed);
    RandomScene scene(seed);
    // On the upper arm: what lies behind the wrist is pressed by its torques too.
    for (StiffBody& o : scene.obstacles)
      for (const std::size_t i : Wrist::index) o.row[i] = 0;
    const auto account = [&](double energy) {
      return PassivityObserver<>({.start = energy,
                                  .max = energy,
                                  .stiffness = scene.stiffest,
                                  .reach = {0.6, 0.6, 0.4, 0.1, 0.1, 0}});
    };
    const auto kept = run_groups(scene, true, account(0.2 * scene.energy));
    CHECK(kept.by_arm <= 0.2 * scene.energy);
    held += kept.status.has(Reason::energy_held);
    const auto bare = run_groups(scene, true, account(1e5));
    broken += bare.by_arm > 0.2 * scene.energy;
    CHECK(kept.path > 1e-3);
  }
  MESSAGE("held in " << held << " scenes; without it more in " << broken);
  CHECK(held > 0);
  if (scenes > 10) CHECK(broken > 0);
}
