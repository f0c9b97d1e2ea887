// by night: takes minutes; its parts are tried in tests/clearance/ and tests/limits/
// The main job with `--clear`: how near its links come to each other and to the table, and what a hand meets.
//
// Promise: the main job with --clear stops before its own links and the table, and gives way to a hand before
// it touches
// Tried: goals that fold it, goals into the table, a push towards the table, by position, velocity and
// torque: 20 mm are left, distances found by search; a hand at 6 to 25 cm/s, and one that stays 14 s; all
// cells silent while it stands at the margin
#include "examples/compliant_ur5/clear.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "examples/compliant_ur5/fault_runs.hpp"
#include "examples/compliant_ur5/noted.hpp"
#include "examples/compliant_ur5/tests/beside.hpp"
#include "examples/simulated_ur5/geometry.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_ur5;
using simulated_ur5::Joints;
using simulated_ur5::Vec3;
using skinctl::Interface;

namespace {

struct Tube {
  Vec3 from, to;
  double radius = 0;
};
Vec3 of(const skinctl::Xyz<double>& p) {
  return {p.x, p.y, p.z};
}
double apart(Vec3 p, const Tube& b) {
  const Vec3 along = b.to - b.from;
  const double most = dot(along, along), t = most > 0 ? dot(p - b.from, along) / most : 0;
  return norm(p - b.from - std::clamp(t, 0.0, 1.0) * along) - b.radius;
}
/// The least distance of two tubes with round ends, by search: it is convex along a segment.
double apart(const Tube& a, const Tube& b) {
  double low = 0, high = 1;
  const auto at = [&](double s) { return apart(a.from + s * (a.to - a.from), b) - a.radius; };
  for (int k = 0; k < 80; ++k) {
    const double one = low + (high - low) / 3, two = high - (high - low) / 3;
    (at(one) < at(two) ? high : low) = at(one) < at(two) ? two : one;
  }
  return at(0.5 * (low + high));
}
/// The least distance at `q` of the links from each other, of the base and of a plane at z = 0, without the
/// library.
double least_distance(const std::array<float, 6>& joints) {
  Joints q{};
  std::copy(joints.begin(), joints.end(), q.begin());
  const auto links = simulated_ur5::forward_kinematics(q);
  std::array<Tube, 6> tube;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& t = skinctl::ur5::tubes[i];
    const double shorter = i == 3 || i == 4 ? 0.03 : 0;
    tube[i] = {links.link[i].point(of(t.from)), links.link[i].point(of(t.to) - Vec3{0, 0, shorter}),
               t.radius};
  }
  const Tube base{{0, 0, 0}, {0, 0, 0.03}, 0.075};
  double least = 1e9;
  for (std::size_t i = 0; i < 6; ++i) {
    if (i > 0) least = std::min(least, std::min(tube[i].from.z, tube[i].to.z) - tube[i].radius);
    if (i > 1) least = std::min(least, apart(tube[i], base));
    // Housings of a wrist that always lie side by side.
    for (std::size_t k = i + 2; k < 6; ++k)
      if (!(i == 2 && k == 4) && !(i == 3 && k == 5) && !(i == 0 && k == 4))
        least = std::min(least, apart(tube[i], tube[k]));
  }
  return least;
}
double least_distance(const RunLog& log, double from = 0) {
  double least = 1e9;
  for (const LogEntry& e : log.entries)
    if (e.time >= from) least = std::min(least, least_distance(e.q));
  return least;
}
/// The fastest joint between two instants, over 50 ms, as encoders are noisy [rad/s].
double fastest(const RunLog& log, double from, double to = 1e9) {
  double most = 0;
  std::size_t before = 0;
  for (const LogEntry& b : log.entries) {
    while (log.entries[before].time < b.time - 0.05) ++before;
    const LogEntry& a = log.entries[before];
    if (a.time < from || b.time > to || !(b.time > a.time + 0.03)) continue;
    for (std::size_t i = 0; i < 6; ++i)
      most = std::max(most, std::abs(double(b.q[i]) - double(a.q[i])) / (b.time - a.time));
  }
  return most;
}

