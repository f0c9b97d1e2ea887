// The primary and realtime ports against the layouts of the makers' client-interface guide: raw bytes only.
//
// Promise: clients that nobody here wrote find the UR5 they know: layouts of the primary and realtime
// ports, the dashboard's lines, a URScript as large as the makers' external control
// Tried: sizes and fields of the guide on both generations; a 44 kB program with three sockets, threads,
// servoj, speedj, torques, points, splines, and a commander that falls silent; 250 kB of nested text of
// 19 kinds in 0.1 s of processor time each. Also: `examples/simulated_ur5/tests/`

#include <doctest/doctest.h>

#include <map>

#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

using namespace simulated_ur5;

namespace {

Config config(Series series, bool powered = true) {
  Config c;
  c.ports = {0, 0, 0, 0, 0};
  c.controller.series = series;
  c.controller.powered = powered;
  c.controller.power_on_time = 0.2;
  c.controller.brake_release_time = 0.1;
  return c;
}

struct Message {
  int type = 0;
  raw::Bytes body;  ///< behind size and type
};
Message next(raw::Tcp& tcp) {
  const raw::Bytes head = tcp.exactly(5);
  const std::size_t size = raw::take(head, 0, 4);
  if (size < 5 || size > 4096) throw std::runtime_error("size of a message");
  return {head[4], tcp.exactly(size - 5)};
}

/// Sub-packages of a robot state message by type, their heads left out.
std::map<int, raw::Bytes> parts(const Message& state) {
  std::map<int, raw::Bytes> out;
  for (std::size_t at = 0; at < state.body.size();) {
    const std::size_t size = raw::take(state.body, at, 4);
    REQUIRE(size >= 5);
    REQUIRE(at + size <= state.body.size());
    CHECK(out.count(state.body[at + 4]) == 0);
    out[state.body[at + 4]] = raw::Bytes(state.body.begin() + static_cast<std::ptrdiff_t>(at + 5),
                                         state.body.begin() + static_cast<std::ptrdiff_t>(at + size));
    at += size;
  }
  return out;
}

/// A robot message: 8 bytes of time, source, kind, then what belongs to the kind.
struct Event {
  int kind = -1;
  raw::Bytes rest;
  std::string text(std::size_t from) const {
    return std::string(rest.begin() + static_cast<std::ptrdiff_t>(from), rest.end());
  }
};
/// The next message of a kind; states and others are passed over.
Event wait_for(raw::Tcp& tcp, int kind) {
  for (int i = 0; i < 300; ++i) {
    const Message m = next(tcp);
    if (m.type != 20 || m.body.at(9) != kind) continue;
    return {kind, raw::Bytes(m.body.begin() + 10, m.body.end())};
  }
  throw std::runtime_error("the message did not come");
}
/// Robot mode and flags of the next state.
raw::Bytes next_mode(raw::Tcp& tcp) {
  for (;;) {
    const Message m = next(tcp);
    if (m.type == 16) return parts(m).at(0);
  }
}
bool mode_becomes(raw::Tcp& tcp, int mode) {
  for (int i = 0; i < 50; ++i)
    if (next_mode(tcp).at(15) == mode) return true;
  return false;
}

}  // namespace

TEST_CASE("Primary: the first state has all sub-packages with the guide's sizes, later ones no constants") {
  for (const Series series : {Series::cb3, Series::e_series}) {
    SimulatedUr5 robot(config(series));
    robot.start();
    for (const std::uint16_t port : {robot.ports().primary, robot.ports().secondary}) {
      raw::Tcp tcp(port);
      const Message hello = next(tcp);
      REQUIRE(hello.type == 20);
      CHECK(hello.body.at(9) == 3);
      const std::size_t name = hello.body.at(10);
      CHECK(std::string(hello.body.begin() + 11, hello.body.begin() + 11 + static_cast<int>(name)) ==
            "URControl");
      CHECK(hello.body.at(11 + name) == (series == Series::cb3 ? 3 : 5));

      const Message first = next(tcp);
      REQUIRE(first.type == 16);
      // All of an e-Series' sub-packages: 1386 bytes with the head.
      if (series == Series::e_series) CHECK(first.body.size() + 5 == 1386);
      std::map<int, std::size_t> expected{{0, 47},  {1, 251}, {2, 37}, {3, 75}, {4, 101}, {5, 225},
                                          {6, 445}, {7, 61},  {8, 9},  {9, 53}, {10, 43}};
      if (series == Series::e_series) {
        expected[11] = 26;
        expected[12] = 8;
      }
      const auto all = parts(first);
      CHECK(all.size() == expected.size());
      for (const auto& [type, size] : expected) {
        const int which = type;
        CAPTURE(which);
        REQUIRE(all.count(type) == 1);
        CHECK(all.at(type).size() + 5 == size);
      }
      const auto later = parts(next(tcp));
      CHECK(later.size() + 2 == all.size());
      CHECK(later.count(5) == 0);
      CHECK(later.count(6) == 0);
    }
  }
}

