// Promise: a request's ticket tells what has become of it, and why it failed
// Tried: refused, replaced, in a sequence, in a fallback, other goals for the same skill

#include "skinctl/skills/skill_set.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/core/real_time.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/skilled_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace skinctl::behaviour;

namespace {
constexpr double dt = 0.002;

/// Closes a gripper while the arm holds; then goes to a joint goal.
struct Grasp {
  static constexpr const char* name = "grasp";
};
struct Carry {
  static constexpr const char* name = "carry";
};
/// Fails when touched.
struct Careful {
  static constexpr const char* name = "careful";
};
const auto library = boost::hana::union_(
    figure_7,
    boost::hana::make_map(
        skill<Grasp>(
            recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Joint>())
                .switching(closed())
                .when({.finish = SkillFinish::switched, .hold = 200ms, .timeout = 1s})
                .then<Carry>()),
        skill<Carry>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>(0.5),
                            load<controller::SplineJoint>())
                         .when({.needs = closed(), .finish = SkillFinish::settled})),
        skill<Careful>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>(),
                              load<controller::SplineJoint>())
                           .when({.untouched = true, .finish = SkillFinish::settled, .max_touch = 3}))));
const auto set = skill_set<KinestheticJoint>(
    library, {}, skill_controller<controller::Gravity>(GravityControl{}),
    skill_controller<controller::SkinJoint>(SkinJointControl{}),
    skill_controller<controller::SplineJoint>(SplineJoint<6>(skilled_settings(dt))),
    skill_controller<controller::Joint>(JointControl<6>(skilled_settings(dt))));
using Set = std::remove_const_t<decltype(set)>;
using Run = SkilledRun<Set, double>;
static_assert(Law<Set, Run::KnownTo> && std::is_trivially_copyable_v<Set::Memory>);
static_assert(Set::skills == 6 && Set::controllers == 4);  // those whose controllers are there
static_assert(Set::index<KinestheticJoint>() == 0);

/// Runs for `seconds`; what was reported on the way.
Status run_for(Run& run, double seconds) {
  Status seen;
  for (double t = 0; t < seconds; t += dt) seen |= run.step().status;
  return seen;
}
JointGoal<6> near(const Run& run, double by) {
  JointGoal<6> goal{run.state().q, 600ms};
  for (double& q : goal.q_g) q += by;
  return goal;
}
const char* now(const Run& run) {
  return set.active(run.memory()).name;
}
}  // namespace

TEST_CASE("SkillSet: begins with the first skill, holds gravity, and goes to a goal when asked") {
  Run run(set, dt, 1);
  CHECK(std::string(now(run)) == "kinesthetic_joint");
  run_for(run, 0.5);
  const auto goal = near(run, 0.1);
  CHECK(run.ask(Set::start_skill<ReachJointGoal>(goal)) == Status{});
  CHECK(run.memory().phase == SkillPhase::loading);
  CHECK(run_for(run, 0.19).has(Reason::bumpless_transfer));
  CHECK(run.memory().phase == SkillPhase::loading);
  run_for(run, 0.03);
  CHECK(run.memory().phase == SkillPhase::running);
  CHECK_FALSE(run_for(run, 0.4).has(Reason::skill_finished));
  CHECK(run_for(run, 4).has(Reason::skill_finished));
  CHECK(run.memory().phase == SkillPhase::finished);
  for (std::size_t i = 0; i < 6; ++i) CHECK(run.state().q[i] == doctest::Approx(goal.q_g[i]).epsilon(0.01));
  // Another goal for the same skill, and it runs again.
  const auto other = near(run, -0.1);
  CHECK(run.ask(Set::goal(other)) == Status{});
  CHECK(run.memory().phase == SkillPhase::running);
  CHECK(run_for(run, 4).has(Reason::skill_finished));
  for (std::size_t i = 0; i < 6; ++i) CHECK(run.state().q[i] == doctest::Approx(other.q_g[i]).epsilon(0.01));
}

TEST_CASE(
    "SkillSet: controllers that a skill does not load are not computed, and those that it keeps go on") {
  Run run(set, dt, 2);
  run_for(run, 0.1);
  run.ask(Set::start_skill<ReachJointGoal>(near(run, 0.3)));
  run_for(run, 0.4);
  const auto& blend = Set::Blend::memory<2>;
  const auto clock = blend(run.memory().blend).plan.clock.own;
  CHECK(clock > 0ns);
  run.ask(Set::start_skill<Careful>());  // the same controllers: the spline goes on
  run_for(run, 0.1);
  CHECK(blend(run.memory().blend).plan.clock.own.count() ==
        doctest::Approx(double(clock.count()) + 1e8).epsilon(0.03));
  CHECK_FALSE(Set::Blend::loaded(run.memory().blend, 3));
  run_for(run, 0.1);
  run.ask(Set::start_skill<KinestheticJoint>());
  run_for(run, 0.4);
  CHECK_FALSE(Set::Blend::loaded(run.memory().blend, 2));
  const auto stopped = blend(run.memory().blend).plan.clock.own;
  run_for(run, 0.1);
  CHECK(blend(run.memory().blend).plan.clock.own == stopped);
}

