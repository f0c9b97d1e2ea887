#include "skinctl/tracking/spline_plan.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <type_traits>

#include "skinctl/testing/random.hpp"
#include "skinctl/tracking/joint_space.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Plan = SplinePlan<JointSpace<3>>;
using Settings = JointControlSettings<3>;
static_assert(std::is_trivially_copyable_v<Plan>);
const JointPosition<3> here{0.1, -0.2, 0.3};
}  // namespace

TEST_CASE("SplinePlan: a goal gets the time it asks for, if the speed allows") {
  const Settings s;  // 1 rad/s
  const auto standing = Plan::standing(here, s);
  CHECK(standing.at(0, s).q_d == here);
  const JointPosition<3> goal{1.1, -0.2, 0.0};
  const auto asked = standing.to({goal, 3s}, here, s);
  CHECK_FALSE(asked.status.any());
  CHECK(asked.memory.spline.tf == 3);
  CHECK(asked.memory.at(0, s).q_d == here);
  CHECK(asked.memory.at(3, s).q_d == goal);
  CHECK(asked.memory.advanced(1s, s).at(0.5, s).q_d[0] == doctest::Approx(0.6));

  const auto free = standing.to({goal, 0ns}, here, s);
  CHECK_FALSE(free.status.any());
  CHECK(free.memory.spline.tf == doctest::Approx(1.875));
  const auto short_way = standing.to({here, 0ns}, here, s);
  CHECK(short_way.memory.spline.tf == doctest::Approx(10 * seconds<double>(s.dt)));
}

TEST_CASE("SplinePlan: a goal that is too fast is stretched, or refused") {
  Settings s;
  const auto standing = Plan::standing(here, s);
  const JointPosition<3> goal{1.1, -0.2, 0.0};
  const auto stretched = standing.to({goal, 1s}, here, s);
  CHECK(stretched.status == Status(Reason::goal_stretched));
  CHECK(stretched.memory.spline.tf == doctest::Approx(1.875));
  double fastest = 0;
  for (int i = 0; i < 2000; ++i)
    fastest = std::max(fastest, magnitude(stretched.memory.at(i * 1e-3, s).dq_d[0]));
  CHECK(fastest == doctest::Approx(1.0).epsilon(1e-5));
  CHECK(fastest <= 1.0 + 1e-12);

  s.reach = GoalPolicy::refuse;
  const auto refused = standing.to({goal, 1s}, here, s);
  CHECK(refused.status == Status(Reason::goal_refused));
  CHECK(refused.memory.at(5, s).q_d == here);
  CHECK_FALSE(standing.to({goal, 2s}, here, s).status.any());
  CHECK_FALSE(standing.to({goal, 0ns}, here, s).status.any());
}

TEST_CASE("SplinePlan: goals that are not finite, or in the past, are refused") {
  const Settings s;
  const auto standing = Plan::standing(here, s);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    JointPosition<3> goal = here;
    goal[1] = bad;
    CHECK(standing.to({goal, 0ns}, here, s).status == Status(Reason::goal_refused));
    CHECK(standing.to({here, 0ns}, goal, s).status == Status(Reason::goal_refused));
  }
  CHECK(standing.to({here, -1ns}, here, s).status == Status(Reason::goal_refused));
}

TEST_CASE("SplinePlan: stops and goes on smoothly, its derivatives being derivatives all the way") {
  using E = Digits50;
  using ExactPlan = SplinePlan<JointSpace<2, E>>;
  const JointControlSettings<2, E> s{.dt = 2ms};
  const JointPosition<2, E> from{E(0), E(1)};
  auto plan = ExactPlan::standing(from, s).to({JointPosition<2, E>{E(1), E(0.5)}, 2s}, from, s).memory;
  plan = plan.advanced(700ms, s);
  const E h("1e-15");
  for (const bool holds : {true, false}) {
    plan = plan.held(holds, s);
    for (int i = 0; i < 30; ++i) {
      for (const E& x : {E("0.0005"), E("0.0035")}) {
        const auto before = plan.at(x - h, s), now = plan.at(x, s), after = plan.at(x + h, s);
        for (std::size_t j = 0; j < 2; ++j) {
          CHECK(magnitude((after.q_d[j] - before.q_d[j]) / (2 * h) - now.dq_d[j]) < E("1e-20"));
          CHECK(magnitude((after.dq_d[j] - before.dq_d[j]) / (2 * h) - now.ddq_d[j]) < E("1e-20"));
        }
      }
      plan = plan.advanced(4ms, s);
    }
    CHECK((plan.at(E(0), s).dq_d[0] == 0) == holds);
  }
}

TEST_CASE("SplinePlan: a goal that comes while it is held waits for the release") {
  const Settings s;
  auto plan = Plan::standing(here, s).held(true, s);
  plan = plan.advanced(1s, s);
  plan = plan.to({JointPosition<3>{0.5, 0.0, 0.0}, 2s}, here, s).memory;
  plan = plan.advanced(5s, s);
  CHECK(plan.at(0, s).q_d == here);
  plan = plan.held(false, s).advanced(3s, s);
  CHECK(plan.at(0, s).q_d == JointPosition<3>{0.5, 0.0, 0.0});
}
