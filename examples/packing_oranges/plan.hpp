// The plan: what is done with an orange, and in which order. No robot in it.
#pragma once

#include "examples/packing_oranges/layout.hpp"
#include "skinctl/semantics/drive.hpp"
#include "skinctl/semantics/task.hpp"
#include "skinctl/semantics/taught_way.hpp"

namespace packing {

/// A plan: what is done, in which order and where. The one below, or one that a person has taught. Places are
/// those of the first arm; the second one does the same from its side.
using Plan = skinctl::TaughtTask<48>;

/// Classes of objects.
inline constexpr skinctl::ObjectClass orange_class = 1, box_class = 2, bin_class = 3;
/// A box that is full, and where full boxes are put: no detector tells them, the arms know them.
inline constexpr skinctl::ObjectClass full_box_class = 4, shelf_class = 5;
/// A tool. Where one is used, bread takes the part of the oranges, and plates that of the bins.
inline constexpr skinctl::ObjectClass tool_class = 7;
/// Whether hands take such a thing.
[[nodiscard]] constexpr bool is_taken(skinctl::ObjectClass kind) noexcept {
  return kind == orange_class || kind == tool_class;
}
/// A mark on a table, by which a robot that drives finds out where it stands.
inline constexpr skinctl::ObjectClass mark_class = 6;

/// What is in the hand stands on something firm: a wrist that presses it down feels how stiff it is.
inline constexpr skinctl::Facts firm_below = skinctl::fact::own<0>;

/// Down with what is in the hand, until the wrist feels that it stands: where it was taken, or at a squeeze area,
/// the place of the step.
struct SetDown {
  static constexpr skinctl::ActivityRule rule{.name = "set_down",
                                              .word = skinctl::Activity::put,
                                              .needs = skinctl::fact::in_hand,
                                              .adds = firm_below,
                                              .timeout = 6s};
};

/// Up, with what is in the hand: it is carried from then on.
struct Lift {
  static constexpr skinctl::ActivityRule rule{.name = "lift",
                                              .word = skinctl::Activity::put,
                                              .needs = skinctl::fact::in_hand,
                                              .adds = skinctl::fact::carried,
                                              .removes = firm_below,
                                              .timeout = 5s};
};

/// The empty hand, away from where it let go, over the oranges.
struct GoBack {
  static constexpr skinctl::ActivityRule rule{
      .name = "go_back", .word = skinctl::Activity::reach, .forbids = skinctl::fact::in_hand, .timeout = 10s};
};

/// Finds a box that has room, and waits until there is one: longer than an arm and a person take to exchange it.
struct FindRoom {
  static constexpr skinctl::ActivityRule rule{
      .name = "find_room", .adds = skinctl::fact::marked, .timeout = 40s, .retries = 0};
};

/// Drives of a robot between two tables: to the one with the oranges, and to the one with the box.
inline constexpr skinctl::Facts at_oranges = skinctl::fact::own<1>, at_box = skinctl::fact::own<2>;
using DriveToOranges = skinctl::activity::Drive<at_oranges, at_box>;
using DriveToBox = skinctl::activity::Drive<at_box, at_oranges>;

namespace step {
enum : std::uint8_t {
  look,
  above,
  reach,
  take,
  squeeze,
  lift_good,
  find_box,
  to_box,
  let_go,
  lift_bad,
  find_bin,
  to_bin,
  drop,
  back,
  count
};
}
namespace place {
enum : std::uint8_t { box, bin };
}

/// A good orange goes into the box, a bad one into the bin; then the next one, until there is none. A place at
/// height 0 is as high as the orange was taken. The border is force over the way of the fingers: half of a
/// side's stiffness.
inline constexpr Plan pack_oranges = [] {
  using namespace skinctl;
  using namespace step;
  constexpr auto O = orange_class;
  Plan out;
  out.name = "pack oranges";
  out.size = step::count;
  out.steps = {
      step_of<activity::Look>({.role = O, .done = above, .no = finish}),
      step_of<activity::ReachAbove>({.role = O, .done = reach}),
      step_of<activity::Reach>({.role = O, .done = take}),
      step_of<activity::Take>({.role = O, .done = squeeze}),
      step_of<activity::Squeeze>({.role = O, .done = lift_good, .no = lift_bad, .border = 0}),
      step_of<Lift>({.role = O, .done = find_box, .needs = fact::good}),
      step_of<activity::Find>({.role = O, .place = place::box, .done = to_box, .needs = fact::good}),
      step_of<activity::Put>({.role = O,
                              .place = place::box,
                              .done = let_go,
                              .needs = fact::good | fact::carried | fact::marked}),
      step_of<activity::Release>({.role = O, .place = place::box, .done = back}),
      step_of<Lift>({.role = O, .done = find_bin, .needs = fact::bad}),
      step_of<activity::Find>({.role = O, .place = place::bin, .done = to_bin, .needs = fact::bad}),
      step_of<activity::Put>(
          {.role = O, .place = place::bin, .done = drop, .needs = fact::bad | fact::carried | fact::marked}),
      step_of<activity::Release>({.role = O, .place = place::bin, .done = back}),
      step_of<GoBack>({.role = O, .done = look})};
  out.places = {{{box_class, Transform<ObjectFrame, Tool>::translation_xyz(-0.04, 0, 0)}, {bin_class, {}}}};
  out.place_count = 2;
  out.borders = {3873 / 2.0};
  out.border_count = 1;
  return out;
}();
static_assert([](Plan plan) { return check(plan).error; }(pack_oranges) == skinctl::TaskError::none);

/// A plan for a hand that only opens and closes: it presses what it squeezes down with the wrist, so each
/// squeeze needs that it stands; what was just taken is set down first. `check` refuses a plan that squeezes
/// what hangs in the air.
///
/// @param border  force of the wrist over its way, the stiffness of one side of an orange [N/m].
[[nodiscard]] constexpr Plan by_pressing(Plan plan, double border) {
  using namespace skinctl;
  for (std::uint8_t k = 0, size = plan.size; k < size; ++k) {
    Step& s = plan.steps[k];
    const bool squeezes_next = s.done < size && plan.steps[s.done].does == &activity::Squeeze::rule;
    if (s.does == &activity::Squeeze::rule) s.needs = s.needs | firm_below;
    if (s.does != &activity::Take::rule || !squeezes_next || plan.size == Plan::capacity) continue;
    plan.steps[plan.size] = step_of<SetDown>({.role = s.role, .done = s.done, .failed = s.failed});
    s.done = plan.size++;
  }
  for (std::size_t b = 0; b < plan.border_count; ++b) plan.borders[b] = border;
  return plan;
}
/// Share of a side's stiffness that a press tells: fingers slide a little. Measured, see the README.
inline constexpr double press_tells = 0.965;
inline constexpr double press_border = press_tells * 3873;
inline constexpr Plan press_oranges = by_pressing(pack_oranges, press_border);
static_assert([](Plan plan) { return check(plan).error; }(press_oranges) == skinctl::TaskError::none);
static_assert([](Plan plan) {
  plan.steps[step::take].done = step::squeeze;  // nothing says that it stands
  plan.size = step::count;
  return check(plan);
}(press_oranges)
                  .facts == firm_below);

/// Whether a tool is used.
[[nodiscard]] constexpr bool uses_tool(const Plan& plan) noexcept {
  for (std::size_t k = 0; k < plan.size; ++k)
    if (plan.steps[k].does == &skinctl::activity::Use::rule) return true;
  return false;
}

/// A step in words.
[[nodiscard]] constexpr const char* name_of(const Plan& plan, std::uint8_t k) noexcept {
  using namespace skinctl;
  const Step& s = plan.steps[k];
  const bool box = s.place != no_place && plan.places[s.place].mark == box_class;
  if (s.role == full_box_class)
    return s.does == &activity::Look::rule      ? "look for a full box"
           : s.does == &activity::Take::rule    ? "take its wall"
           : s.does == &activity::Put::rule     ? "push the box away"
           : s.does == &activity::Release::rule ? "let go of the box"
           : s.does == &GoBack::rule            ? "go back"
                                                : "reach its wall";
  if (s.does == &DriveToOranges::rule) return "drive to the oranges";
  if (s.does == &DriveToBox::rule) return "drive to the box";
  if (s.does == &FindRoom::rule) return "find a box with room";
  if (uses_tool(plan) && s.does == &activity::Put::rule)
    return s.role == tool_class ? "put the tool back" : "to the plate";
  if (uses_tool(plan) && s.does == &activity::Find::rule)
    return s.role == tool_class ? "find the bread" : "find the plate";
  if (s.does == &activity::Put::rule) return box ? "to box" : "to bin";
  if (s.does == &activity::Find::rule) return box ? "find the box" : "find the bin";
  return s.does == &activity::ReachAbove::rule             ? "reach above"
         : s.does == &GoBack::rule                         ? "go back"
         : s.does == &Lift::rule && s.needs.has(fact::bad) ? "lift a bad one"
                                                           : s.does->name;
}

}  // namespace packing
