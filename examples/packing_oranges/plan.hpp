// The plan: what is done with an orange, and in which order. No robot in it.
#pragma once

#include "examples/packing_oranges/layout.hpp"
#include "skinctl/semantics/process.hpp"

namespace packing {

/// Classes of objects.
inline constexpr skinctl::ObjectClass orange_class = 1;

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

namespace step {
enum : std::uint8_t {
  look,
  above,
  reach,
  take,
  squeeze,
  lift_good,
  to_box,
  let_go,
  lift_bad,
  to_bin,
  drop,
  back,
  count
};
}
inline constexpr const char* step_names[] = {"look",           "reach above", "reach",   "take",
                                             "squeeze",        "lift",        "to box",  "release",
                                             "lift a bad one", "to bin",      "release", "go back"};

/// A good orange goes into the box, a bad one into the bin; then the next one, until there is none.
inline constexpr auto pack_oranges = [] {
  using namespace skinctl;
  using namespace step;
  constexpr auto O = orange_class;
  return task("pack oranges", {}, step_of<activity::Look>({.role = O, .done = above, .no = finish}),
              step_of<activity::ReachAbove>({.role = O, .done = reach}),
              step_of<activity::Reach>({.role = O, .done = take}),
              step_of<activity::Take>({.role = O, .done = squeeze}),
              step_of<activity::Squeeze>({.role = O, .done = lift_good, .no = lift_bad}),
              step_of<Lift>({.role = O, .done = to_box, .needs = fact::good}),
              step_of<activity::Put>(
                  {.role = O, .place = place::box, .done = let_go, .needs = fact::good | fact::carried}),
              step_of<activity::Release>({.role = O, .place = place::box, .done = back}),
              step_of<Lift>({.role = O, .done = to_bin, .needs = fact::bad}),
              step_of<activity::Put>(
                  {.role = O, .place = place::bin, .done = drop, .needs = fact::bad | fact::carried}),
              step_of<activity::Release>({.role = O, .place = place::bin, .done = back}),
              step_of<GoBack>({.role = O, .done = look}));
}();
static_assert(pack_oranges.capacity == step::count);

}  // namespace packing