TEST_CASE("Primary: configuration and kinematics say what a UR5 is") {
  SimulatedUr5 robot(config(Series::cb3));
  robot.start();
  raw::Tcp tcp(robot.ports().primary);
  next(tcp);
  const auto all = parts(next(tcp));
  const raw::Bytes& c = all.at(6);
  CHECK(raw::take_double(c, 0) == doctest::Approx(-6.283185307));  // lower limit of the base
  CHECK(raw::take_double(c, 8) == doctest::Approx(6.283185307));   // upper
  CHECK(raw::take_double(c, 96) == doctest::Approx(3.14159265));   // speed limit
  CHECK(raw::take_double(c, 96 + 8) == doctest::Approx(40));       // acceleration limit
  CHECK(raw::take_double(c, 192) == doctest::Approx(1.05));        // defaults of movej
  CHECK(raw::take_double(c, 200) == doctest::Approx(1.4));
  CHECK(raw::take_double(c, 232 + 8) == doctest::Approx(-0.425));  // a2
  CHECK(raw::take_double(c, 280) == doctest::Approx(0.089159));    // d1
  CHECK(raw::take(c, 424 + 8, 4) == 1);                            // robot type UR5
  const raw::Bytes& k = all.at(5);
  CHECK(raw::take(k, 0, 4) != 0);  // a checksum for each joint
  CHECK(raw::take(k, 0, 4) != raw::take(k, 4, 4));
  CHECK(raw::take_double(k, 24 + 48 + 16) == doctest::Approx(-0.39225));       // a3
  CHECK(raw::take_double(k, 24 + 96 + 40) == doctest::Approx(0.0823));         // d6
  CHECK(raw::take_double(k, 24 + 144 + 32) == doctest::Approx(-1.570796327));  // alpha5
  // The pose that Cartesian info tells follows from these parameters and the joints.
  const raw::Bytes& joints = all.at(1);
  double z = 0, reach = 0;
  {
    // Arm at home: base 0, shoulder, elbow and wrist bent by right angles; only heights are looked at.
    const double q2 = raw::take_double(joints, 41), q3 = raw::take_double(joints, 82),
                 q4 = raw::take_double(joints, 123), q5 = raw::take_double(joints, 164);
    z = 0.089159 + 0.425 * -std::sin(q2) + 0.39225 * -std::sin(q2 + q3) - 0.09465 * std::cos(q2 + q3 + q4) -
        0.0823 * std::sin(q2 + q3 + q4) * std::sin(q5);
    reach = raw::take_double(all.at(4), 16);
  }
  CHECK(reach == doctest::Approx(z).epsilon(2e-3));
}

TEST_CASE("Primary: lines power the robot up and down and leave a running program alone") {
  SimulatedUr5 robot(config(Series::e_series, false));
  robot.start();
  raw::Tcp tcp(robot.ports().primary);
  CHECK(mode_becomes(tcp, 3));
  tcp.send("power on\n");
  CHECK(mode_becomes(tcp, 5));
  tcp.send("set robotmode run\n");
  CHECK(mode_becomes(tcp, 7));
  tcp.send("def works():\n  sleep(30)\nend\n");
  CHECK(wait_for(tcp, 7).text(9 + 19) == "works");
  for (const char* line : {"power on\n", "set robotmode run\n", "set real\n", "set unlock protective stop\n"})
    tcp.send(line);
  for (int i = 0; i < 3; ++i) CHECK(next_mode(tcp).at(13) == 1);  // the program runs
  tcp.send("stop program\n");
  const Event stopped = wait_for(tcp, 7);
  CHECK(raw::take(stopped.rest, 8, 1) == 19);
  CHECK(stopped.text(9) == "PROGRAM_XXX_STOPPEDworks");
  CHECK(next_mode(tcp).at(13) == 0);
  tcp.send("power off\n");
  CHECK(mode_becomes(tcp, 3));
}

