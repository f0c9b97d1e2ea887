#include "skinctl/law/law_table.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

namespace {
struct Silent : StatelessLaw<Silent> {};
struct Tells : StatelessLaw<Tells> {
  using Goal = int;
  static constexpr LawRole role = LawRole::tracking;
  static constexpr Needs needs{.touch = true};
  static constexpr bool presses = false, complete_sum = false, compensates_friction = true;
  static constexpr std::size_t joints = 3, terms = 2;
  static constexpr std::array<LawRole, 2> roles{LawRole::gravity, LawRole::reactive};
  static constexpr const char* name = "tells";
};
struct Answers : StatelessLaw<Answers> {
  static constexpr Needs needs{.touch = true};
};
struct Weight : StatelessLaw<Weight> {
  static constexpr LawRole role = LawRole::gravity;
};
using None = LawTable<Silent>;
static_assert(!None::takes_goals && std::is_same_v<None::Goal, NoGoal> && None::joints == 0 &&
              None::terms == 1);
static_assert(None::roles[0] == LawRole::reactive && None::gravity_laws == 0 && !None::holds_gravity);
static_assert(!None::is_complete_sum && !None::presses && !None::compensates_friction && !None::is_gated);
static_assert(None::starts_blank && !None::answers_touch && None::name == "law");
static_assert(std::is_same_v<None::scalar_in<float>, float>);
using All = LawTable<Tells>;
static_assert(All::takes_goals && std::is_same_v<All::Goal, int> && All::joints == 3 && All::terms == 2);
static_assert(All::roles[0] == LawRole::gravity && All::roles_with_carried[2] == LawRole::tracking);
static_assert(All::holds_gravity && All::compensates_friction && All::name == "tells");
static_assert(!All::presses && !All::is_complete_sum);  // the value counts, not that there is one
static_assert(!All::answers_touch && LawTable<Answers>::answers_touch);
static_assert(LawTable<Weight>::gravity_laws == 1 && LawTable<Weight>::holds_gravity);
}  // namespace

TEST_CASE("LawTable: settings are compared where a law has some") {
  LawTable<Silent>::check_for(Silent{}, 1);
  CHECK(None::name == "law");
}