TEST_CASE("SkillSet: a sequence switches a gripper, waits for it, and goes on with the same goals") {
  SUBCASE("without reports after a time") {
    Run run(set, dt, 3);
    CHECK(run.ask(Set::start_skill<Carry>()) == Status{Reason::skill_refused});  // the gripper is not closed
    const auto goal = near(run, 0.05);
    CHECK(run.ask(Set::start_skill<Grasp>(goal)).has(Reason::goal_refused) == false);
    CHECK(Set::commanded(run.memory()) == closed());
    run_for(run, 0.3);
    CHECK(std::string(now(run)) == "grasp");
    run_for(run, 0.4);
    CHECK(std::string(now(run)) == "carry");
    run_for(run, 5);
    CHECK(run.memory().phase == SkillPhase::finished);
    for (std::size_t i = 0; i < 6; ++i) CHECK(run.state().q[i] == doctest::Approx(goal.q_g[i]).epsilon(0.01));
  }
  SUBCASE("with reports when it is so") {
    Run run(set, dt, 4);
    run.ask(Set::report(opened()));
    run.ask(Set::start_skill<Grasp>(near(run, 0.05)));
    run_for(run, 0.6);
    CHECK(std::string(now(run)) == "grasp");
    run.ask(Set::report(closed()));
    run_for(run, 0.25);
    CHECK(std::string(now(run)) == "carry");
  }
  SUBCASE("and fails when it never is") {
    Run run(set, dt, 5);
    run.ask(Set::report(opened()));
    run.ask(Set::start_skill<Grasp>(near(run, 0.05)));
    CHECK(run_for(run, 1.05).has(Reason::skill_failed));
    CHECK(std::string(now(run)) == "kinesthetic_joint");
  }
}

TEST_CASE("SkillSet: starts only where it may, and falls back when it fails") {
  Run run(set, dt, 6);
  run_for(run, 0.1);
  CHECK(run.ask(Set::start_skill<Careful>(near(run, 0.3))) == Status{});
  run_for(run, 0.3);
  run.touch(40);
  Status seen;
  for (int k = 0; k < 200 && !seen.has(Reason::skill_failed); ++k) seen |= run.step().status;
  CHECK(seen.has(Reason::skill_failed));
  run.step();
  CHECK(std::string(now(run)) == "kinesthetic_joint");
  CHECK(run.ask(Set::start_skill<Careful>(near(run, 0.3))) == Status{Reason::skill_refused});
  run.release();
  run_for(run, 0.3);
  CHECK(run.ask(Set::start_skill<Careful>(near(run, 0.3))) == Status{});
}

TEST_CASE("SkillSet: what means nothing is refused, and of requests during a change the last counts") {
  Run run(set, dt, 7);
  run_for(run, 0.1);
  auto bad = Set::start_skill(200);
  CHECK(run.ask(bad) == Status{Reason::goal_refused});
  bad.kind = 99;
  CHECK(run.ask(bad) == Status{Reason::goal_refused});
  CHECK(run.ask(Set::goal(near(run, 0.1))) == Status{Reason::goal_refused});  // nobody takes it
  auto far = near(run, 0.1);
  far.q_g[2] = std::numeric_limits<double>::quiet_NaN();
  CHECK(run.ask(Set::start_skill<ReachJointGoal>(far)).has(Reason::goal_refused));
  CHECK(std::string(now(run)) == "kinesthetic_joint");

  run.ask(Set::start_skill<ReachJointGoal>(near(run, 0.1)));
  run_for(run, 0.05);
  run.ask(Set::start_skill<Careful>());
  run.ask(Set::start_skill<ReachJoint>());
  run_for(run, 0.1);
  CHECK(std::string(now(run)) == "reach_joint_goal");
  run_for(run, 0.1);
  CHECK(std::string(now(run)) == "reach_joint");
}

