// The task of section 6, for tests: an orange into the box or the bin.
#pragma once

#include "skinctl/semantics/process.hpp"

namespace skinctl::testing {

namespace packing_step {
enum : std::uint8_t { look, above, reach, take, squeeze, to_box, let_go, to_bin, drop };
}
inline constexpr ObjectClass orange = 1;
inline constexpr std::uint8_t box = 0, bin = 1;

inline constexpr auto packing_oranges = [] {
  using namespace packing_step;
  return task("pack oranges", {},                                                          //
              step_of<activity::Look>({.role = orange, .done = above, .no = finish}),      //
              step_of<activity::ReachAbove>({.role = orange, .done = reach}),              //
              step_of<activity::Reach>({.role = orange, .done = take}),                    //
              step_of<activity::Take>({.role = orange, .done = squeeze}),                  //
              step_of<activity::Squeeze>({.role = orange, .done = to_box, .no = to_bin}),  //
              step_of<activity::Put>({.role = orange, .place = box, .done = let_go, .needs = fact::good}),
              step_of<activity::Release>({.role = orange, .place = box, .done = look}),
              step_of<activity::Put>({.role = orange, .place = bin, .done = drop, .needs = fact::bad}),
              step_of<activity::Release>({.role = orange, .place = bin, .done = look}));
}();

}  // namespace skinctl::testing
