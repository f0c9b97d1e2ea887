#include "skinctl/skills/skill_request.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <type_traits>
#include <vector>

#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/recording/recording.hpp"

using namespace skinctl;
using Asked = SkillRequest<JointGoal<6>, JointReference<6>>;
static_assert(std::is_trivially_copyable_v<Asked> && std::is_default_constructible_v<Asked>);

TEST_CASE("SkillRequest: all its numbers are walked, so that a recording holds and restores it") {
  Asked request;
  request.kind = 0;
  request.skill = 7;
  request.ticket = 40000;
  request.reported = {3, 2};
  request.goals.of<JointGoal<6>>().has = true;
  request.goals.of<JointGoal<6>>().goal = {JointPosition<6>{1, 2, 3, 4, 5, 6}, 7s};
  request.goals.of<JointReference<6>>().goal.dq_d[5] = 0.5;
  std::vector<double> numbers;
  each_number(request, [&](const auto& x) { numbers.push_back(static_cast<double>(x)); });
  CHECK(numbers.size() == 5 + 3 + 1 + 7 + 1 + 18);
  Asked copy;
  std::size_t k = 0;
  each_number(copy, [&](auto& x) { x = static_cast<std::remove_cvref_t<decltype(x)>>(numbers[k++]); });
  CHECK(copy.skill == 7);
  CHECK(copy.ticket == 40000);
  CHECK(copy.reported == SkillSwitches{3, 2});
  CHECK(copy.goals.of<JointGoal<6>>().has);
  CHECK_FALSE(copy.goals.of<JointReference<6>>().has);
  CHECK(copy.goals.of<JointGoal<6>>().goal.q_g == JointPosition<6>{1, 2, 3, 4, 5, 6});
  CHECK(copy.goals.of<JointGoal<6>>().goal.duration == 7s);
  CHECK(copy.goals.of<JointReference<6>>().goal.dq_d[5] == 0.5);
  CHECK(copy.goals.any());
  CHECK_FALSE(Asked{}.goals.any());
  // A number that is none is carried: whoever takes the request refuses it.
  CHECK(std::isnan(request.within({.position = std::nan("")}).tolerance.position));
}
