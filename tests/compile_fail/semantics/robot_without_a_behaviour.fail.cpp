// expect: the_robot_has_no_behaviour_for_an_activity
#include "skinctl/semantics/process.hpp"
#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skills/behaviours.hpp"
using namespace skinctl;

struct Set {
  template <class B>
  static constexpr std::uint8_t index() {
    return 0;
  }
};
#ifdef SKINCTL_RIGHT
constexpr auto robot = boost::hana::make_map(done_by<activity::Reverse, behaviour::Reaching>(),
                                             done_by<activity::Look, behaviour::Reaching>());
constexpr auto look = task("look", {}, step_of<activity::Look>({}));
const auto right = skill_map<Set>(robot, look);
#else
constexpr auto robot = boost::hana::make_map(done_by<activity::Reverse, behaviour::Reaching>());
constexpr auto look = task("look", {}, step_of<activity::Look>({}));
const auto wrong = skill_map<Set>(robot, look);
#endif
