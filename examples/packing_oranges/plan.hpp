// The plan: what is done with an orange, and in which order. No robot in it.
#pragma once

#include "examples/packing_oranges/layout.hpp"
#include "skinctl/semantics/task.hpp"

namespace packing {

/// A plan: what is done, in which order and where. The one below, or one that a person has taught. Places are
/// those of the first arm; the second one does the same from its side.
using Plan = skinctl::TaughtTask<48>;

/// Classes of objects.
inline constexpr skinctl::ObjectClass orange_class = 1, box_class = 2, bin_class = 3;
/// A box that is full, and where full boxes are put: no detector tells them, the arms know them.
inline constexpr skinctl::ObjectClass full_box_class = 4, shelf_class = 5;

/// Up, with what is in the hand: it is carried from then on.
struct Lift {
  static constexpr skinctl::ActivityRule rule{.name = "lift",
                                              .word = skinctl::Activity::put,
                                              .needs = skinctl::fact::in_hand,
                                              .adds = skinctl::fact::carried,
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
  if (s.does == &FindRoom::rule) return "find a box with room";
  if (s.does == &activity::Put::rule) return box ? "to box" : "to bin";
  if (s.does == &activity::Find::rule) return box ? "find the box" : "find the bin";
  return s.does == &activity::ReachAbove::rule             ? "reach above"
         : s.does == &GoBack::rule                         ? "go back"
         : s.does == &Lift::rule && s.needs.has(fact::bad) ? "lift a bad one"
                                                           : s.does->name;
}

}  // namespace packing
