#include "skinctl/limits/link_contact.hpp"

#include <doctest/doctest.h>

#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

TEST_CASE("LinkContact: cells and decelerations that cannot be are refused") {
  const auto contact = [] {
    return LinkContact<2>{.region = {.force = 100, .blow = 100, .first = 500ms, .stiffness = 2e4, .mass = 4},
                          .reach = 0.45,
                          .reaction_time = 20ms};
  };
  CHECK_NOTHROW(ContactLimits(ur5::Model{}, contact()));
  auto c = contact();
  c.deceleration = 0;
  CHECK_THROWS_AS(ContactLimits(ur5::Model{}, c), ConfigurationError);
  c = contact();
  c.cells = {CellPlace{.link = 1}};
  CHECK_THROWS_AS(ContactLimits(ur5::Model{}, c), ConfigurationError);
}
