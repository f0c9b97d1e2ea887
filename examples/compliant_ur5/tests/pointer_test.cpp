// The pointer of a page on the simulated arm: what its messages do, and what they cannot do.
//
// Promise: whoever sees the page of a simulated run presses the arm, and nothing else
// Tried: a press on a cell, dragged, lifted, forgotten; a page that closes; 10 000 damaged messages; a press
// through the whole job by a page in Chromium Also: `examples/compliant_ur5/tests/pointer_in_browser.cpp`
#include "examples/compliant_ur5/pointer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "examples/compliant_ur5/recorder.hpp"
#include "examples/compliant_ur5/skin.hpp"

using namespace compliant_ur5;
using nlohmann::json;
using simulated_ur5::Controller;

namespace {

/// The simulated robot of a live run, moved by hand: powered, its scenario begun, nobody commands it.
struct Bench {
  explicit Bench(bool led = true) : robot(config(led)), pointer(robot, run_description(Settings{}).frames) {}
  static simulated_ur5::Config config(bool led) {
    simulated_ur5::Config c;
    c.controller.cells = simulated_cells(skin_patches(Settings{}));
    c.controller.powered = c.controller.scenario_at_boot = true;
    if (led) c.controller.touches.push_back(simulated_ur5::LedFinger::touch());
    return c;
  }
  /// Cell 145 of the forearm, in the frame that `/tf` calls forearm_link, which is the link's own.
  static json on_the_forearm(int press) {
    for (const auto& c : config(true).controller.cells)
      if (c.id == 145)
        return {{"press", press},
                {"link", "forearm_link"},
                {"point", {c.position.x, c.position.y, c.position.z}},
                {"normal", {c.normal.x, c.normal.y, c.normal.z}},
                {"stiffness", 3000},
                {"travel", 0.01},
                {"aside", {0, 0, 0}}};
    return {};
  }
  void steps(int cycles) {
    robot.call([&](Controller& c) {
      for (int k = 0; k < cycles; ++k) c.step();
    });
  }
  double force() {
    double f = 0;
    robot.call([&](Controller& c) { f = c.world().largest_force(); });
    return f;
  }
  simulated_ur5::TouchResult result() {
    simulated_ur5::TouchResult r;
    robot.call([&](Controller& c) { r = c.world().results().back(); });
    return r;
  }
  /// Half a second with a message every 24 ms.
  void led(const json& message) {
    for (int k = 0; k < 20; ++k) {
      REQUIRE(pointer.take(message.dump()).done);
      steps(3);
    }
  }

  simulated_ur5::SimulatedUr5 robot;
  Pointer pointer;
};

}  // namespace

TEST_CASE(
    "Pointer: presses where the page says, with the finger's spring, and leaves when it is let go or "
    "forgotten") {
  Bench b;
  b.led(Bench::on_the_forearm(5));
  CHECK(b.result().cell == 145);
  CHECK(std::stod(b.pointer.take(Bench::on_the_forearm(5).dump()).words) ==
        doctest::Approx(b.force()).epsilon(0.01));
  CHECK(b.force() > 20);  // 10 mm into a spring of 3000 N/m, before an arm that holds still
  CHECK(b.force() < 31);
  CHECK(b.pointer.take(R"({"press": 0})").done);
  b.steps(60);
  CHECK(b.force() == 0);
  // A page that falls silent is no finger that stays.
  b.led(Bench::on_the_forearm(6));
  CHECK(b.force() > 20);
  b.steps(125);
  CHECK(b.force() == 0);
  // One that is heard again presses again: a browser may draw a picture for longer than a finger waits.
  b.led(Bench::on_the_forearm(6));
  CHECK(b.force() > 20);
  // A page that is closed takes its finger along.
  const auto inlet = b.pointer.inlet();
  for (int k = 0; k < 20; ++k) {
    CHECK(inlet.take(Bench::on_the_forearm(7).dump()).done);
    b.steps(3);
  }
  CHECK(b.force() > 20);
  inlet.left();
  b.steps(60);
  CHECK(b.force() == 0);
}

