// The process: sort, pack, put the full box away. What is done, and in which order; no robot in it.
#pragma once

#include "examples/packing_oranges/plan.hpp"
#include "skinctl/semantics/process.hpp"

namespace packing {

using Process = skinctl::Process<Plan::capacity>;

/// Middle of a side of the box, where a wall stands between the fingers: from its own side, the box at first.
inline constexpr skinctl::Xyz<double> wall_place{-(box_tray.half_x + 0.004), 0, 0.062};

/// Takes an orange and judges it. A bad one goes into the bin, then the next one; a good one stays in the hand.
inline constexpr Plan sort_oranges = [] {
  using namespace skinctl;
  enum : std::uint8_t {
    look,
    above,
    reach,
    take,
    squeeze,
    lift_good,
    lift_bad,
    find_bin,
    to_bin,
    drop,
    back,
    count
  };
  constexpr auto O = orange_class;
  Plan out;
  out.name = "sort";
  out.size = count;
  out.steps = {step_of<activity::Look>({.role = O, .done = above, .no = finish}),
               step_of<activity::ReachAbove>({.role = O, .done = reach}),
               step_of<activity::Reach>({.role = O, .done = take}),
               step_of<activity::Take>({.role = O, .done = squeeze}),
               step_of<activity::Squeeze>({.role = O, .done = lift_good, .no = lift_bad, .border = 0}),
               step_of<Lift>({.role = O, .done = finish, .needs = fact::good}),
               step_of<Lift>({.role = O, .done = find_bin, .needs = fact::bad}),
               step_of<activity::Find>({.role = O, .place = 0, .done = to_bin, .needs = fact::bad}),
               step_of<activity::Put>(
                   {.role = O, .place = 0, .done = drop, .needs = fact::bad | fact::carried | fact::marked}),
               step_of<activity::Release>({.role = O, .place = 0, .done = back}),
               step_of<GoBack>({.role = O, .done = look})};
  out.places[0] = {bin_class, {}};
  out.place_count = 1;
  out.borders[0] = pack_oranges.borders[0];
  out.border_count = 1;
  return out;
}();

/// Puts the good orange that is in the hand into the box, once that has room. A hand that went back has none.
inline constexpr Plan pack_orange = [] {
  using namespace skinctl;
  constexpr auto O = orange_class;
  Plan out;
  out.name = "pack";
  out.begins = fact::in_hand | fact::good | fact::carried;
  out.size = 4;
  out.steps = {step_of<FindRoom>({.role = O, .place = 0, .done = 1, .failed = finish, .needs = fact::good}),
               step_of<activity::Put>({.role = O,
                                       .place = 0,
                                       .done = 2,
                                       .failed = finish,
                                       .needs = fact::good | fact::carried | fact::marked}),
               step_of<activity::Release>({.role = O, .place = 0, .done = 3, .failed = finish}),
               step_of<GoBack>({.role = O, .done = finish, .failed = finish})};
  out.places[0] = pack_oranges.places[place::box];
  out.place_count = 1;
  return out;
}();

/// With two tables: takes and judges an orange, and drives a good one to the table with the box.
inline constexpr Plan sort_and_drive = [] {
  using namespace skinctl;
  Plan out = sort_oranges;
  out.name = "sort and drive";
  for (Step& s : out.steps)
    if (s.does == &Lift::rule && s.done == finish) s.done = out.size;
  out.steps[out.size++] = step_of<DriveToBox>({.role = orange_class, .done = finish, .needs = fact::good});
  return out;
}();
/// Puts it into the box there, and drives back.
inline constexpr Plan pack_and_drive = [] {
  using namespace skinctl;
  Plan out = pack_orange;
  out.name = "pack and drive";
  out.begins = out.begins | at_box;
  const std::uint8_t drive = out.size++;
  for (std::uint8_t k = 0; k < drive; ++k) {
    Step& s = out.steps[k];
    for (std::uint8_t* to : {&s.done, &s.failed})
      if (*to == finish) *to = drive;
    if (s.does != &GoBack::rule) s.needs = s.needs | at_box;
  }
  out.steps[drive] = step_of<DriveToOranges>({.role = orange_class, .done = finish, .failed = drive});
  return out;
}();

/// Takes a full box by its wall, and moves it to where a person fetches it. There is nothing to do while none is full.
inline constexpr Plan put_box_away = [] {
  using namespace skinctl;
  enum : std::uint8_t { look, above, reach, take, push, let_go, back, count };
  enum : std::uint8_t { wall, shelf };
  constexpr auto B = full_box_class;
  Plan out;
  out.name = "put away";
  out.size = count;
  out.steps = {step_of<activity::Look>({.role = B, .done = above, .no = finish}),
               step_of<activity::ReachAbove>({.role = B, .place = wall, .done = reach}),
               step_of<activity::Reach>({.role = B, .place = wall, .done = take}),
               step_of<activity::Take>({.role = B, .place = wall, .done = push}),
               step_of<activity::Put>({.role = B, .place = shelf, .done = let_go}),
               step_of<activity::Release>({.role = B, .place = shelf, .done = back}),
               step_of<GoBack>({.role = B, .done = finish})};
  out.places[wall] = {
      box_class, Transform<ObjectFrame, Tool>::translation_xyz(wall_place.x, wall_place.y, wall_place.z)};
  out.places[shelf] = {shelf_class, {}};
  out.place_count = 2;
  return out;
}();

/// Sorted and packed until no orange is left; in between full boxes are put away.
inline constexpr Process sort_pack_put_away = [] {
  Process out;
  out.name = "sort, pack, put away";
  out.repeats = true;
  out.size = 3;
  out.tasks = {sort_oranges, pack_orange, put_box_away};
  return out;
}();
inline constexpr Plan process_by_hand = skinctl::joined(sort_pack_put_away);

/// Sorted at one table and packed at another one, until no orange is left.
inline constexpr Process sort_drive_pack_drive = [] {
  Process out;
  out.name = "sort, drive, pack, drive";
  out.repeats = true;
  out.size = 2;
  out.tasks = {sort_and_drive, pack_and_drive};
  return out;
}();
inline constexpr Plan process_between_tables = skinctl::joined(sort_drive_pack_drive);
/// All of these tasks, for those who have to know what may be asked of an arm.
inline constexpr Plan all_that_is_done = skinctl::joined([] {
  Process out = sort_drive_pack_drive;
  out.tasks[out.size++] = put_box_away;
  return out;
}());
/// Whether arms that do this drive between two tables.
[[nodiscard]] constexpr bool drives(const Plan& plan) noexcept {
  for (std::size_t k = 0; k < plan.size; ++k)
    if (plan.steps[k].does == &DriveToBox::rule) return true;
  return false;
}

/// Whether arms that do this put full boxes away, and no person fetches them where they were filled.
[[nodiscard]] constexpr bool puts_boxes_away(const Plan& plan) noexcept {
  for (std::size_t k = 0; k < plan.size; ++k)
    if (plan.steps[k].role == full_box_class) return true;
  return false;
}

}  // namespace packing
