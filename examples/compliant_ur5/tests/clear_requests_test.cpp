// by night: beside clear_test.cpp
// The scene of `--clear` is stopped, resumed and loses its robot while something is close.
//
// Promise: a proximity sensor that is stuck moves an arm with --clear by 40 mm at most, and does not hold it
// Tried: one on the forearm, at 0.2 to 1, by position: the arm arrives at its goal
//
// Promise: a stop, a resume and a fault of an arm with --clear beside the table or a hand are calm
// Tried: 60 orders of stop, resume, states that are no numbers, a silent skin and a hand that comes and goes,
// at the table: no command beyond its limits, 20 mm are left, and the arm goes on at the end
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "examples/compliant_ur5/scene.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_ur5;
using namespace skinctl;

TEST_CASE("clear: stop, resume and faults beside the table and a hand, in any order") {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  read_scenario(s.scenario, s);
  s.keep_clear = s.trust_all_cells = true;  // these cells have no noise
  const auto scene = make_watched_scene<Interface::position, Sense::skin, true>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const OwnDistance distance(s);
  const auto limit = limits(s);
  std::vector<CellSample> samples;
  for (const auto& patch : skin_patches(s))
    for (const auto& cell : patch.cells) {
      CellSample sample;
      sample.cell = cell.id;
      const auto rest = static_cast<float>(s.rest_reading);
      sample.force = {rest, rest, rest};
      samples.push_back(sample);
    }
  const JointPosition<6> home(PerJoint{0.0, -1.2, 1.4, -1.8, -1.57, 0.3}),
      low(PerJoint{0.0, -0.3, 1.0, -1.8, -1.57, 0.3});
  std::mt19937 random(5);
  double least = 1e9, steepest = 0;
  int arrived = 0;
  const int orders = testing::sanitized ? 4 : 60;
  for (int order = 0; order < orders; ++order) {
    const auto memory = std::make_unique<typename Scene::Memory>();
    State<6> measured{1s, home, {}};
    scene.start(*memory, measured);
    JointVelocity<6> last;
    typename Scene::Output out;
    unsigned event = 0;
    for (int k = 0; k < 1700; ++k) {
      measured.time += 8ms;
      typename Scene::Input input;
      input.now = measured.time;
      input.measured = measured;
      if (k > 400 && k < 1200 && k % 40 == 0) event = static_cast<unsigned>(random() % 6);
      const bool first = k % 40 == 0;
      for (auto& sample : samples) sample.time = measured.time - 1ms;
      const bool silent = event == 3 && k % 40 < 30;
      if (!silent) input.samples = samples;
      input.around.time = input.now;
      if (k == 50) input.goal = typename Scene::Goal{.goal = JointGoal<6>{low, 2s}};
      if (first && event == 1) input.request = CycleRequest::stop;
      if (first && event == 2) input.request = CycleRequest::resume;
      if (event == 4 && k % 40 < 12)
        input.measured.q[random() % 6] = std::numeric_limits<double>::quiet_NaN();
      if (event == 5)  // a hand beside the forearm, 1 to 41 mm from it
        input.around.add({{{-0.45, 0.06 + 0.001 * (k % 40), 0.35}, {-0.45, 0.3, 0.35}, 0.02}, 0});
      if (k == 1200) event = 0;
      if (k == 1201) input.request = CycleRequest::resume;
      if (k == 1210) input.goal = typename Scene::Goal{.goal = JointGoal<6>{home, 3s}};
      out = scene.step(*memory, input);
      REQUIRE(out.command.valid);
      for (std::size_t i = 0; i < 6; ++i) {
        REQUIRE(std::isfinite(out.command.position[i]));
        steepest =
            std::max(steepest, std::abs(out.planned.velocity[i] - last[i]) / 0.008 / limit.acceleration()[i]);
      }
      last = out.planned.velocity;
      least = std::min(least, distance(out.command.position));
      measured.q = out.command.position;
      measured.dq = out.planned.velocity;
    }
    double away = 0;
    for (std::size_t i = 0; i < 6; ++i) away = std::max(away, std::abs(measured.q[i] - home[i]));
    arrived += away < 0.01;
  }
  MESSAGE(orders, " orders: ", 1000 * least, " mm are left, largest step ", 100 * steepest,
          " % of its limit, ", arrived, " arrive");
  CHECK(least > s.clear.margin - 1e-4);
  CHECK(steepest < 1 + 1e-6);
  CHECK(arrived == orders);
}

TEST_CASE("clear: a proximity sensor that is stuck moves the arm a little, and is found") {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  read_scenario(s.scenario, s);
  s.keep_clear = s.trust_all_cells = true;
  const auto scene = make_watched_scene<Interface::position, Sense::skin, true>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  std::vector<CellSample> samples;
  for (const auto& patch : skin_patches(s))
    for (const auto& cell : patch.cells) {
      CellSample sample;
      sample.cell = cell.id;
      samples.push_back(sample);
    }
  const JointPosition<6> home(PerJoint{0.0, -1.2, 1.4, -1.8, -1.57, 0.3}),
      there(PerJoint{0.5, -1.0, 1.2, -1.7, -1.57, 0.3});
  const auto places = scene.skin().places();
  const std::size_t stuck = scene.skin().index(170);
  const auto place = [&](const JointPosition<6>& q) {
    const auto X = link_poses(ur5::Model{}, q).get<2>();
    return Xyz<double>(X.origin() + X.axes() * places[stuck].place);
  };
  for (const float reading : {0.2f, 0.5f, 0.8f, 1.0f}) {
    Sight sight(s);
    const auto memory = std::make_unique<typename Scene::Memory>();
    State<6> measured{1s, home, {}};
    scene.start(*memory, measured);
    double way = 0, back = 0;
    for (int k = 0; k < 2500; ++k) {
      measured.time += 8ms;
      typename Scene::Input input;
      input.now = measured.time;
      input.measured = measured;
      for (auto& sample : samples) sample.time = measured.time - 1ms;
      samples[stuck].proximity = k > 100 ? reading : 0;
      input.samples = sight.foreign(measured.q, samples);
      input.around = sight.around(measured.q, [&](std::size_t i) {
        return scene.skin().held(memory->skin, i).proximity * CellCounts::proximity_unit;
      });
      input.around.time = input.now;
      if (k == 1200) input.goal = typename Scene::Goal{.goal = JointGoal<6>{there, 3s}};
      const auto out = scene.step(*memory, input);
      measured.q = out.command.position;
      measured.dq = out.planned.velocity;
      const double off = norm(Xyz<double>(place(measured.q) - place(home)));
      if (k < 1200) way = std::max(way, off), back = off;
    }
    double away = 0;
    for (std::size_t i = 0; i < 6; ++i) away = std::max(away, std::abs(measured.q[i] - there[i]));
    MESSAGE("stuck at ", reading, ": moves the arm by ", 1000 * way, " mm, ", 1000 * back, " mm after 9 s");
    CHECK(way < 0.04);
    CHECK(back < 0.04);
    CHECK(away < 0.02);
  }
}
