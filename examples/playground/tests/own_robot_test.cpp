// Robots that a visitor brings to the playground, natively: URDFs of an arm with six joints, and of two with
// seven, one of them locked.
#include <doctest/doctest.h>

#include <cstdio>

#include "examples/playground/tests/run.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace playground;
using skinctl::testing::sanitized;

namespace {

/// A robot as the page reads it, by the library's reader of URDFs.
Robot robot_of(const char* file, const skinctl::UrdfOptions& options = {}) {
  const skinctl::Urdf urdf = skinctl::read_urdf(std::string(DATA) + file, options);
  REQUIRE(urdf.joints.size() == Robot::joints);
  const auto place = [](const skinctl::Rotation<double>& R, const double(&p)[3]) {
    return Robot::Place{{R.x.x, R.x.y, R.x.z, R.y.x, R.y.y, R.y.z, R.z.x, R.z.y, R.z.z}, {p[0], p[1], p[2]}};
  };
  Robot r;
  r.given = 1;
  for (const skinctl::UrdfJoint& j : urdf.joints) {
    const auto i = static_cast<std::size_t>(&j - urdf.joints.data());
    r.joint[i] = {place(j.placed.R, j.placed.p), j.continuous ? 0 : j.lower, j.continuous ? 0 : j.upper,
                  j.velocity, j.effort};
    const skinctl::LinkInertia& in = j.placed.inertia;
    if (in.mass > 0)
      r.body[static_cast<std::size_t>(r.bodies++)] = {
          double(i), place({}, in.c), in.mass, {in.xx, in.yy, in.zz, in.xy, in.xz, in.yz}};
  }
  r.tip[2] = 0.1;
  return r;
}

}  // namespace

TEST_CASE("Playground: an own robot gives way by its skin, the same robot rigid does not, and it goes back") {
  for (const auto& [file, locked] :
       {std::pair{"arm6.urdf", ""}, {"iiwa14.urdf", "A3"}, {"fr3.urdf", "joint3"}}) {
    INFO(std::string(file));
    const Robot robot =
        robot_of(file, *locked ? skinctl::UrdfOptions{.locked = {{locked, 0}}} : skinctl::UrdfOptions{});
    for (const double interface : {0., 1.}) {
      if (sanitized && (interface > 0 || *locked)) continue;
      Run r({.interface = interface}, robot);
      const auto link = [&](int k) { return static_cast<int>(r.arms->cell(std::size_t(k))[0]); };
      // The middle of the link with most cells: a long one.
      int best = 0, most = 0, first = 0;
      for (int k = 1; k <= int(r.view.cells); ++k)
        if (k == int(r.view.cells) || link(k) != link(first)) {
          if (k - first > most) most = k - first, best = first + most / 2;
          first = k;
        }
      r.press(std::size_t(best));
      r.run(1.8);
      const View& v = r.view;
      std::printf(
          "%s, interface %.0f: %.0f cells, felt mass %.1f kg; peaks %.0f N, rigid %.0f N; gave way by %.0f "
          "mm\n",
          file, interface, v.cells, v.felt_mass, v.peak, v.rigid_peak, v.gave_way);
      CHECK(v.cells >= 60);
      CHECK(v.usable == v.cells);
      CHECK(v.rigid_peak > 90);
      CHECK(v.rigid_peak > 1.4 * v.peak);
      CHECK(v.gave_way > 15);
      CHECK(v.rigid_gave_way < 1);
      r.arms->release();
      r.run(sanitized ? 1 : 8);
      CHECK(v.ended == 0);
      if (!sanitized) CHECK_MESSAGE(v.away < 0.02, r.arms->words());
      if (skinctl::testing::allocations_are_counted()) CHECK(r.allocations == 0);
    }
  }
}

TEST_CASE("Playground: numbers of no robot are refused with their name") {
  const Robot good = robot_of("arm6.urdf");
  const double nan = std::nan("");
  const auto refused = [&](auto change, const char* what) {
    Robot r = good;
    change(r);
    INFO(std::string(what));
    try {
      make_arms(scenario(), {}, r);
      FAIL("taken");
    } catch (const skinctl::ConfigurationError& e) {
      CHECK_MESSAGE(std::string(e.what()).find(what) != std::string::npos, e.what());
    }
  };
  refused([&](Robot& r) { r.bodies = 65; }, "bodies of the robot");
  refused([&](Robot& r) { r.bodies = nan; }, "bodies of the robot");
  refused([&](Robot& r) { r.body[0].joint = 6; }, "joint of a body");
  refused([&](Robot& r) { r.body[0].mass = nan; }, "mass of a body");
  refused([&](Robot& r) { r.joint[2].place.axes[0] = 2; }, "placement");
  refused([&](Robot& r) { r.joint[2].place.origin[0] = nan; }, "reach of the robot");
  refused([&](Robot& r) { r.joint[3].lower = r.joint[3].upper + 1; }, "lower limit of a joint");
  refused([&](Robot& r) { r.joint[3].velocity = -1; }, "velocity of a joint");
  refused(
      [&](Robot& r) {
        for (auto& j : r.joint) j.place.origin[0] = j.place.origin[1] = j.place.origin[2] = 0;
        r.tip[2] = 0;
      },
      "reach of the robot");
  CHECK_THROWS_AS(make_arms(scenario(), {.feeling = 2}, good), skinctl::ConfigurationError);
  CHECK_THROWS_AS(make_arms(scenario(), {.interface = 2}, good), skinctl::ConfigurationError);
  // Without masses, without limits.
  Robot bare = good;
  bare.bodies = 0;
  for (auto& j : bare.joint) j.lower = j.upper = j.velocity = 0;
  Run r({}, bare);
  CHECK(r.view.felt_mass > 1);
}