TEST_CASE("Primary: a program's protective stop is a warning, and the safety mode is told when it changes") {
  Config c = config(Series::e_series);
  c.controller.unlock_time = 0.3;
  SimulatedUr5 robot(c);
  robot.start();
  raw::Tcp tcp(robot.ports().primary);
  tcp.send("sec setup():\n  protective_stop()\nend\n");
  const Event error = wait_for(tcp, 6);
  CHECK(raw::take(error.rest, 0, 4) == 209);
  CHECK(raw::take(error.rest, 4, 4) == 0);
  CHECK(raw::take(error.rest, 8, 4) == 2);  // a warning
  const Event mode = wait_for(tcp, 5);
  REQUIRE(mode.rest.size() == 17);
  CHECK(raw::take(mode.rest, 8, 1) == 3);  // protective stop
  // Asked for at once, it is unlocked as soon as that is allowed, 5 s after the stop on the real controller.
  tcp.send("set unlock protective stop\n");
  CHECK(raw::take(wait_for(tcp, 5).rest, 8, 1) == 1);
}

TEST_CASE("Primary: a program's life in key, text and error messages; scripts run from three ports") {
  SimulatedUr5 robot(config(Series::cb3));
  robot.start();
  raw::Tcp tcp(robot.ports().primary);
  for (const std::uint16_t port : {robot.ports().primary, robot.ports().secondary, robot.ports().realtime}) {
    raw::Tcp sender(port);
    sender.send("def test_fun():\n  textmsg(\"still \", \"running\")\n  sleep(0.1)\n  sync()\nend\n");
    const Event started = wait_for(tcp, 7);
    CHECK(started.text(9) == "PROGRAM_XXX_STARTEDtest_fun");
    CHECK(wait_for(tcp, 0).text(0) == "still running");
    CHECK(wait_for(tcp, 7).text(9) == "PROGRAM_XXX_STOPPEDtest_fun");
  }
}

TEST_CASE("Realtime: a packet of the guide's size in each cycle, and the fields where they belong") {
  for (const Series series : {Series::cb3, Series::e_series}) {
    SimulatedUr5 robot(config(series));
    robot.start();
    raw::Tcp tcp(robot.ports().realtime);
    const std::size_t size = series == Series::cb3 ? 1116 : 1220;
    const double cycle = series == Series::cb3 ? 0.008 : 0.002;
    double last = 0;
    for (int i = 0; i < 40; ++i) {
      const raw::Bytes p = tcp.exactly(size);
      REQUIRE(raw::take(p, 0, 4) == size);
      const double t = raw::take_double(p, 4);
      if (i > 0) CHECK(t - last == doctest::Approx(cycle).epsilon(0.01));
      last = t;
      CHECK(raw::take_double(p, 12 + 8) == doctest::Approx(-1.5708).epsilon(1e-3));   // target q2
      CHECK(raw::take_double(p, 252 + 8) == doctest::Approx(-1.5708).epsilon(1e-3));  // actual q2
      CHECK(raw::take_double(p, 756) == 7);                                           // robot mode
      CHECK(raw::take_double(p, 764) == 253);                                         // joint mode: running
      CHECK(raw::take_double(p, 812) == 1);                                           // safety mode: normal
      CHECK(raw::take_double(p, 1052) == 1);                                          // program: stopped
      CHECK(raw::take_double(p, 1108) == 1);                                          // safety status
    }
  }
}

TEST_CASE("Primary: who leaves a program half told is closed, who only listens is not") {
  Config c = config(Series::cb3);
  c.unfinished_time = 0.3;
  SimulatedUr5 robot(c);
  robot.start();
  raw::Tcp listener(robot.ports().primary), half(robot.ports().secondary), line(robot.ports().dashboard);
  half.send("def never():\n  sleep(1)\n");
  line.send("robotm");
  CHECK(half.closes(2));
  CHECK(line.closes(2));
  CHECK_FALSE(listener.closes(0.5));
}

TEST_CASE("Realtime: a client that stops reading is closed, and the others go on") {
  Config c = config(Series::e_series);
  c.unfinished_time = 0.3;
  SimulatedUr5 robot(c);
  robot.start();
  raw::Tcp slow(robot.ports().realtime, 4096), brisk(robot.ports().realtime);
  for (int i = 0; i < 1000; ++i) CHECK(raw::take(brisk.exactly(1220), 0, 4) == 1220);
  CHECK(slow.closes(5));
  CHECK(raw::take(brisk.exactly(1220), 0, 4) == 1220);
}