TEST_CASE("SkillSet: a ticket tells what has become of its request, and why it failed") {
  Run run(set, dt, 9);
  run.ask(Set::report(opened()));
  const auto told = [&](std::uint16_t ticket) { return Set::report_of(run.memory(), ticket); };
  const auto failed = [](std::uint16_t ticket, SkillFailure why) {
    return SkillReport{ticket, SkillPhase::failed, why};
  };
  CHECK(told(0) == SkillReport{});
  run.ask(Set::start_skill<ReachJointGoal>(near(run, 0.02)).with_ticket(11));
  CHECK(told(11) == SkillReport{11, SkillPhase::loading, SkillFailure::none});
  CHECK(told(12) == SkillReport{});
  run_for(run, 0.05);
  run.ask(Set::start_skill<Careful>(near(run, 0.05)).with_ticket(12));  // waits for the end of the change
  CHECK(told(12) == SkillReport{});
  CHECK(told(11).ticket == 11);
  run_for(run, 0.5);
  CHECK(told(12) == SkillReport{12, SkillPhase::running, SkillFailure::none});
  CHECK(told(11) == SkillReport{});
  // Refused requests leave the skill and its report alone.
  run.ask(Set::start_skill<Carry>().with_ticket(13));
  CHECK(told(13) == failed(13, SkillFailure::conditions));
  auto far = near(run, 0.1);
  far.q_g[2] = std::numeric_limits<double>::quiet_NaN();
  run.ask(Set::goal(far).with_ticket(14));
  CHECK(told(14) == failed(14, SkillFailure::goal));
  CHECK(told(12).phase == SkillPhase::running);
  run_for(run, 4);
  CHECK(told(12) == SkillReport{12, SkillPhase::finished, SkillFailure::none});
  // Another goal for the same skill is another request.
  run.ask(Set::goal(near(run, 0.3)).with_ticket(15));
  CHECK(told(15).phase == SkillPhase::running);
  run.touch(60);
  for (int k = 0; k < 200 && told(15).phase != SkillPhase::failed; ++k) run.step();
  CHECK(told(15) == failed(15, SkillFailure::touch));
  run.release();
  run_for(run, 1);
  CHECK(std::string(now(run)) == "kinesthetic_joint");
  CHECK(told(15) == failed(15, SkillFailure::touch));  // the fallback runs, the reason stays
  // A sequence is one request: finished when its last skill is, failed with the reason of any.
  run.ask(Set::start_skill<Grasp>(near(run, 0.05)).with_ticket(16));
  run_for(run, 0.5);
  CHECK(told(16).phase == SkillPhase::running);
  run_for(run, 0.6);
  CHECK(told(16) == failed(16, SkillFailure::timeout));
  run_for(run, 0.3);
  run.ask(Set::start_skill<Grasp>(near(run, 0.05)).with_ticket(17));
  run.ask(Set::report(closed()));
  run_for(run, 0.5);
  CHECK(std::string(now(run)) == "carry");
  CHECK(told(17).phase == SkillPhase::running);
  run_for(run, 5);
  CHECK(told(17).phase == SkillPhase::finished);
}

TEST_CASE("SkillSet: refuses settings that cannot work") {
  auto rows = std::array<Skill<4>, 6>{};
  for (std::uint8_t i = 0; i < 6; ++i) rows[i] = set.skill(i);
  CHECK_NOTHROW(Set(set.sum(), rows));
  const auto refuses = [&](auto change) {
    auto wrong = rows;
    SkillSettings settings;
    change(wrong, settings);
    CHECK_THROWS_AS(Set(set.sum(), wrong, settings), ConfigurationError);
  };
  refuses([](auto&, auto& s) { s.max_rate = 0; });
  refuses([](auto&, auto& s) { s.bumpless_transfer = 0s; });
  refuses([](auto&, auto& s) { s.longest = 1ms; });
  refuses([](auto& r, auto&) { r[1].next = 6; });
  refuses([](auto& r, auto&) { r[1].weights[0] = 0; });
  refuses([](auto& r, auto&) { r[1].weights[1] = -1; });
  refuses([](auto& r, auto&) { r[0].conditions.timeout = 1s; });
  refuses([](auto& r, auto&) { r[2].conditions.still = 0; });
}

TEST_CASE(
    "SkillSet: while a change lasts the torque moves no faster than configured, and what it lacks is a "
    "share") {
  SkillSettings slow;
  slow.max_rate = 20;
  slow.longest = 100ms;  // no time to stretch the change to
  const auto slowly = skill_set<KinestheticJoint>(
      library, slow, skill_controller<controller::Gravity>(GravityControl{}),
      skill_controller<controller::SkinJoint>(SkinJointControl{}),
      skill_controller<controller::SplineJoint>(SplineJoint<6>(skilled_settings(dt))),
      skill_controller<controller::Joint>(JointControl<6>(skilled_settings(dt))));
  SkilledRun<Set, double> run(slowly, dt, 8);
  run.touch(40);
  run_for(run, 0.3);
  run.ask(Set::start_skill<ReachJointGoal>(near(run, 0.3)));
  const auto own = [](const auto& e) { return e.torque - e.shares[1]; };  // both skills weigh the skin with 1
  auto last = own(run.step());
  double lacked = 0;
  for (int k = 0; k < 5000 && run.changing(); ++k) {
    const auto e = run.step();
    auto sum = e.shares[0];
    for (std::size_t i = 1; i < Set::terms; ++i) sum += e.shares[i];
    CHECK(largest(sum - e.torque) < 1e-12);
    if (run.changing()) CHECK(largest(own(e) - last) < slow.max_rate * dt * (1 + 1e-9));
    lacked = std::max(lacked, largest(e.shares[Set::controllers]));
    last = own(e);
  }
  CHECK(lacked > 0.01);
  CHECK_FALSE(run.changing());
}

TEST_CASE("SkillSet: nothing of it allocates") {
  Run run(set, dt, 8);
  const AllocationGuard guard;
  {
    const RealTimeScope loop;
    for (int k = 0; k < 3000; ++k) {
      if (k % 130 == 0) run.ask(run.any_request(static_cast<std::uint8_t>(k / 130 % 6)));
      if (k % 90 == 0) run.touch(20);
      if (k % 90 == 40) run.release();
      run.step();
    }
  }
  const auto count = guard.count();
  CHECK(count == 0);
}
