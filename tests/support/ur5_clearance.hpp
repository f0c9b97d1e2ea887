// A UR5 that keeps clear of its table, itself and what moves around.
#pragma once

#include "skinctl/clearance/clearances.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace skinctl::testing {

/// By the tubes of its links, 20 mm apart; links 1 to 5 see up to `Most` obstacles. The table is a ball of
/// 100 m.
template <std::size_t Most>
[[nodiscard]] ClearanceAround<Most> ur5_clearance() {
  ClearanceAround<Most> c;
  for (std::size_t i = 0; i < 6; ++i)
    c.own.capsules.push_back({i, {ur5::tubes[i].from, ur5::tubes[i].to, ur5::tubes[i].radius}});
  c.own.capsules.push_back({LinkCapsule::fixed, {{0, 0, -100}, {0, 0, -100}, 100}});
  c.own.pairs = {{0, 4}, {0, 5}, {1, 4}, {1, 5}, {2, 6}, {4, 6}, {5, 6}};
  c.own.margin = 0.02;
  c.own.reach = 1.2;
  c.exposed = {1, 2, 3, 4, 5};
  return c;
}

}  // namespace skinctl::testing
