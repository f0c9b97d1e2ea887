// not sanitized: the main job's test runs the same scene, and tests/passivity/ the touched arm
// by night: the same, and this file alone compiles the scene once more
// The main job's gains against what is stiff: the finger that pressed is held, and the arm comes to rest.
#include <doctest/doctest.h>

#include "examples/compliant_ur5/scene.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "tests/support/touched_arm.hpp"

using namespace compliant_ur5;
using namespace skinctl;
using namespace skinctl::testing;

namespace {

Settings settings() {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  read_scenario(s.scenario, s);
  s.trust_all_cells = true;  // one cell alone feels here what a hand would press on several
  return s;
}

struct Held {
  double peak = 0, low = 1e9, high = 0;  ///< [N]; the last two over the last two seconds
};

/// Something of `stiffness` comes up against a cell of link `I` at 6 cm/s, goes 20 mm further and stays.
template <std::size_t I>
Held held(const Settings& s, double stiffness) {
  const auto scene = make_scene<Interface::position>(s);
  const auto patches = ur5::skin_patches<compliant_ur5::cells>();
  const auto& patch = std::get<I>(patches);
  // All of them report: silent ones would be filled in from the one that is pressed.
  std::vector<PlacedCell<I>> cells;
  for (const auto& one : patch.placed()) cells.push_back(one);
  const std::size_t pressed = cells.size() / 2;
  TouchedArm<I, std::remove_cv_t<decltype(scene)>> arm(scene, cells, {0, -1.2, 1.4, -1.8, -1.57, 0.3}, 0.008,
                                                       0.008, s.newtons_per_reading);
  Held out;
  while (arm.time() < 8) {
    arm.step(8ms, [&](std::size_t k, const CellAt& at) {
      if (k != pressed) return CellTouch{};
      return CellTouch{.force = std::max(0.0, stiffness * (std::min(0.02, 0.06 * at.time) + at.out))};
    });
    out.peak = std::max(out.peak, arm.force[pressed]);
    if (arm.time() < 6) continue;
    out.low = std::min(out.low, arm.force[pressed]);
    out.high = std::max(out.high, arm.force[pressed]);
  }
  return out;
}

}  // namespace

TEST_CASE("Main job: what is held against the arm comes to rest, up to the stiffness that it declares") {
  const auto s = settings();
  CHECK(s.control.stiffest_wall >= 3e3);
  const auto rests = [&](const Held& h) {
    CAPTURE(h.low);
    CAPTURE(h.high);
    CHECK(h.low > 1);
    CHECK(h.high - h.low < std::max(0.1 * h.high, 2.0));
  };
  for (const double stiffness : {3e2, 1e3, 3e3}) {
    CAPTURE(stiffness);
    rests(held<1>(s, stiffness));
    rests(held<2>(s, stiffness));
    rests(held<4>(s, stiffness));
    rests(held<5>(s, stiffness));
  }
}

TEST_CASE(
    "Main job: four times the newtons a reading make it four times heavier, and an arm that must be light is "
    "refused") {
  auto s = settings();
  const double before = heavier<Interface::position>(s);
  CHECK(before > 3);
  for (double& gain : s.control.force_gain) gain *= 4;
  CHECK(heavier<Interface::position>(s) > 3.5 * before);  // and its friction is felt less
  const auto arm = by_position(ur5::Model{}, configuration<Interface::position>(s), hardest_finger(s));
  CHECK_THROWS_WITH_AS(
      static_cast<void>(Cycle(arm, UrSkin(skin_patches(s), {}), SkinJointControl{} + GravityControl{})),
      doctest::Contains("felt mass beside that of a wall = 1, allowed: >= "), ConfigurationError);
}
