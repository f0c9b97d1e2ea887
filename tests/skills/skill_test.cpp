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

namespace {
constexpr Skill<5> made(std::array<std::uint8_t, 5> order, std::uint8_t count) {
  Skill<5> s;
  s.order = order;
  s.controllers = count;
  for (std::uint8_t k = 0; k < count; ++k) s.weights[order[k]] = 1;
  return s;
}
}  // namespace

TEST_CASE(
    "transition: loads in the new recipe's order, keeps what both have, unloads the last that came first") {
  const auto from = made({4, 0, 2, 3}, 4), to = made({4, 1, 0}, 3);
  const auto change = transition(from, to);
  CHECK(change.loads == 1);
  CHECK(change.load[0] == 1);
  CHECK(change.keeps == 2);
  CHECK((change.keep[0] == 4 && change.keep[1] == 0));
  CHECK(change.unloads == 2);
  CHECK((change.unload[0] == 3 && change.unload[1] == 2));
  const auto none = transition(to, to);
  CHECK((none.loads == 0 && none.keeps == 3 && none.unloads == 0));
}
