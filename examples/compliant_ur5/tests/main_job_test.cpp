// The main job as its users run it: in step with the simulation, in real time, and when things go wrong.
//
// Promise: the main job by torque: the same touches as by position and velocity, the way back, rest
// Tried: seven touches: 37 N at most (182 N on the rigid arm), back within 3.0 mm, moves by less than 0.2
// degree from 6 to 8 s after the last one; replayed bit for bit; 125 Hz is refused
//
// Promise: the main job whose skin sends nothing but heartbeats, or falls silent, does not move on: exit
// code 4, and words
// Tried: in real time: at rest 0.1 s after the skin is found blind

#include <doctest/doctest.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/write.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "examples/adapters/skin/datagram.hpp"
#include "examples/compliant_ur5/fault_runs.hpp"
#include "examples/compliant_ur5/noted.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "examples/compliant_ur5/scene.hpp"
#include "examples/compliant_ur5/tests/beside.hpp"
#include "examples/simulated_ur5/scenario.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/by_day.hpp"

using namespace compliant_ur5;
namespace ip = boost::asio::ip;

namespace {

constexpr bool shorter = skinctl::testing::by_day || skinctl::testing::sanitized;

std::string fact(const RunLog& log, const std::string& name) {
  for (const auto& f : log.result)
    if (f.name == name) return f.value;
  return "";
}

/// Runs the job in a thread, lets `disturb` happen after it has moved for a while, and gives how it ended.
template <class F>
Outcome run_disturbed(Settings s, F&& disturb, RunLog& log) {
  s.cycles = 1250;  // ten seconds, if nothing happens
  s.task = {{.at = 0.2, .q = {0.5, -1.0, 1.2, -1.7, -1.57, 0.3}, .duration = 4}};
  std::atomic<bool> stop = false;
  Outcome outcome = Outcome::fine;
  std::thread job([&] {
    try {
      outcome = run(s, stop, log);
    } catch (const std::exception&) {
      outcome = Outcome::lost;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  disturb(stop);
  job.join();
  return outcome;
}
template <class F>
Outcome run_disturbed(const Settings& s, F&& disturb) {
  RunLog log;
  return run_disturbed(s, std::forward<F>(disturb), log);
}

/// A skin whose cells say nothing: the sender lives, and tells so each 4 ms.
class Heartbeats {
 public:
  explicit Heartbeats(std::uint16_t port)
      : thread_([this, port] {
          boost::asio::io_context io;
          ip::udp::socket socket(io, ip::udp::v4());
          std::array<std::uint8_t, adapters::skin::largest> bytes{};
          for (std::uint32_t k = 0; !end_; ++k) {
            const auto n = adapters::skin::write(bytes, k, k * std::chrono::milliseconds(4), {});
            boost::system::error_code ignored;
            socket.send_to(boost::asio::buffer(bytes.data(), n), {ip::address_v4::loopback(), port}, 0,
                           ignored);
            std::this_thread::sleep_for(std::chrono::milliseconds(4));
          }
        }) {}
  ~Heartbeats() {
    end_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> end_ = false;
  std::thread thread_;
};
/// How far the farthest joint has come [rad].
double moved(const RunLog& log) {
  double most = 0;
  for (const auto& e : log.entries)
    for (std::size_t i = 0; i < 6; ++i)
      most = std::max(most, static_cast<double>(std::abs(e.q[i] - log.entries[0].q[i])));
  return most;
}

}  // namespace

TEST_CASE("main job: gives way to every touch, returns, and is five times softer than a rigid arm") {
  // By day, and under the sanitizers, half of the minute, and a rigid arm for its first touch.
  constexpr bool whole = !shorter;
  Settings s = settings();
  if (!whole) s.cycles = 4000;
  RunLog soft, rigid;
  const std::atomic<bool> stop = false;
  REQUIRE(run(s, stop, soft) == Outcome::fine);
  s.rigid = true;
  if (!whole) s.cycles = 750;
  REQUIRE(run(s, stop, rigid) == Outcome::fine);
  REQUIRE(soft.touches.size() == (whole ? 7 : 4));
  for (const auto& t : soft.touches) {
    CAPTURE(t.start);
    CHECK(t.deflection > 0.02);
    CHECK(t.give_way > 0);
    CHECK(t.give_way < 0.2);
    CHECK(t.return_error < 0.003);
    CHECK(t.true_peak_force > 0);
  }
  // A finger that comes and goes makes the force rise and fall once; behind the lag of servoj a few swings of
  // more than 3 N may follow the first, and no row of them.
  for (const auto& t : soft.touches) {
    int turns = 0;
    double extreme = 0;
    bool rises = true;
    for (const auto& e : soft.entries) {
      if (e.time < t.start || e.time > t.start + 1.4) continue;
      if (rises ? e.force < extreme - 3 : e.force > extreme + 3) {
        rises = !rises, extreme = e.force, ++turns;
      } else {
        extreme = rises ? std::max(extreme, e.force) : std::min(extreme, e.force);
      }
    }
    MESSAGE(t.start << " s: " << turns << " turns");
    CHECK(turns <= 5);
  }
  int stood = 0;  // two of the seven press while the arm moves to its goal
  for (const auto& t : rigid.touches) stood += t.deflection < 0.001;
  CHECK(stood >= (whole ? 5 : 1));
  if (whole)
    CHECK(rigid.peak_force >=
          5 * soft.peak_force);  // 4.2 while a hair decided whether the seventh was damped
  CHECK(fact(soft, "allocations in the loop") == "0");
  CHECK(fact(soft, "cycles") == (whole ? "7500" : "4000"));
}

TEST_CASE("main job: all interfaces at their rates give way alike") {
  std::vector<TouchSummary> touches;
  for (const auto interface :
       {skinctl::Interface::position, skinctl::Interface::velocity, skinctl::Interface::torque}) {
    for (const double rate : {125.0, 500.0}) {
      if (interface == skinctl::Interface::torque && rate < 500) continue;  // a torque counts for 2 ms
      Settings s = settings();
      s.interface = interface;
      s.rate = rate;
      s.cycles = static_cast<std::uint64_t>(8 * rate);
      RunLog log;
      CAPTURE(rate);
      REQUIRE(run(s, false, log) == Outcome::fine);
      REQUIRE(log.touches.size() == 1);
      CHECK(log.touches[0].deflection > 0.02);
      CHECK(log.touches[0].return_error < 0.003);
      // A finger that slides has rims: no healthy cell there is found to be quiet, and masked for 10 s.
      CHECK(fact(log, "cells that report") == "260 of 260 cells report");
      touches.push_back(log.touches[0]);
    }
  }
  for (const auto& t : touches) {
    CHECK(t.deflection == doctest::Approx(touches[0].deflection).epsilon(0.1));
    CHECK(t.true_peak_force == doctest::Approx(touches[0].true_peak_force).epsilon(0.25));
  }
}

TEST_CASE("main job: by torque it gives way to every touch of the same scenario, comes back, and stands") {
  Settings s = settings();
  s.interface = skinctl::Interface::torque;
  s.rate = 500;
  if (shorter) s.cycles = 17 * 500;
  RunLog log;
  const Outcome outcome = run(s, false, log);
  REQUIRE_MESSAGE(outcome == Outcome::fine, log.words);
  CHECK(log.touches.size() == (shorter ? 2 : 7));
  for (const auto& t : log.touches) {
    CAPTURE(t.start);
    CHECK(t.deflection > 0.015);
    CHECK(t.give_way > 0);
    CHECK(t.give_way < 0.25);
    CHECK(t.return_error < 0.003);
  }
  CHECK(log.peak_force < 60);  // of the third, which meets the arm on its way
  CHECK(fact(log, "allocations in the loop") == "0");
  // Seconds after each touch every joint rests beside its target by less than the promise, and does not hunt
  // about it.
  constexpr double degree = 0.017453292519943295;
  for (const auto& span : {std::pair{1.0, 2.0}, std::pair{8.4, 8.9}, std::pair{15.4, 15.9},
                           std::pair{32.4, 32.9}, std::pair{39.4, 39.9}, std::pair{58.0, 60.0}}) {
    const double from = span.first, to = span.second;  // Clang 14 captures no binding
    if (to > log.entries.back().time + 0.1) continue;  // of a shorter run
    CAPTURE(from);
    double beside = 0, moves = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      float low = 1e9f, high = -1e9f;
      for (const auto& e : log.entries) {
        if (e.time < from || e.time > to) continue;
        low = std::min(low, e.q[i]), high = std::max(high, e.q[i]);
        beside = std::max(beside, static_cast<double>(std::abs(e.q[i] - e.target[i])));
      }
      moves = std::max(moves, static_cast<double>(high - low));
    }
    MESSAGE("from ", from, " s: beside its target by ", beside / degree, " degree, moves by ",
            moves / degree);
    CHECK(beside < 0.1 * degree);
    CHECK(moves < 0.05 * degree);
  }
}

TEST_CASE("main job: by torque at 125 Hz is refused with words") {
  Settings s = settings();
  s.interface = skinctl::Interface::torque;
  RunLog log;
  CHECK_THROWS_WITH_AS(static_cast<void>(run(s, false, log)), doctest::Contains("rate by torque = 125"),
                       skinctl::ConfigurationError);
}

TEST_CASE("main job: the skin of a file, by sealed datagrams, is the skin that is built in") {
  Settings s = settings();
  s.compare = false;
  s.cycles = 750;
  RunLog built_in, from_file;
  REQUIRE(run(s, false, built_in) == Outcome::fine);
  s.skin = SKIN_FILE;
#if SKINCTL_HAS_SODIUM
  const auto key = std::filesystem::temp_directory_path() / "skinctl_main_job_key";
  std::ofstream(key) << std::string(64, '7') << '\n';
  std::filesystem::permissions(key, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  s.skin_key = key.string();
#endif
  REQUIRE(run(s, false, from_file) == Outcome::fine);
  CHECK(fact(from_file, "skin datagrams lost") == "0");
  CHECK(fact(from_file, "stray skin datagrams") == "0");
  CHECK(fact(from_file, "leaps of the skin's clock") == "none");
  REQUIRE(built_in.touches.size() == 1);
  REQUIRE(from_file.touches.size() == 1);
  CHECK(from_file.touches[0].cell == built_in.touches[0].cell);
  CHECK(from_file.peak_force == doctest::Approx(built_in.peak_force).epsilon(1e-2));
#if SKINCTL_HAS_SODIUM
  // The first datagrams answer nothing; the program asks, and the skin is heard.
  CHECK(fact(from_file, "skin datagrams refused").find("had heard no question yet") != std::string::npos);
  std::filesystem::remove(key);
#endif
}

TEST_CASE(
    "main job: a skin file with fewer cells, masked ones and gains of their own; one that does not fit is "
    "refused") {
  Settings s = settings();
  s.compare = false;
  s.cycles = 750;
  const auto path = std::filesystem::temp_directory_path() / "skinctl_main_job_skin.json";
  s.skin = path.string();
  const skinctl::SkinFile shipped = skinctl::read_skin_file(SKIN_FILE);
  skinctl::SkinFile file = shipped;
  file.patches.pop_back();  // a wrist without skin
  file.links.pop_back();
  skinctl::write_skin_file(file, path.string());
  RunLog soft, masked;
  REQUIRE(run(s, false, soft) == Outcome::fine);
  REQUIRE(soft.touches.size() == 1);
  CHECK(soft.touches[0].deflection > 0.02);
  // A cell beside which the file says nobody lies reports, but has no witness: its place feels nothing.
  skinctl::SkinFile lone = shipped;
  lone.patches.back().cells.resize(1);
  lone.patches.back().cells[0].neighbours.assign(4, skinctl::SkinFile::nobody);
  skinctl::write_skin_file(lone, path.string());
  RunLog stays;
  REQUIRE(run(s, false, stays) == Outcome::fine);
  CHECK(fact(stays, "cells that report").find("; wrist 3: 1 place feels nothing (cells ") !=
        std::string::npos);
  // Every tenth cell of the forearm is masked: its neighbours fill it in. All of them: the robot is blind
  // there.
  for (auto& patch : file.patches)
    for (std::size_t c = 0; c < patch.cells.size(); c += 10)
      if (patch.name == "forearm") patch.cells[c].masked = "as a test";
  skinctl::write_skin_file(file, path.string());
  REQUIRE(run(s, false, masked) == Outcome::fine);
  CHECK(masked.peak_force < 1.3 * soft.peak_force);
  for (auto& patch : file.patches)
    for (auto& cell : patch.cells)
      if (patch.name == "forearm") cell.masked = "as a test";
  skinctl::write_skin_file(file, path.string());
  RunLog blind;
  CHECK(run(s, false, blind) == Outcome::blind);
  file = shipped;
  file.regions = {{"elbow", {file.patches[2].cells[0].id}, 1, 65, 0}};
  skinctl::write_skin_file(file, path.string());
  CHECK_THROWS_WITH_AS(static_cast<void>(run(s, false, blind)), doctest::Contains("force_limit = 65"),
                       skinctl::ConfigurationError);

  RunLog log;
  file = shipped;
  file.patches[5].link = file.links[5].name = "wrist_4_link";
  skinctl::write_skin_file(file, path.string());
  CHECK_THROWS_WITH_AS(
      static_cast<void>(run(s, false, log)),
      doctest::Contains("patch \"wrist 3\", link \"wrist_4_link\": the robot has no such link"),
      skinctl::ConfigurationError);
  file = shipped;
  for (std::uint32_t id = 1000; id < 1300; ++id) {
    auto cell = file.patches[0].cells[0];
    cell.id = id;
    for (auto& port : cell.neighbours) port = skinctl::SkinFile::nobody;
    file.patches[0].cells.push_back(cell);
  }
  skinctl::write_skin_file(file, path.string());
  CHECK_THROWS_WITH_AS(static_cast<void>(run(s, false, log)),
                       doctest::Contains("SkinOf: cells = 560, allowed: at most its capacity of 512"),
                       skinctl::ConfigurationError);
  std::filesystem::remove(path);
}

TEST_CASE("main job: neighbouring cells that fail in one moment move the untouched arm by 30 mm at most") {
  using skinctl::Interface;
  for (const auto& [interface, streams] :
       {std::pair{Interface::position, false}, {Interface::position, true}, {Interface::torque, false}}) {
    FaultRun r{.interface = interface, .streams = streams, .duration = 4};
    const auto healthy = run_with_faults(settings(), r);
    REQUIRE_MESSAGE(healthy.outcome == Outcome::fine, healthy.log.words);
    for (const char* fault : {"stuck", "saturated", "blinking", "noisy"}) {
      r.faults = faults_of(fault, {170, 171}, 0.5);
      const auto faulty = run_with_faults(settings(), r);
      CAPTURE(r.faults);
      CAPTURE(r.streams);
      CHECK(faulty.outcome == Outcome::fine);
      CHECK(farthest_apart(faulty.log, healthy.log) < 0.03);
      if (shorter || interface == Interface::torque) break;
    }
  }
}

TEST_CASE("main job: cells that stick are no worse for a finger on them, or elsewhere, than silent ones") {
  for (const int touched : {170, 129}) {  // on them, and elsewhere
    FaultRun r{.touched = touched, .duration = 5};
    r.faults = faults_of("unheard", {170, 171}, 0.5);
    const auto silent = run_with_faults(settings(), r);
    r.faults = faults_of("stuck", {170, 171}, 0.5);
    const auto stuck = run_with_faults(settings(), r);
    CAPTURE(touched);
    CHECK(silent.outcome == Outcome::fine);
    CHECK(stuck.outcome == Outcome::fine);
    CHECK(stuck.log.peak_force < 75);  // 25 N on a healthy skin, 26 N elsewhere; 182 N on a rigid arm
    CHECK(stuck.log.peak_force < 1.05 * silent.log.peak_force);
    CHECK(farthest_apart(stuck.log, silent.log) < 0.03);
    if (skinctl::testing::sanitized) break;
  }
}

TEST_CASE("main job: a cable of silent cells: it goes on, and says which places feel nothing") {
  std::vector<std::uint32_t> cable;
  for (std::uint32_t id = 158; id <= 182; ++id) cable.push_back(id);
  FaultRun r{.faults = faults_of("unheard", cable, 0.5), .touched = 170, .touched_at = 2, .duration = 4};
  const auto holed = run_with_faults(settings(), r);
  CHECK(holed.outcome == Outcome::fine);
  const std::string words = fact(holed.log, "cells that report");
  for (const char* word :
       {"235 of 260 cells report", "forearm: 25 of", "cells do not count", "places feel nothing (cells 1"}) {
    CAPTURE(words);
    CHECK(words.find(word) != std::string::npos);
  }
  // As many cells, but none beside another.
  std::vector<std::uint32_t> scattered;
  for (std::uint32_t id = 6; id < 260; id += 10) scattered.push_back(id);
  r.faults = faults_of("unheard", scattered, 0.5);
  const auto whole = run_with_faults(settings(), r);
  CHECK_MESSAGE(whole.outcome == Outcome::fine, whole.log.words);
  CHECK(whole.log.touches.size() == 1);
}

TEST_CASE("main job: a recording replays bit for bit") {
  for (const auto interface : {skinctl::Interface::position, skinctl::Interface::torque}) {
    Settings s = settings();
    s.interface = interface;
    if (interface == skinctl::Interface::torque) s.rate = 500;
    s.cycles = 1000;
    s.record = (std::filesystem::temp_directory_path() / "compliant_ur5_test.mcap").string();
    RunLog log;
    REQUIRE(run(s, false, log) == Outcome::fine);
    s.replay = s.record;
    CHECK(replay(s) == Outcome::fine);
    s.control.force_gain[2] *= 1.01;
    s.torque.viscous[0] *= 1.01;
    CHECK_THROWS_WITH_AS(static_cast<void>(replay(s)), doctest::Contains("was recorded with another scene"),
                         skinctl::ConfigurationError);
    std::filesystem::remove(s.record);
  }
}

TEST_SUITE_BEGIN("real time");

TEST_CASE("main job: in real time beside a robot that has to be switched on, until it is interrupted") {
  Settings s = settings();
  Beside beside(s);
  CHECK(run_disturbed(s, [](std::atomic<bool>& stop) { stop = true; }) == Outcome::interrupted);
  CHECK(beside.comes_to_rest());
}

TEST_CASE("main job: the controller dies: lost") {
  Settings s = settings();
  Beside beside(s);
  CHECK(run_disturbed(s, [&](auto&) { beside.robot->stop(); }) == Outcome::lost);
}

TEST_CASE("main job: the skin falls silent: blind, and the robot comes to rest") {
  Settings s = settings();
  Beside beside(s);
  CHECK(run_disturbed(s, [&](auto&) { beside.robot->set_skin_stream(false); }) == Outcome::blind);
  CHECK(beside.comes_to_rest());
}

TEST_CASE(
    "main job: a skin that sends nothing but heartbeats is blind: no motion, and an exit code that says so") {
  Settings s = settings();
  Beside beside(s);
  beside.robot->set_skin_stream(false);
  const Heartbeats heartbeats(s.skin_port);
  RunLog log;
  CHECK(run_disturbed(s, [](auto&) {}, log) == Outcome::blind);
  CHECK(log.entries.size() < 500);  // within four seconds
  CHECK(moved(log) < 1e-3);
  CHECK(fact(log, "cells that report").rfind("0 of 260 cells report", 0) == 0);
  CHECK(has_noted(log, skinctl::Reason::skin_unheard));
  CHECK(beside.comes_to_rest());
}

TEST_CASE("main job: the cells fall silent while the sender lives: at rest within 0.5 s, and it says why") {
  Settings s = settings();
  Beside beside(s);
  std::unique_ptr<Heartbeats> heartbeats;
  RunLog log;
  const auto outcome = run_disturbed(
      s,
      [&](auto&) {
        beside.robot->set_skin_stream(false);
        std::this_thread::sleep_for(std::chrono::milliseconds(220));  // until another sender may begin
        heartbeats = std::make_unique<Heartbeats>(s.skin_port);
      },
      log);
  CHECK(outcome == Outcome::blind);
  CHECK(moved(log) > 0.02);
  CHECK(has_noted(log, skinctl::Reason::skin_blind));
  const auto blind = [](const LogEntry& e) {
    return skinctl::Status::from_bits(e.status).has(skinctl::Reason::skin_blind);
  };
  const auto first = std::find_if(log.entries.begin(), log.entries.end(), blind);
  REQUIRE(first != log.entries.end());
  REQUIRE(log.entries.back().time > first->time + 0.2);
  for (auto e = first; e != log.entries.end(); ++e)
    if (e->time > first->time + 0.1)  // 3 rad/s at 30 rad/s^2; max_age has passed before
      for (const float u : e->velocity) CHECK(u == 0);
  CHECK(beside.comes_to_rest());
}

TEST_CASE("main job: strays on the skin's port are counted and dropped, and the job goes on to its end") {
  Settings s = settings();
  Beside beside(s);
  RunLog log;
  const auto outcome = run_disturbed(
      s,
      [&](auto&) {
        boost::asio::io_context io;
        ip::udp::socket socket(io, ip::udp::v4());
        const std::string junk = "this is no datagram of ours";
        // Somebody else's press of the arm's only cell with all there is, stamped far ahead.
        std::array<std::uint8_t, adapters::skin::largest> bytes;
        const skinctl::CellSample press{.time = std::chrono::seconds(1000), .cell = 1, .force = {1, 1, 1}};
        const auto size = adapters::skin::write(bytes, 1'000'000, press.time, std::span(&press, 1));
        for (int k = 0; k < 100; ++k) {
          socket.send_to(boost::asio::buffer(junk), {ip::address_v4::loopback(), s.skin_port});
          socket.send_to(boost::asio::buffer(bytes.data(), size), {ip::address_v4::loopback(), s.skin_port});
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      },
      log);
  CHECK(outcome == Outcome::fine);
  CHECK(fact(log, "stray skin datagrams") == "200");
  CHECK(log.touches.empty());
}

TEST_CASE("main job: nonsense in the robot's stream: lost, and the robot comes to rest by its own time-out") {
  Settings s = settings();
  Beside beside(s);
  // A wire between program and robot that begins to garble.
  boost::asio::io_context io;
  ip::tcp::acceptor acceptor(io, {ip::address_v4::loopback(), 0});
  const std::uint16_t real_port = s.rtde_port;
  s.rtde_port = acceptor.local_endpoint().port();
  std::atomic<bool> garble = false;
  std::thread wire([&] {
    try {
      ip::tcp::socket program(io), robot(io);
      acceptor.accept(program);
      robot.connect({ip::address_v4::loopback(), real_port});
      std::thread up([&] {
        std::array<char, 4096> block{};
        boost::system::error_code error;
        while (!error) {
          const auto n = program.read_some(boost::asio::buffer(block), error);
          if (n > 0) boost::asio::write(robot, boost::asio::buffer(block, n), error);
        }
        robot.shutdown(ip::tcp::socket::shutdown_both, error);
      });
      std::array<char, 4096> block{};
      boost::system::error_code error;
      while (!error) {
        const auto n = robot.read_some(boost::asio::buffer(block), error);
        if (garble)
          for (std::size_t k = 0; k < n; ++k) block[k] = static_cast<char>(0xff - k);
        if (n > 0) boost::asio::write(program, boost::asio::buffer(block, n), error);
      }
      program.shutdown(ip::tcp::socket::shutdown_both, error);
      up.join();
    } catch (const std::exception&) {
    }
  });
  CHECK(run_disturbed(s, [&](auto&) { garble = true; }) == Outcome::lost);
  CHECK(beside.comes_to_rest());
  wire.join();
}

TEST_CASE("main job: nobody there, or somebody who does not speak the protocol: a clear error at once") {
  Settings s = settings();
  s.robot = "127.0.0.1";
  {
    boost::asio::io_context io;
    ip::tcp::acceptor nobody(io, {ip::address_v4::loopback(), 0});
    s.rtde_port = nobody.local_endpoint().port();
  }
  RunLog log;
  CHECK_THROWS_WITH_AS(static_cast<void>(run(s, false, log)),
                       doctest::Contains("cannot reach the robot's RTDE"), std::runtime_error);
  boost::asio::io_context io;
  ip::tcp::acceptor web(io, {ip::address_v4::loopback(), 0});
  s.rtde_port = web.local_endpoint().port();
  std::thread server([&] {
    ip::tcp::socket socket(io);
    boost::system::error_code acceptor_error;
    web.accept(socket, acceptor_error);
    const std::string answer = "HTTP/1.1 400 Bad Request\r\n\r\n";
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(answer), ignored);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  });
  CHECK_THROWS_WITH_AS(static_cast<void>(run(s, false, log)), doctest::Contains("nonsense"),
                       std::runtime_error);
  server.join();
}

TEST_SUITE_END();
