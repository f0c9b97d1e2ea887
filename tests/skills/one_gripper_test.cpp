// A gripper as a part of a set of skills: goals in requests, states in the cycle's input.
//
// Promise: a skill with a gripper ends when it holds something, and fails when it is empty, broken or
// silent; replayed to the bit
// Tried: UR5 by position, a gripper that answers 24 ms late
//
// Promise: a goal is reached as near as its request asks
// Tried: 2 and 50 mrad, and at rest

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "skinctl/recording/recording.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/support/skilled_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
struct Rest {
  static constexpr const char* name = "rest";
};
struct Grasp {
  static constexpr const char* name = "grasp";
};
struct Open {
  static constexpr const char* name = "open";
};
struct Reach {
  static constexpr const char* name = "reach";
};
const auto arm_law = recipe(load<controller::Gravity>(), load<controller::SplineJoint>());
const auto library = boost::hana::make_map(
    skill<Rest>(arm_law),
    skill<Grasp>(arm_law.gripping({0, 8, 0.05}).when({.finish = SkillFinish::gripped, .timeout = 4s})),
    skill<Open>(arm_law.gripping({0.1, 8, 0.05}).when({.finish = SkillFinish::opened, .timeout = 4s})),
    skill<Reach>(arm_law.when({.finish = SkillFinish::settled, .timeout = 20s})));
constexpr GripperRange range{0.085, 5, 20, 0.01, 0.1};
const RobotConfiguration<6> robot{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 6};

auto scene() {
  const auto arm = by_position(skilled_model, robot);
  return Cycle(arm, skill_set<Rest>(library, {}, OneGripper(range),
                                    skill_controller<controller::Gravity>(GravityControl{}),
                                    skill_controller<controller::SplineJoint>(SplineJoint<6>(arm))));
}
using Scene = decltype(scene());
using Set = Scene::law_type;
static_assert(std::is_same_v<decltype(Scene::Input::gripper), GripperState>);
static_assert(std::is_trivially_copyable_v<Set::Memory>);
static_assert(!InputWithGripper<CycleInput<6>> &&
              !InputWithGoal<CycleInput<6>>);  // what no part declares is not there

/// An ideal arm with fingers at constant speed, reported 20 ms late.
template <class Scene>
class Run {
 public:
  explicit Run(const Scene& cycle)
      : cycle_(cycle), memory_(std::make_unique<typename Scene::Memory>()), recording(8 << 20) {
    measured_.q = {0.1, -1.2, 1.4, -1.0, -1.5, 0.2};
    cycle_.start(*memory_, measured_);
    recording.start(measured_);
  }
  void ask(const typename Scene::Goal& goal) {
    goal_ = goal;
    asks_ = true;
  }
  typename Scene::Output step() {
    now_ += 8ms;
    measured_.time = now_;
    typename Scene::Input input;
    if constexpr (InputWithConfiguration<typename Scene::Input>) input.configuration = configuration;
    input.now = now_;
    input.measured = measured_;
    if (asks_) input.goal = goal_;
    asks_ = false;
    input.gripper = reported_[2];
    const auto out = cycle_.step(*memory_, input);
    recording.add(input, out.planned);
    measured_.q = out.command.position;
    measured_.dq = out.planned.velocity;
    move_fingers(out.gripper);
    return out;
  }
  SkillReport until_ended(std::uint16_t ticket) {
    for (int i = 0; i < 3000; ++i) {
      step();
      const auto r = report(ticket);
      if (r.phase == SkillPhase::finished || r.phase == SkillPhase::failed) return r;
    }
    return {};
  }
  [[nodiscard]] SkillReport report(std::uint16_t ticket) const {
    return Set::report_of(memory_->law, ticket);
  }
  [[nodiscard]] const State<6>& measured() const { return measured_; }
  [[nodiscard]] Nanoseconds now() const { return now_; }

  std::uint32_t configuration = 0;
  double object = 0.06;  ///< width of what is between the fingers [m]
  GripperError error = GripperError::none;
  double opening = 0.085;
  GripperCommand told;

 private:
  void move_fingers(const GripperCommand& command) {
    told = command;
    const double goal = command.count > 0 ? command.goal.opening : opening, most = command.goal.speed * 0.008;
    const double stop = goal < object && opening >= object ? object : goal;
    opening += std::clamp(stop - opening, -most, most);
    reported_[2] = reported_[1];
    reported_[1] = reported_[0];
    reported_[0] = {now_, opening,         opening == object && goal < object ? command.goal.force : 0,
                    true, opening != stop, opening == object && goal < object,
                    true, error,           0};
  }
  const Scene& cycle_;
  std::unique_ptr<typename Scene::Memory> memory_;
  State<6> measured_;
  Nanoseconds now_{};
  GripperState reported_[3]{};
  typename Scene::Goal goal_{};
  bool asks_ = false;

 public:
  Recording<Scene> recording;
};
}  // namespace

