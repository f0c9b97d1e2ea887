// Units mistaken in a patch are refused when it is built, with the number and the allowed range.
#include <doctest/doctest.h>

#include <string>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;

namespace {

Skin<ur5::Model, double, Patch<5, 1>> skin_at(double z, double gain) {
  return Skin<ur5::Model, double, Patch<5, 1>>(
      Patch<5, 1>({{1, {Rotation<double>{}, {0, 0, z}}}}, {.force = gain}));
}

}  // namespace

TEST_CASE("Patch: millimetres as metres and a gain of tonnes are refused with the range") {
  CHECK(complaint_of([] { return skin_at(0.1, 20); }).empty());
  CHECK(complaint_of([] { return skin_at(100, 20); }) ==
        "skinctl: Patch: distance of a cell from its link's origin = 100, allowed: <= 10 m");
  CHECK(complaint_of([] { return skin_at(0.1, 20000); }) ==
        "skinctl: Patch: gain of force = 20000, allowed: 0 to 1e4 N");
}
