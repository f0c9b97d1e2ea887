#include "skinctl/skills/skill.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

static_assert(closed().which == 1 && closed().on == 1 && opened(2).which == 4 && opened(2).on == 0);
static_assert(opened().then(closed()) == closed());
static_assert(closed().then(opened(1)) == SkillSwitches{3, 1});
static_assert(closed(1).then(opened(0)).then(opened(1)) == SkillSwitches{3, 0});
static_assert(SkillSwitches{3, 1}.stand(closed()) && SkillSwitches{3, 1}.stand(opened(1)) &&
              SkillSwitches{}.stand(SkillSwitches{}));
static_assert(!SkillSwitches{3, 1}.stand(closed(1)) && !SkillSwitches{2, 2}.stand(closed(0)));
