// Everything that can happen between the main job and its robot: what it does, how soon the arm rests, and
// how it ends.
//
// Promise: whatever happens between the main job and its robot, the arm rests in the time that its table
// states, and the exit code and words tell why
// Tried: 26 disturbances by position and velocity: paused, slider at 0, stops, NaN, clocks that stand, go
// back or run wrong, a stuck joint, 92 ms of lag, cables out, half open, reset, garbled, truncated, lost,
// repeated, reordered, 250 ms without a state (by torque as well), 20 and 3 ms more each way; 0.1 to 1.7 s to
// rest

#include "examples/simulated_ur5/faults.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <functional>

#include "examples/compliant_ur5/tests/disturbed.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/by_day.hpp"

using namespace compliant_ur5;
using simulated_ur5::FaultyWire;
namespace change = simulated_ur5::change;
using Cable = FaultyWire::Cable;
using skinctl::Interface;

namespace {

using Run = Disturbed;
struct Case {
  const char* name;
  std::function<void(Run&)> disturb;
  int exit;
  double rest;  ///< at most [ms]; 0: the job goes on to its end
  const char* words;
};

void check(const std::vector<Case>& cases, std::size_t together = skinctl::testing::sanitized ? 2 : 4,
           const std::vector<Interface>& interfaces = {Interface::position, Interface::velocity}) {
  std::vector<std::pair<Interface, const Case*>> all;
  // By day and under the sanitizers the interfaces take turns: a fault meets the same code on either way.
  for (const Case& c : cases)
    for (const Interface i : interfaces)
      if (!(skinctl::testing::sanitized || skinctl::testing::by_day) ||
          (&c - cases.data()) % 2 == static_cast<int>(i == Interface::velocity))
        all.emplace_back(i, &c);
  // Several at a time: they wait for clocks, not for the processor.
  std::vector<std::unique_ptr<Run>> runs(all.size());
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < std::min(together, all.size()); ++k)
    threads.emplace_back([&] {
      for (std::size_t i; (i = next++) < all.size();)
        for (int tries = 0; tries < 3 && !(runs[i] && runs[i]->begun); ++tries) {
          if (runs[i]) std::printf("again, it ended before the fault: %s\n", runs[i]->words.c_str());
          runs[i].reset();
          runs[i] = std::make_unique<Run>(all[i].first, all[i].second->disturb);
        }
    });
  for (auto& t : threads) t.join();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Run& r = *runs[i];
    const Case& c = *all[i].second;
    const char* by = all[i].first == Interface::position   ? "position"
                     : all[i].first == Interface::velocity ? "velocity"
                                                           : "torque";
    std::printf("| %s | %s | %d | %.0f ms, %.3f rad | %.0f ms | %s |\n", c.name, by, r.exit, r.rest, r.went,
                r.took, r.words.c_str());
    std::fflush(stdout);
    CAPTURE(c.name);
    CAPTURE(by);
    CAPTURE(r.words);
    CHECK(r.begun);
    CHECK(r.exit == c.exit);
    CHECK(r.rest >= 0);
    if (c.rest > 0) CHECK(r.rest <= c.rest);
    CHECK(r.words.find(c.words) != std::string::npos);
  }
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("main job: a robot that is halted by others ends it with words and code 5") {
  check({
      {"paused at the panel", [](Run& r) { r.beside.robot->call([](auto& c) { c.pause(); }); }, 5, 1000,
       "paused"},
      {"program stopped at the panel",
       [](Run& r) { r.beside.robot->call([](auto& c) { c.stop_program(); }); }, 5, 1000, "has ended"},
      {"speed slider to 0",
       [](Run& r) {
         r.beside.robot->call([](auto& c) {
           c.inputs().speed_slider_mask = 1;
           c.inputs().speed_slider_fraction = 0;
           c.inputs_written({.slider = true});
         });
       },
       5, 1100, "speed slider"},
      {"program replaced by another",
       [](Run& r) { r.beside.robot->call([](auto& c) { c.run("def other():\n  sleep(20)\nend\n"); }); }, 5,
       1000, "another program plays in its place"},
      {"protective stop", [](Run& r) { r.beside.robot->call([](auto& c) { c.protective_stop("a test"); }); },
       5, 500, "protective stop: "},
      {"emergency stop", [](Run& r) { r.beside.robot->call([](auto& c) { c.emergency_stop(); }); }, 5, 500,
       "safety"},
  });
}