TEST_CASE("OneGripper: a skill ends when the gripper holds something, or fails when it is empty or broken") {
  const auto cycle = scene();
  Run run(cycle);
  run.step();
  CHECK(run.told.count == 0);
  run.ask(Set::start_skill<Grasp>().with_ticket(1));
  CHECK(run.until_ended(1) == SkillReport{1, SkillPhase::finished, SkillFailure::none});
  CHECK(run.opening == 0.06);
  CHECK(run.told.goal == GripperGoal{0, 8, 0.05});
  run.ask(Set::start_skill<Open>().with_ticket(2));
  CHECK(run.until_ended(2).phase == SkillPhase::finished);
  CHECK(run.opening == doctest::Approx(0.085));  // the end of its range
  CHECK(run.told.count == 2);
  run.object = -1;
  run.ask(Set::start_skill<Grasp>().with_ticket(3));
  CHECK(run.until_ended(3) == SkillReport{3, SkillPhase::failed, SkillFailure::empty});
  run.error = GripperError::fault;
  run.ask(Set::start_skill<Open>().with_ticket(4));
  CHECK(run.until_ended(4) == SkillReport{4, SkillPhase::failed, SkillFailure::gripper});
  // A gripper that does not answer: the timeout.
  run.error = GripperError::silent;
  run.ask(Set::start_skill<Open>().with_ticket(5));
  const auto asked = run.now();
  CHECK(run.until_ended(5) == SkillReport{5, SkillPhase::failed, SkillFailure::timeout});
  CHECK(run.now() - asked < 4200ms);
  // The whole run again, from its recording.
  const auto again = replay(cycle, run.recording);
  CHECK(again.cycles > 500);
  CHECK(again.different == 0);
}

TEST_CASE(
    "OneGripper: a request's own goal goes before the skill's, at once or while it runs; a wrong one is "
    "refused") {
  const auto cycle = scene();
  Run run(cycle);
  run.object = -1;
  run.ask(Set::start_skill<Open>(GripperGoal{0.03, 300, 1}).with_ticket(1));
  CHECK(run.until_ended(1).phase == SkillPhase::finished);
  CHECK(run.opening == doctest::Approx(0.03));
  CHECK(run.told.goal == GripperGoal{0.03, 20, 0.1});  // brought into its range
  run.ask(Set::goal(GripperGoal{0.05, 8, 0.05}).with_ticket(2));
  CHECK(run.until_ended(2).phase == SkillPhase::finished);
  CHECK(run.opening == doctest::Approx(0.05));
  run.ask(Set::goal(GripperGoal{std::numeric_limits<double>::quiet_NaN(), 8, 0.05}).with_ticket(3));
  run.step();
  CHECK(run.report(3).failure == SkillFailure::goal);
  run.step();
  CHECK(run.told.goal.opening == 0.05);
  CHECK_THROWS_AS(OneGripper({0, 5, 20, 0.01, 0.1}), ConfigurationError);
  CHECK_THROWS_AS(OneGripper({0.1, 5, 2, 0.01, 0.1}), ConfigurationError);
  // A skill that grips, in a set without a gripper.
  CHECK_THROWS_AS(static_cast<void>(skill_set<Rest>(
                      library, {}, skill_controller<controller::Gravity>(GravityControl{}),
                      skill_controller<controller::SplineJoint>(SplineJoint<6>(skilled_settings(0.008))))),
                  ConfigurationError);
}

TEST_CASE("GoalTolerance: a goal is reached as near as its request asks, not nearer and not less near") {
  const auto cycle = scene();
  double fastest = 0;
  for (const double tolerance : {0.0, 0.002, 0.05}) {
    Run run(cycle);
    run.step();
    JointGoal<6> goal{run.measured().q, 2s};
    goal.q_g[1] += 0.4;
    run.ask(Set::start_skill<Reach>(goal).with_ticket(1).within({.joint = tolerance}));
    CHECK(run.until_ended(1).phase == SkillPhase::finished);
    double off = 0;
    for (std::size_t i = 0; i < 6; ++i) off = std::max(off, std::abs(run.measured().q[i] - goal.q_g[i]));
    CAPTURE(tolerance);
    if (tolerance > 0) CHECK(off <= tolerance);
    if (tolerance > 0.01) CHECK(off > 0.1 * tolerance);
    const double took = seconds<double>(run.now());
    if (fastest > 0) CHECK(took < fastest);
    fastest = took;
  }
}

TEST_CASE(
    "OneGripper: in a scene of several configurations, through a change of them, recorded and replayed") {
  const Configurations cycle(scene(), scene());
  Run run(cycle);
  run.step();
  run.ask(Set::start_skill<Grasp>().with_ticket(1));
  run.step();
  run.configuration = 1;  // while the fingers close
  CHECK(run.until_ended(1) == SkillReport{1, SkillPhase::finished, SkillFailure::none});
  CHECK(run.opening == 0.06);
  run.ask(Set::start_skill<Open>().with_ticket(2));
  CHECK(run.until_ended(2).phase == SkillPhase::finished);
  CHECK(run.told.count == 2);
  CHECK(replay(cycle, run.recording).different == 0);
}