TEST_CASE("Pointer: a frame that lies elsewhere on its link, and a drag to the side") {
  Bench b;
  // wrist_1_link lies d4 along the axis before the origin of the model's link.
  const auto cells = Bench::config(true).controller.cells;
  const auto cell = std::find_if(cells.begin(), cells.end(), [](const auto& c) { return c.link == 3; });
  REQUIRE(cell != cells.end());
  const auto &at = cell->position, &out = cell->normal;
  json m = Bench::on_the_forearm(1);
  m["link"] = "wrist_1_link", m["point"] = {at.x, at.y, at.z - skinctl::ur5::Description::d4};
  m["normal"] = {out.x, out.y, out.z};
  b.led(m);
  CHECK(b.result().cell == cell->id);
  CHECK(b.force() > 20);
  // The finger holds its surface while it is dragged, and slips off after 30 mm.
  m = Bench::on_the_forearm(2);
  m["aside"] = {0, 0, 0.3};
  b.led(Bench::on_the_forearm(2));
  CHECK(b.force() > 20);
  for (int k = 0; k < 4; ++k) b.led(m);
  CHECK(b.force() == 0);
}

TEST_CASE("Pointer: touches by the clock end with the first press") {
  auto c = Bench::config(true);
  simulated_ur5::Touch scripted;
  scripted.cell = 170, scripted.hold = 100;
  c.controller.touches.push_back(scripted);
  simulated_ur5::SimulatedUr5 robot(c);
  Pointer pointer(robot, run_description(Settings{}).frames);
  const auto force = [&](std::size_t i) {
    double f = 0;
    robot.call([&](Controller& u) {
      for (int k = 0; k < 3; ++k) u.step();
      f = u.world().force_on(i);
    });
    return f;
  };
  for (int k = 0; k < 40; ++k) force(1);
  CHECK(force(1) > 20);
  for (int k = 0; k < 20; ++k) {
    REQUIRE(pointer.take(Bench::on_the_forearm(1).dump()).done);
    CHECK(force(1) == 0);
  }
  CHECK(force(0) > 20);
}

TEST_CASE("Pointer: what is no finger does nothing") {
  Bench b;
  const json good = Bench::on_the_forearm(3);
  const auto refused = [&](const char* name, const json& value) {
    json m = good;
    m[name] = value;
    CAPTURE(name);
    CAPTURE(value.dump());
    CHECK_FALSE(b.pointer.take(m.dump()).done);
  };
  for (const char* name : {"press", "link", "point", "normal", "stiffness", "travel", "aside"}) {
    json m = good;
    m.erase(name);
    CHECK_FALSE(b.pointer.take(m.dump()).done);
    for (const json& value :
         {json(nullptr), json(true), json("7"), json(-1), json(1e300), json::array(), json::object(),
          json::array({0, 0}), json::array({0, "0", 0}), json::array({1e9, 0, 0})})
      refused(name, value);
  }
  refused("normal", {0, 0, 0});
  refused("link", "base_link");
  for (const char* text : {"", "{", "[]", "7", "null", "{\"press\": 1e999}"})
    CHECK_FALSE(b.pointer.take(text).done);
  b.steps(60);
  CHECK(b.force() == 0);
  CHECK_FALSE(b.result().began);
  // Damaged ones: refused, or a finger within what a finger can be.
  std::mt19937 random(11);
  const std::string text = good.dump();
  for (int k = 0; k < 10'000; ++k) {
    std::string m = text;
    for (unsigned n = 1 + random() % 4; n > 0; --n)
      m[random() % m.size()] = static_cast<char>(random() & 0xff);
    static_cast<void>(b.pointer.take(m));
    if (k % 50 == 0) b.steps(1);
  }
  CHECK(std::isfinite(b.force()));
  CHECK(b.force() < 1e5);
  // A robot without a led finger, as every run that no page shows.
  Bench without(false);
  CHECK(without.pointer.take(good.dump()).done);
  without.steps(60);
  CHECK(without.force() == 0);
}