struct Course {
  std::string more{};  ///< tables of the scenario
  std::string skin{};  ///< lines of its [skin]
  std::vector<Goal> task{};
  double duration = 5;  ///< [s]
  Interface interface = Interface::position;
  std::string faults{};
  double proximity_share = 0.5;
};
RunLog course(const Course& c, bool clear, Outcome expected = Outcome::fine) {
  std::ostringstream text;
  text << std::ifstream(COMPLIANT_UR5_SCENARIO).rdbuf();
  std::string scenario = text.str();
  scenario.resize(scenario.find("[[goal]]"));
  scenario.insert(scenario.find("[skin]\n") + 7, c.skin);
  const auto file =
      std::filesystem::temp_directory_path() / ("skinctl_clear_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << scenario + c.more;
  Settings s;
  s.scenario = file.string();
  read_scenario(s.scenario, s);
  s.quiet = true;
  s.clear.proximity_share = c.proximity_share;
  s.task = c.task;
  s.interface = c.interface;
  s.rate = c.interface == Interface::torque ? 500 : 125;
  s.cycles = static_cast<std::uint64_t>(c.duration * s.rate);
  s.keep_clear = clear;
  s.skin_faults = c.faults;
  RunLog log;
  const Outcome outcome = run(s, false, log);
  CHECK_MESSAGE(outcome == expected, log.words);
  std::filesystem::remove(file);
  return log;
}
std::vector<Goal> goal(double elbow, double shoulder = -1.2) {
  return {{.at = 0.8, .q = {0, shoulder, elbow, -1.8, -1.57, 0.3}, .duration = 2.5}};
}
std::string finger(int cell, double start, double speed, const char* more = "") {
  return "[[touch]]\ncell = " + std::to_string(cell) + skinctl::formatted("\nstart = %g", start) +
         skinctl::formatted("\napproach_speed = %g", speed) +
         "\nstiffness = 3000\ndamping = 20\ntremor = 0.02\ngap = 0.25\ntravel = 0.03\nhold = 1\n" + more;
}
std::string in_words(Interface i) {
  return i == Interface::position ? "position" : i == Interface::velocity ? "velocity" : "torque";
}
constexpr std::array by_all{Interface::position, Interface::velocity, Interface::torque};
constexpr double least_margin = 0.0185;  ///< 20 mm, less encoders' noise and what the drives overshoot [m]

}  // namespace

TEST_CASE(
    "clear: goals that fold the arm, or lead into the table, end 20 mm before; without --clear inside") {
  for (const Interface interface : by_all) {
    CAPTURE(in_words(interface));
    for (const auto& [name, task] :
         {std::pair<std::string, std::vector<Goal>>{"folds", goal(2.75)},
          std::pair<std::string, std::vector<Goal>>{"into the table", goal(1.0, -0.3)}}) {
      const Course c{.task = task, .duration = 6, .interface = interface};
      const RunLog kept = course(c, true), bare = course(c, false);
      const double least = least_distance(kept), inside = least_distance(bare);
      MESSAGE(in_words(interface), ", ", name, ": ", 1000 * least, " mm are left; without --clear ",
              1000 * inside);
      CHECK(least > least_margin);
      CHECK(least < 0.03);  // it goes there
      CHECK(inside < 0);
      CHECK(has_noted(kept, skinctl::Reason::clearance_kept));
      CHECK(fastest(kept, 5) < 0.1);  // and creeps along the margin at most
    }
    if (skinctl::testing::sanitized) break;
  }
}

TEST_CASE("clear: a push towards the table moves the arm no nearer than 20 mm") {
  const std::string low =
      "[[touch]]\nname = \"from above\"\ncell = 190\nstart = 2.6\nstiffness = 1000\ndamping = 20\n"
      "tremor = 0.02\napproach_speed = 0.1\ntravel = 0.3\nhold = 2\nreach = 0.3\n";
  // The elbow is low, and the wrist stands up.
  Course c{.more = low,
           .task = {{.at = 0.1, .q = {0, -0.35, 0.55, -1.8, -1.57, 0.3}, .duration = 2}},
           .duration = 8};
  for (const Interface interface : {Interface::position, Interface::velocity}) {
    c.interface = interface;
    const RunLog kept = course(c, true), bare = course(c, false);
    MESSAGE(in_words(interface), ": ", 1000 * least_distance(kept), " mm are left; without --clear ",
            1000 * least_distance(bare));
    CHECK(least_distance(kept) > least_margin);
    CHECK(least_distance(bare) < least_margin);
    if (skinctl::testing::sanitized) break;
  }
}