TEST_CASE("main job: a slider that slows the robot is named where a joint does not follow") {
  check({{"speed slider to 20 %",
          [](Run& r) {
            r.beside.robot->call([](auto& c) {
              c.inputs().speed_slider_mask = 1;
              c.inputs().speed_slider_fraction = 0.2;
              c.inputs_written({.slider = true});
            });
          },
          6, 0, "the speed slider stands at 20 %"}});
}

TEST_CASE("main job: states that cannot be end it with words and code 7") {
  check({
      {"joint 3 is NaN", [](Run& r) { r.rtde.set(change::not_a_number(2)); }, 7, 1000, "no numbers"},
      {"the robot's clock stands", [](Run& r) { r.rtde.set(change::frozen_clock()); }, 7, 1200, "clock"},
      {"the robot's clock goes back 5 s", [](Run& r) { r.rtde.set(change::clock_back(5)); }, 7, 1200,
       "clock"},
      {"the robot's clock runs at a third", [](Run& r) { r.rtde.set(change::clock_rate(0.3)); }, 7, 3400,
       "clock"},
  });
}

TEST_CASE("main job: a joint that does not follow, or an arm that follows late, ends it with code 6") {
  check({
      {"joint 2 reports to stand still", [](Run& r) { r.rtde.set(change::stuck(1)); }, 6, 2500, "joint 2"},
      {"states are 92 ms late", [](Run& r) { r.rtde.set(change::late(11)); }, 6, 3500, "later than declared"},
  });
}

TEST_CASE("main job: a connection that is lost in any way ends it with code 1") {
  check({
      {"cable out",
       [](Run& r) {
         r.rtde.set(Cable::cut);
         r.reverse.set(Cable::cut);
       },
       1, 1200, "no state"},
      {"states: half open", [](Run& r) { r.rtde.set(Cable::to_robot); }, 1, 1200, "no state"},
      {"commands: half open", [](Run& r) { r.reverse.set(Cable::to_robot); }, 5, 1000, "has ended"},
      {"commands: reset", [](Run& r) { r.reverse.set(Cable::reset); }, 5, 1000, "ended"},
      {"states: reset", [](Run& r) { r.rtde.set(Cable::reset); }, 1, 1000, "closed"},
      {"garbled states", [](Run& r) { r.rtde.set(change::garbled()); }, 1, 1200, "nonsense"},
      {"truncated states", [](Run& r) { r.rtde.set(change::truncated(9)); }, 1, 1200, "nonsense"},
      {"half of the states, then none",
       [](Run& r) {
         r.rtde.set(change::lost(0.5));
         std::this_thread::sleep_for(std::chrono::milliseconds(300));
         r.rtde.set(change::lost(1));
       },
       1, 1500, "no state"},
  });
}

TEST_CASE(
    "main job: what TCP may do with bytes, repeated and reordered states, and lost ones do not end it") {
  check(
      {
          {"byte by byte", [](Run& r) { r.rtde.set_pieces(1, 0); }, 0, 0, ""},
          {"every state twice", [](Run& r) { r.rtde.set(change::repeated()); }, 0, 0, ""},
          {"states out of order", [](Run& r) { r.rtde.set(change::reordered()); }, 0, 0, ""},
          {"a tenth of the states is lost", [](Run& r) { r.rtde.set(change::lost(0.1)); }, 0, 0, ""},
      },
      skinctl::testing::sanitized ? 2 : 4);
}

TEST_CASE("main job: states that wait 250 ms for a lost packet do not end it, by torque neither") {
  check({{"states stall for 250 ms", [](Run& r) { r.rtde.set(change::stalled(0.25)); }, 0, 0, ""}},
        skinctl::testing::sanitized ? 2 : 3, {Interface::position, Interface::velocity, Interface::torque});
}

TEST_CASE("main job: a way to the robot that becomes longer than it was ends it with code 6") {
  const auto longer = [](int ms) {
    return [ms](Run& r) {
      r.rtde.set_delay(ms);
      r.reverse.set_delay(ms);
    };
  };
  check(
      {
          {"20 ms more each way", longer(20), 6, 2000, "the way to the robot and back has become longer"},
          {"3 ms more each way", longer(3), 0, 0, ""},
      },
      skinctl::testing::sanitized ? 2 : 4);
}

TEST_SUITE_END();
