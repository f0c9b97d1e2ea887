#include <doctest/doctest.h>

#include <sstream>

#include "skinctl/skinctl.hpp"
#include "tests/support/comma_locale.hpp"

using namespace skinctl;

TEST_CASE("describe: an expression reads as it was written") {
  const SplineJoint<6> reach({.dt = 2ms});
  const JointControl<6> follow({.dt = 2ms});
  const SkinJointControl skin;
  const GravityControl gravity;
  CHECK(describe(0.6 * skin + 0.4 * reach + gravity) == "0.6 skin_joint + 0.4 spline_joint + gravity");
  CHECK(describe(reach) == "spline_joint");
  CHECK(describe(weighted(reach + 2 * follow)) == "weighted(spline_joint + 2 joint)");
  CHECK(describe(plain(0.25 * reach + gravity)) == "plain(0.25 spline_joint + gravity)");
  const auto sum = skin + when_untouched(reach) + when_touched(follow) + gravity;
  CHECK(describe(blended(sum)) == "blended(skin_joint + untouched: spline_joint + touched: joint + gravity)");
  CHECK(describe(blended(skin + reach).sum()) == "skin_joint + spline_joint");
  CHECK(describe(skin + 0.5 * task_priority<5>(reach, follow)) ==
        "skin_joint + 0.5 (spline_joint over joint)");
  std::ostringstream out;
  const testing::CommaLocale comma;  // in every locale
  out << describe(0.1 * reach + gravity) << '!';
  CHECK(out.str() == "0.1 spline_joint + gravity!");
}

TEST_CASE("describe: what does not fit is cut off") {
  const SplineJoint<6> law({.dt = 2ms});
  const auto four = law + law + law + law;
  const auto many = four + four + four + four + four + four;
  CHECK(describe(many).view().size() == 255);
  CHECK(describe(many).c_str()[255] == '\0');
}