TEST_CASE("clear: a hand that comes meets less, or nothing; what no cell sees meets the same") {
  const auto force = [](const RunLog& log) { return log.peak_force; };
  for (const Interface interface : by_all) {
    for (const double speed : {0.06, 0.15, 0.25}) {
      if (interface != Interface::position && speed != 0.15) continue;
      Course c{.more = finger(170, 1, speed), .skin = "proximity_distance = 0.03\n", .interface = interface};
      c.duration = 2.5 + 0.28 / speed;
      const double with = force(course(c, true)), without = force(course(c, false));
      MESSAGE(in_words(interface), ", ", 100 * speed, " cm/s: ", with, " N, without --clear ", without);
      CHECK(with < (interface == Interface::torque ? 0.9 : 0.75) * without);
      if (speed < 0.1) CHECK(with == 0);
      if (skinctl::testing::sanitized) return;
    }
  }
  const Course unseen{.more = finger(170, 1, 0.06),
                      .skin = "proximity_distance = 1e-4\n",
                      .duration = 12,
                      .proximity_share = 0};
  const RunLog kept = course(unseen, true), bare = course(unseen, false);
  REQUIRE(kept.touches.size() == 1);
  REQUIRE(bare.touches.size() == 1);
  CHECK(kept.peak_force == doctest::Approx(bare.peak_force).epsilon(0.05));
  CHECK(kept.touches[0].deflection == doctest::Approx(bare.touches[0].deflection).epsilon(0.05));
  CHECK(std::abs(kept.touches[0].return_error - bare.touches[0].return_error) < 0.002);
}

TEST_CASE(
    "clear: a hand that stays near is kept off without trembling, and the arm comes back when it has left") {
  for (const Interface interface : {Interface::position, Interface::torque}) {
    const Course c{
        .more = finger(170, 1, 0.06, "").replace(finger(170, 1, 0.06).find("hold = 1"), 8, "hold = 14"),
        .skin = "proximity_distance = 0.03\n",
        .duration = 29,  // the same reading counts for 10 s
        .interface = interface};
    const RunLog log = course(c, true);
    CAPTURE(in_words(interface));
    MESSAGE(in_words(interface), ": beside its task by ", log.entries.back().deflection,
            " rad at the end, force ", log.peak_force);
    CHECK(log.entries.back().deflection < 0.005);
    CHECK(log.peak_force < 3);  // a brush; 25 to 28 N without --clear
    const double fast = fastest(log, 8.5, 10.5);
    MESSAGE("fastest joint beside a hand that stays: ", fast, " rad/s");
    CHECK(fast < 0.02);
    if (skinctl::testing::sanitized) break;
  }
}

TEST_CASE("clear: an untouched arm goes the same way") {
  for (const Interface interface : by_all) {
    const Course c{.task = goal(1.2, -1.0), .duration = 5, .interface = interface};
    CHECK(farthest_apart(course(c, true), course(c, false)) < 1e-3);
    if (skinctl::testing::sanitized) break;
  }
}

TEST_CASE("clear: a skin that falls silent while the arm stands at the table ends it calmly") {
  for (const Interface interface : by_all) {
    const RunLog log =
        course({.task = goal(1.0, -0.3), .duration = 6, .interface = interface, .faults = "unheard:100%@4"},
               true, Outcome::blind);
    CAPTURE(in_words(interface));
    CHECK(least_distance(log) > least_margin);
    CHECK(fastest(log, 3.9) < 0.3);
    CHECK(fastest(log, 4.4) < 0.01);
    if (skinctl::testing::sanitized) break;
  }
}

