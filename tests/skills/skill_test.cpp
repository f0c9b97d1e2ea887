#include "skinctl/skills/skill.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("SkillSwitches: what one command leaves of another, and whether a gripper stands as told") {
  static_assert(closed().then(opened(1)) == SkillSwitches{3, 1});
  CHECK((closed().which == 1 && closed().on == 1));
  CHECK((opened(2).which == 4 && opened(2).on == 0));
  CHECK(opened().then(closed()) == closed());
  CHECK(closed(1).then(opened(0)).then(opened(1)) == SkillSwitches{3, 0});
  CHECK(SkillSwitches{3, 1}.stand(closed()));
  CHECK(SkillSwitches{3, 1}.stand(opened(1)));
  CHECK(SkillSwitches{}.stand(SkillSwitches{}));
  CHECK_FALSE(SkillSwitches{3, 1}.stand(closed(1)));
  CHECK_FALSE(SkillSwitches{2, 2}.stand(closed(0)));
}
