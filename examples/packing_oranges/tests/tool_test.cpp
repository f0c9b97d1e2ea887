// by night: runs of a minute
//
// Promise: a tool that a person used in a lesson is used by two arms in a world with forces: taken by its
// handle, led over the bread on the way that was shown, and put back; the bread is put on the plate
// Tried: a simulated person's sandwich, other places, pushes, UR5 and UR10e: tip within 10 mm of nine tenths
// of its way, in its order, tool and bread within 15 mm of where they were taught; a bread that a person
// moves before it is cut, a tool that slips out of the hand; six tasks that these arms cannot do

#include <doctest/doctest.h>

#include <functional>

#include "examples/packing_oranges/run.hpp"
#include "examples/packing_oranges/taught_plan.hpp"
#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/ur10e.hpp"
#include "examples/worlds/demonstrations.hpp"

using namespace packing;
using namespace skinctl;
namespace thing = skinctl::testing::thing;

namespace {
/// A sandwich that a simulated person makes, everything so much nearer to the arm that is led.
teach::NamedTask sandwich(std::uint64_t seed, double nearer) {
  auto random = testing::seeded(seed);
  const auto run = led_run(testing::LedTask::sandwich, testing::Person::any(random), seed * 10 + 1);
  auto shown_once = shown(run, {}, seed * 10 + 2);
  const Xyz<double> moved{-nearer, 0, 0};
  for (auto& x : shown_once.hand) x.X_WH = {x.X_WH.axes(), x.X_WH.origin() + moved};
  for (auto& x : shown_once.seen) x.X_WO = {x.X_WO.axes(), x.X_WO.origin() + moved};
  const auto found = learn<teach::max_steps>({shown_once}, testing::kitchen());
  REQUIRE(found.why == Refusal::none);
  const teach::Classes classes{{{thing::knife, "knife"}, {thing::bread, "bread"}, {thing::plate, "plate"}},
                               testing::kitchen().deeds.containers};
  return {found.task, classes, found.ways};
}
constexpr double nearer_to_ur5 = 0.2;
RunSettings settings(const teach::NamedTask& task, const HandRoom& room, std::uint64_t seed) {
  RunSettings s;
  s.work.plan = plan_of(task, room);
  s.seed = seed;
  s.touch_every = 8;
  return with_tool(s, task.ways);
}
void used_well(const Outcome& o) {
  CHECK(o.over);
  for (std::size_t a = 0; a < arms; ++a) {
    CAPTURE(a);
    CHECK(o.tool[a].share > 0.9);
    CHECK(o.tool[a].tool_off < 0.015);
    CHECK(o.tool[a].thing_off < 0.015);
    CHECK(o.tool[a].height > o.tool[a].taught_height - 0.03);
  }
  CHECK(o.worst_grip() < 12);
}
}  // namespace

TEST_CASE("Kitchen: a stroke that is left out, and a way beside, count less") {
  const auto strokes = [](int count, double beside) {
    std::vector<Xyz<double>> out;
    for (int i = 0; i < 40 * count; ++i) {
      const double angle = 2 * M_PI * i / 40;
      out.push_back({0.05 * std::sin(angle), beside, 0.12 + 0.012 * std::cos(angle)});
    }
    return out;
  };
  const auto taught = strokes(4, 0);
  const auto share = [&](const std::vector<Xyz<double>>& went) {
    return static_cast<double>(followed(taught, went, ToolOutcome::tip_within).size()) /
           static_cast<double>(taught.size());
  };
  CHECK(share(taught) == 1);
  CHECK(share(strokes(4, 0.009)) == 1);
  CHECK(share(strokes(4, 0.011)) == 0);
  CHECK(share(strokes(5, 0)) == 1);
  CHECK(share(strokes(3, 0)) < 0.85);
  CHECK(share(strokes(2, 0)) < 0.65);
  CHECK(share({}) == 0);
}

TEST_CASE("packing_oranges --task: a knife is used over bread as it was shown, and put back") {
  used_well(run_ur5(settings(sandwich(4, nearer_to_ur5), Ur5::room, 31)));
  used_well(run_ur10e(settings(sandwich(5, 0), Ur10e::room, 32)));
}

TEST_CASE("packing_oranges --task: a bread that a person moves is found again before the knife is used") {
  RunSettings s = settings(sandwich(6, nearer_to_ur5), Ur5::room, 33);
  s.move_box = 0.1;
  const Outcome o = run_ur5(s);
  CHECK(o.tool[0].moved + o.tool[1].moved >= 1);
  used_well(o);
}

TEST_CASE("packing_oranges --task: a knife that slips out of the hand is asked for, and taken again") {
  RunSettings s = settings(sandwich(7, nearer_to_ur5), Ur5::room, 34);
  s.fault = packing::Fault::slip;
  s.fault_at = 5;
  const Outcome o = run_ur5(s);
  int back = 0;
  for (const Done& d : o.arm[0].done) back += d.back;
  CHECK(back >= 1);
  CHECK(o.arm[0].asked == 1);
  CHECK(o.over);
  CHECK(o.tool[0].lost() == 0);
  CHECK(o.tool[0].share > 0.9);
}

TEST_CASE("packing_oranges --task: what a task asks of a tool and these arms cannot do has words") {
  const teach::NamedTask good = sandwich(4, nearer_to_ur5);
  const auto refused = [](const teach::NamedTask& task) -> std::string {
    try {
      static_cast<void>(plan_of(task, Ur5::room));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  REQUIRE(refused(good).empty());
  const auto says = [&](const std::function<void(teach::NamedTask&)>& change, const std::string& why) {
    teach::NamedTask task = good;
    change(task);
    CHECK_MESSAGE(refused(task).find(why) != std::string::npos, refused(task));
  };
  constexpr std::size_t take = 0, use = 1, put_back = 2;  // places of the task
  const auto move = [](std::size_t place, double x, double y, double z) {
    return [=](teach::NamedTask& n) {
      n.task.places[place].X_MH = Transform<ObjectFrame, Tool>::translation_xyz(x, y, z);
    };
  };
  CHECK(refused(sandwich(4, 0)).find("out of reach") != std::string::npos);
  says([](auto& n) { n.classes.names[thing::bread] = "cake"; }, "its place is beside a cake");
  says([](auto& n) { n.ways = {}; }, "learn it anew");
  says(move(use, 0, 0, 0.03), "nothing is cut here");
  says(move(take, 0, 0.05, 0), "from the middle of what it takes");
  says(move(put_back, 0.4, 0.1, 0.03), "the other arm's here");
  RunSettings s = settings(good, Ur5::room, 1);
  s.hand = {true, true};
  CHECK_THROWS_WITH_AS(static_cast<void>(with_tool(s, good.ways)), doctest::Contains("hold no handle"),
                       std::runtime_error);
}