TEST_CASE(
    "clear: what the cells see of the arm itself and of the table is taken out, and what is nearer is left") {
  Settings s = settings();
  s.keep_clear = true;
  Sight sight(s);
  const UrSkin skin(skin_patches(s), {});
  const auto places = skin.places();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  std::size_t own = 0, near = 0;
  const OwnDistance distance(s);
  for (int n = 0; n < 300;) {
    skinctl::JointPosition<6> q;
    Joints joints{};
    for (std::size_t i = 0; i < 6; ++i) joints[i] = q[i] = angle(random);
    if (distance(q) < s.clear.margin) continue;
    ++n;
    const auto links = simulated_ur5::forward_kinematics(joints);
    std::vector<skinctl::CellSample> samples;
    std::vector<double> seen;
    for (std::size_t i = 0; i < places.size(); ++i) {
      // Along its normal in steps, against each other link's tube within its ends, and the table.
      const Vec3 from = links.link[places[i].link].point(of(places[i].place));
      const Vec3 n_B = links.link[places[i].link].rotate(of(places[i].normal));
      double found = 1;
      for (double d = 0; d < 0.06 && found == 1; d += 0.002) {
        const Vec3 p = from + d * n_B;
        if (p.z < 0) found = d;
        for (std::size_t l = 0; l < 6; ++l) {
          const auto& t = skinctl::ur5::tubes[l];
          const Vec3 local = links.link[l].point_back(p), way = of(t.to) - of(t.from);
          const double along = dot(local - of(t.from), way) / dot(way, way);
          if (l != places[i].link && along > 0.25 && along < 0.75 &&
              norm(local - of(t.from) - along * way) < t.radius)
            found = d;
        }
      }
      seen.push_back(found);
      skinctl::CellSample sample;
      sample.cell = skin_patches(s)[0].cells[0].id;
      samples.push_back(sample);
    }
    std::size_t i = 0;
    for (const auto& patch : skin_patches(s))
      for (const auto& cell : patch.cells) {
        samples[i].cell = cell.id;
        samples[i].proximity = static_cast<float>(seen[i] < 1 ? reading_of(s.clear, seen[i]) : 0);
        ++i;
      }
    const auto left = sight.foreign(q, samples);
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!(samples[k].proximity > 0.05f)) continue;
      ++own;
      CAPTURE(k);
      CHECK(left[k].proximity == 0);
    }
    // A hand right before each cell: seen by all that do not look into the arm itself.
    for (auto& sample : samples) sample.proximity = 0.9f;
    Sight anew(s);
    const auto hand = anew.foreign(q, samples);
    for (std::size_t k = 0; k < places.size(); ++k) near += hand[k].proximity > 0.8f;
  }
  MESSAGE(own, " readings of the arm itself; a hand is seen by ", near / 300, " of ", places.size(),
          " cells");
  CHECK(own > 1000);
  CHECK(near > 300 * places.size() * 7 / 10);
}

TEST_CASE("clear: a reading becomes a distance and a distance a reading; settings out of range are refused") {
  ClearSettings c;
  for (const double d : {0.0, 1e-3, 0.01, 0.04})
    CHECK(distance_of(c, reading_of(c, d)) == doctest::Approx(d));
  CHECK(distance_of(c, 1) == 0);
  Settings s = settings();
  s.keep_clear = true;
  RunLog log;
  const auto refused = [&](auto change, const char* words) {
    Settings wrong = s;
    change(wrong);
    CHECK_THROWS_WITH_AS(static_cast<void>(run(wrong, false, log)), doctest::Contains(words),
                         skinctl::ConfigurationError);
  };
  refused([](Settings& w) { w.clear.proximity_share = 0.7; },
          "clear.proximity_share = 0.7, allowed: 0 to 0.577");
  refused([](Settings& w) { w.clear.table = 2; }, "clear.table = 2");
  refused([](Settings& w) { w.clear.margin = -1; }, "margin = -1");
  refused([](Settings& w) { w.clear.tool_length = 3; }, "clear.tool_length = 3");
  refused([](Settings& w) { w.clear.approach = -1; }, "clear.approach = -1");
  refused([](Settings& w) { w.sense = Sense::motors; }, "--clear sees by the skin");
}

TEST_CASE("clear: a recording with things seen replays bit for bit, and not without --clear") {
  Settings s = settings();
  s.keep_clear = true;
  s.cycles = 600;
  s.record =
      (std::filesystem::temp_directory_path() / ("skinctl_clear_" + std::to_string(getpid()) + ".mcap"))
          .string();
  RunLog log;
  REQUIRE(run(s, false, log) == Outcome::fine);
  s.replay = std::exchange(s.record, {});
  CHECK(replay(s) == Outcome::fine);
  s.keep_clear = false;
  CHECK_THROWS_AS(static_cast<void>(replay(s)), skinctl::ConfigurationError);
  std::filesystem::remove(s.replay);
}
