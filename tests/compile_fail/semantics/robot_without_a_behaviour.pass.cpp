#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skills/behaviours.hpp"
using namespace skinctl;

struct Set {
  template <class B>
  static constexpr std::uint8_t index() {
    return 0;
  }
};
constexpr auto robot = boost::hana::make_map(done_by<activity::Reverse, behaviour::Reaching>(),
                                             done_by<activity::Look, behaviour::Reaching>());
constexpr auto look = task("look", {}, step_of<activity::Look>({}));
const auto right = skill_map<Set>(robot, look);
