#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>

#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

using namespace simulated_ur5;

namespace {

Config quiet(double speed = 1) {
  Config c;
  c.ports = {0, 0, 0, 0, 0};
  c.speed = speed;
  c.controller.powered = true;
  return c;
}

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

/// Waits until `condition(snapshot)` holds, at most `limit` seconds of real time.
template <class Condition>
bool eventually(SimulatedUr5& robot, double limit, Condition&& condition) {
  const auto begin = std::chrono::steady_clock::now();
  do {
    if (condition(robot.snapshot())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  } while (seconds_since(begin) < limit);
  return false;
}

double speed_of(const Snapshot& s) {
  double v = 0;
  for (double x : s.true_dq) v = std::max(v, std::abs(x));
  return v;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("Network: RTDE streams at the controller's rate and answers in order") {
  for (const Series series : {Series::cb3, Series::e_series}) {
    Config config = quiet();
    config.controller.series = series;
    SimulatedUr5 robot(config);
    robot.start();
    raw::Tcp tcp(robot.ports().rtde);
    tcp.send(raw::package('v'));
    const raw::Package version = raw::read_package(tcp);
    CHECK(version.type == 'v');
    REQUIRE(version.payload.size() == 16);
    CHECK(raw::take(version.payload, 0, 4) == (series == Series::cb3 ? 3u : 5u));
    tcp.send(raw::version_request(2));
    CHECK(raw::read_package(tcp).payload == raw::Bytes{1});
    tcp.send(raw::outputs_request(500, "timestamp,actual_q,robot_mode,"));
    const raw::Package types = raw::read_package(tcp);
    CHECK(types.type == 'O');
    CHECK(types.payload.at(0) == 1);
    CHECK(types.text(1) == "DOUBLE,VECTOR6D,INT32");
    raw::start(tcp);
    const double cycle = series == Series::cb3 ? 0.008 : 0.002;
    double last = 0;
    for (int i = 0; i < 100; ++i) {
      const raw::Package p = raw::read_until(tcp, 'U');
      REQUIRE(p.payload.size() == 1 + 8 + 48 + 4);
      CHECK(p.payload[0] == 1);
      CHECK(raw::take(p.payload, 57, 4) == 7);
      const double t = raw::take_double(p.payload, 1);
      if (i > 0) {
        // A busy machine skips outputs, but never sends them late or twice.
        const double steps = (t - last) / cycle;
        CHECK(steps > 0.5);
        CHECK(std::abs(steps - std::round(steps)) < 1e-3);
        CHECK(steps < 4.5);  // at most three are left out in a row
      }
      last = t;
    }
  }
}

TEST_CASE("Network: no port takes orders from a web page") {
  const std::string script = "def move():\n  movej([0, -1, 1, 0, 0, 0])\nend\n";
  const std::string panel = "shutdown\npower off\n";
  const auto posted = [](const std::string& body) {
    return "POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: text/plain\r\nContent-Length: " +
           std::to_string(body.size()) + "\r\n\r\n" + body;
  };
  SimulatedUr5 robot(quiet());
  robot.start();
  const Ports ports = robot.ports();
  const auto begin = robot.snapshot().true_q;
  for (const std::uint16_t port :
       {ports.dashboard, ports.primary, ports.secondary, ports.realtime, ports.rtde}) {
    const std::string& body = port == ports.dashboard ? panel : script;
    for (const std::string& request :
         {posted(body), "GET /" + std::string(5000, 'x') + " HTTP/1.0\r\n\r\n" + body,
          "OPTIONS * HTTP/1.1\r\n\r\n" + body, "PUT http://127.0.0.1/ HTTP/1.1\r\n\r\n" + body,
          "\x16\x03\x01\n" + body})
      for (const bool in_pieces : {false, true}) {
        CAPTURE(request);
        raw::Tcp tcp(port);
        for (std::size_t at = 0; at < request.size(); at += in_pieces ? 1 : request.size())
          if (!tcp.send(std::string_view(request).substr(at, in_pieces ? 1 : request.size()))) break;
        CHECK(tcp.closes());
      }
  }
  const Snapshot after = robot.snapshot();
  CHECK(after.counters.programs == 0);
  CHECK(after.state.robot_mode == RobotMode::running);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(after.true_q[i] - begin[i]) < 1e-6);

  raw::Tcp dashboard(ports.dashboard);  // who is no web page is answered as ever
  CHECK(dashboard.line().find("Connected") == 0);
  dashboard.send("robotmode\n");
  CHECK(dashboard.line() == "Robotmode: RUNNING");
}

TEST_CASE("Network: a program connects back and the arm follows servoj and speedj") {
  SimulatedUr5 robot(quiet());
  robot.start();
  raw::Listener listener;
  raw::Tcp script(robot.ports().secondary);
  script.send(raw::stream_program(listener.port));
  raw::Tcp reverse = listener.accept();
  raw::Tcp rtde = raw::rtde_client(robot.ports().rtde, 125, "timestamp,actual_q,actual_qd,runtime_state");
  raw::start(rtde);

  raw::Package p = raw::read_until(rtde, 'U');
  std::array<double, 6> q{};
  for (std::size_t i = 0; i < 6; ++i) q[i] = raw::take_double(p.payload, 9 + 8 * i);
  CHECK(raw::take(p.payload, 105, 4) == 2);
  const double begin = q[0];
  for (int i = 0; i < 100; ++i) {
    q[0] += 0.3 * 0.008;
    reverse.send(raw::reverse_message(200, q, 1));
    p = raw::read_until(rtde, 'U');
  }
  CHECK(raw::take_double(p.payload, 9) - begin > 0.15);
  CHECK(raw::take_double(p.payload, 57) > 0.1);
  for (int i = 0; i < 75; ++i) {  // until lookahead, delay and lag are over
    reverse.send(raw::reverse_message(200, q, 1));
    raw::read_until(rtde, 'U');
  }
  CHECK(robot.snapshot().true_q[0] == doctest::Approx(q[0]).epsilon(1e-6));

  // The motion thread ends with a stopj before the other begins.
  for (int i = 0; i < 60; ++i) {
    reverse.send(raw::reverse_message(200, {0, 0, 0, 0, 0, -0.4}, 2));
    raw::read_until(rtde, 'U');
  }
  CHECK(robot.snapshot().true_dq[5] == doctest::Approx(-0.4).epsilon(1e-3));
  reverse.send(raw::reverse_message(200, {}, -2));
  CHECK(reverse.closes());
  CHECK(eventually(robot, 5, [](const Snapshot& s) {
    return s.state.runtime_state == RuntimeState::stopped && speed_of(s) < 1e-6;
  }));
}

TEST_CASE(
    "Network: silence, a lost peer and a killed client bring the arm to rest by the robot's own timeout") {
  for (const bool vanish : {false, true}) {
    CAPTURE(vanish);
    SimulatedUr5 robot(quiet());
    robot.start();
    raw::Listener listener;
    {
      raw::Tcp script(robot.ports().secondary);
      script.send(raw::stream_program(listener.port));
    }
    raw::Tcp reverse = listener.accept();
    for (int i = 0; i < 40; ++i) {
      reverse.send(raw::reverse_message(100, {0.5, 0, 0, 0, 0, 0}, 2));
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
    CHECK(robot.snapshot().true_dq[0] > 0.3);
    const auto silent_since = std::chrono::steady_clock::now();
    if (vanish) reverse.close();
    CHECK(eventually(robot, 5, [](const Snapshot& s) {
      return s.state.runtime_state == RuntimeState::stopped && speed_of(s) < 1e-6;
    }));
    // 100 ms of timeout, 0.5/4 s of stopj(4), and the arm's own lag.
    CHECK(seconds_since(silent_since) < 1.5);
  }
}

namespace {

/// A client that commands in lock-step: a sine on joint 0 by speedj, one command per data package.
struct LockStepRun {
  std::vector<double> q;
  std::vector<std::int64_t> cell_times;
  Snapshot last;
  double real_time = 0;
  std::size_t datagrams = 0;
};

LockStepRun lock_step_run(Series series, int cycles, int divider, std::uint64_t seed) {
  Config config = quiet(0);
  config.controller.series = series;
  config.controller.seed = seed;
  config.controller.arm.position_noise = 1e-4;
  Touch touch;
  touch.link = 2;
  touch.point = {-0.2, 0, 0.06};
  touch.start = 1;
  config.controller.touches = {touch};
  config.controller.cells.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    config.controller.cells[i].id = static_cast<std::uint32_t>(i + 1);
    config.controller.cells[i].link = 2;
    config.controller.cells[i].position = {-0.17 - 0.03 * static_cast<double>(i), 0, 0.06};
    config.controller.cells[i].normal = {0, 0, 1};
    complete(config.controller.cells[i]);
  }
  raw::Udp skin;
  config.skin_port = skin.port;
  SimulatedUr5 robot(config);
  robot.start();
  raw::Listener listener;
  raw::Tcp script(robot.ports().secondary);
  script.send(raw::stream_program(listener.port));
  raw::Tcp reverse = listener.accept();
  const double rate = (series == Series::cb3 ? 125.0 : 500.0) / divider;
  raw::Tcp rtde = raw::rtde_client(robot.ports().rtde, rate, "timestamp,actual_q,actual_TCP_force");
  raw::start(rtde);
  raw::read_until(rtde, 'U');
  while (skin.receive(0)) continue;  // what came before the first command depends on the clock
  LockStepRun run;
  const auto begin = std::chrono::steady_clock::now();
  std::optional<double> first_time;
  for (int i = 0; i < cycles; ++i) {
    reverse.send(raw::reverse_message(100, {0.3 * std::sin(2 * pi * i / rate), 0, 0, 0, 0, 0}, 2));
    const raw::Package p = raw::read_until(rtde, 'U');
    const double t = raw::take_double(p.payload, 1);
    if (!first_time) first_time = t;
    // One package per command, in simulated time.
    CHECK(std::abs(t - *first_time - i / rate) < 1e-6);
    for (std::size_t j = 0; j < 6; ++j) run.q.push_back(raw::take_double(p.payload, 9 + 8 * j));
    run.q.push_back(raw::take_double(p.payload, 57));
    // The datagrams of the interval are there before the package is.
    while (const auto d = skin.receive(0)) {
      ++run.datagrams;
      constexpr std::size_t header = 28, sample = 16 + 4 * 8;  // version 3, eight readings a hexagon
      REQUIRE(d->size() >= header);
      const std::size_t count = d->at(6) + 256u * d->at(7);
      REQUIRE(d->size() == header + sample * count);
      for (std::size_t k = 0; k < count; ++k) {
        std::int64_t time = 0;
        std::memcpy(&time, d->data() + header + sample * k + 4, 8);
        run.cell_times.push_back(time - static_cast<std::int64_t>(std::llround(*first_time * 1e9)));
        CHECK(time <= static_cast<std::int64_t>(std::llround(t * 1e9)));
      }
    }
  }
  run.real_time = seconds_since(begin);
  run.last = robot.snapshot();
  return run;
}

}  // namespace

TEST_CASE("Network: lock-step waits for each answer, runs as fast as they come, and repeats exactly") {
  for (const Series series : {Series::cb3, Series::e_series}) {
    const int cycles = series == Series::cb3 ? 625 : 2500;  // 5 s
    const LockStepRun a = lock_step_run(series, cycles, 1, 1), b = lock_step_run(series, cycles, 1, 1);
    CHECK(a.q == b.q);
    CHECK(a.cell_times == b.cell_times);
    CHECK(a.last.touches.at(0).peak_force == b.last.touches.at(0).peak_force);
    CHECK(a.last.touches.at(0).peak_force > 50);
    CHECK(a.datagrams >= 1200);
    CHECK(lock_step_run(series, cycles, 1, 2).q != a.q);
    MESSAGE("5 s of simulated time in " << a.real_time << " s");
  }
  // A client at a quarter of the rate is waited for at its own packages only.
  const LockStepRun slow = lock_step_run(Series::e_series, 600, 4, 1);
  CHECK(slow.last.state.program_running);
}

TEST_CASE("Network: lock-step lets time go on when the commander falls silent") {
  Config config = quiet(0);
  config.patience = 0.1;
  SimulatedUr5 robot(config);
  robot.start();
  raw::Listener listener;
  raw::Tcp script(robot.ports().primary);
  script.send(raw::stream_program(listener.port));
  raw::Tcp reverse = listener.accept();
  raw::Tcp rtde = raw::rtde_client(robot.ports().rtde, 125, "timestamp");
  raw::start(rtde);
  for (int i = 0; i < 200; ++i) {
    reverse.send(raw::reverse_message(200, {0.5, 0, 0, 0, 0, 0}, 2));
    raw::read_until(rtde, 'U');
  }
  CHECK(robot.snapshot().true_dq[0] > 0.49);
  CHECK(eventually(robot, 5, [](const Snapshot& s) {
    return s.state.runtime_state == RuntimeState::stopped && speed_of(s) < 1e-6;
  }));
}

TEST_CASE("Network: several clients stream at their own rates, a start twice does not double") {
  SimulatedUr5 robot(quiet(10));
  robot.start();
  raw::Tcp fast = raw::rtde_client(robot.ports().rtde, 125, "timestamp");
  raw::Tcp slow = raw::rtde_client(robot.ports().rtde, 25, "timestamp,actual_q");
  raw::start(fast);
  raw::start(fast);
  raw::start(slow);
  double last = 0, steps = 0;
  for (int i = 0; i < 400; ++i) {
    const double t = raw::take_double(raw::read_until(fast, 'U').payload, 1);
    if (i > 0) {
      CHECK(t > last + 0.007);
      steps += (t - last) / 0.008;
    }
    last = t;
  }
  CHECK(steps < 4 * 400);
  last = 0;
  for (int i = 0; i < 20; ++i) {
    const double t = raw::take_double(raw::read_until(slow, 'U').payload, 1);
    if (i > 0) CHECK(t > last + 0.039);
    last = t;
  }
  fast.send(raw::package('P'));
  raw::read_until(fast, 'P');
  CHECK(fast.receive(10, 0.2).empty());
  CHECK(fast.timed_out);
}

TEST_CASE("Network: a client that stops reading is closed, and the others go on") {
  Config config = quiet(100);
  config.controller.series = Series::e_series;
  SimulatedUr5 robot(config);
  robot.start();
  std::string names;
  for (int i = 0; i < 20; ++i) names += "actual_q,";
  // Connected with a small receive buffer, so that it fills soon.
  raw::Tcp lazy(robot.ports().rtde, 4096);
  lazy.send(raw::version_request(2));
  raw::read_until(lazy, 'V');
  lazy.send(raw::outputs_request(500, names));
  raw::read_until(lazy, 'O');
  raw::start(lazy);
  raw::Tcp awake = raw::rtde_client(robot.ports().rtde, 500, "timestamp");
  raw::start(awake);
  const auto begin = std::chrono::steady_clock::now();
  while (seconds_since(begin) < 3) raw::read_until(awake, 'U');
  CHECK(lazy.closes(5));
  CHECK(raw::read_until(awake, 'U').payload.size() == 9);
}

TEST_CASE("Network: the dashboard greets, powers up, and shuts everything down") {
  Config config = quiet(20);
  config.controller.powered = false;
  SimulatedUr5 robot(config);
  robot.start();
  raw::Tcp dashboard(robot.ports().dashboard);
  CHECK(dashboard.line() == "Connected: Universal Robots Dashboard Server");
  const auto ask = [&](std::string_view line) {
    dashboard.send(std::string(line) + "\n");
    return dashboard.line();
  };
  CHECK(ask("robotmode") == "Robotmode: POWER_OFF");
  CHECK(ask("brake release") == "Brake releasing");
  CHECK(eventually(robot, 5, [](const Snapshot& s) { return s.state.robot_mode == RobotMode::running; }));
  CHECK(ask("robotmode") == "Robotmode: RUNNING");
  CHECK(ask("shutdown") == "Shutting down");
  CHECK(dashboard.closes());
  CHECK(robot.wait(5));
  CHECK_THROWS(raw::Tcp(robot.ports().dashboard));
  CHECK(robot.snapshot().state.robot_mode == RobotMode::running);  // what was last known
}

TEST_CASE("Network: programs that want other machines or closed ports are ended") {
  for (const char* host : {"192.0.2.1", "example.org", "127.0.0.1"}) {
    SimulatedUr5 robot(quiet(5));
    robot.start();
    std::string program = raw::stream_program(1);
    const auto at = program.rfind("127.0.0.1");
    program.replace(at, 9, host);
    raw::Tcp script(robot.ports().secondary);
    script.send(program);
    CHECK(eventually(robot, 5,
                     [](const Snapshot& s) { return s.counters.programs == 1 && !s.state.program_running; }));
  }
}

TEST_CASE("Network: a second program takes over from the first, and a line stops it") {
  SimulatedUr5 robot(quiet(1));
  robot.start();
  raw::Listener first, second;
  raw::Tcp script(robot.ports().secondary);
  script.send(raw::stream_program(first.port));
  raw::Tcp a = first.accept();
  a.send(raw::reverse_message(500, {0.3, 0, 0, 0, 0, 0}, 2));
  script.send(raw::stream_program(second.port));
  raw::Tcp b = second.accept();
  CHECK(a.closes());
  for (int i = 0; i < 50; ++i) {
    b.send(raw::reverse_message(500, {0, 0, 0, 0, 0, 0.3}, 2));
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  CHECK(robot.snapshot().true_dq[5] > 0.2);
  script.send("stopj(5.0)\n");
  CHECK(b.closes());
  CHECK(eventually(robot, 5, [](const Snapshot& s) { return speed_of(s) < 1e-6; }));
}

TEST_CASE("Network: the skin sends at 250 Hz without gaps, falls silent on request, and finds a new target") {
  Config config = quiet(1);
  config.controller.cells.resize(2);
  config.controller.cells[0].id = 1;
  config.controller.cells[1].id = 2;
  for (auto& c : config.controller.cells) {
    c.normal = {0, 0, 1};
    complete(c);
  }
  raw::Udp skin;
  SimulatedUr5 robot(config);
  robot.start();
  CHECK_FALSE(skin.receive(0.1));
  robot.set_skin_target("127.0.0.1", skin.port);
  std::uint32_t sequence = 0;
  std::int64_t time = 0;
  for (int i = 0; i < 100; ++i) {
    const auto d = skin.receive(1);
    REQUIRE(d);
    CHECK(std::string(d->begin(), d->begin() + 4) == "SKIN");
    std::uint32_t s = 0;
    std::int64_t t = 0;
    std::memcpy(&s, d->data() + 8, 4);
    std::memcpy(&t, d->data() + 12, 8);
    if (i > 0) {
      CHECK(s == sequence + 1);
      CHECK(t - time == 4'000'000);
    }
    sequence = s;
    time = t;
  }
  robot.set_skin_stream(false);
  while (skin.receive(0)) continue;
  CHECK_FALSE(skin.receive(0.1));
  CHECK_THROWS(robot.set_skin_target("nowhere", 5));
}

TEST_CASE("Network: random bytes on every port, and the controller goes on") {
  Config config = quiet(1);
  SimulatedUr5 robot(config);
  robot.start();
  Random random(51);
  const Ports ports = robot.ports();
  for (int n = 0; n < 60; ++n) {
    for (const std::uint16_t port :
         {ports.rtde, ports.primary, ports.secondary, ports.realtime, ports.dashboard}) {
      raw::Tcp tcp(port);
      raw::Bytes noise(static_cast<std::size_t>(random.uniform() * 3000));
      for (auto& b : noise) b = static_cast<std::uint8_t>(random.bits() % (n % 2 == 0 ? 256 : 128));
      if (n % 3 == 0)
        for (std::size_t i = 0; i < noise.size(); i += 40) noise[i] = '\n';
      tcp.send(noise);
      if (n % 4 == 0) tcp.receive(1000, 0.01);
    }
  }
  // Garbage on the reverse socket is a stream of odd commands: the robot keeps to its limits and ends at
  // rest.
  raw::Listener listener;
  raw::Tcp script(ports.secondary);
  script.send("\n\n" + raw::stream_program(listener.port));
  {
    raw::Tcp reverse = listener.accept();
    raw::Bytes noise(32 * 200);
    for (auto& b : noise) b = static_cast<std::uint8_t>(random.bits());
    reverse.send(noise);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  CHECK(
      eventually(robot, 5, [](const Snapshot& s) { return !s.state.program_running && speed_of(s) < 1e-6; }));
  // Forty clients at once: those beyond 32 are turned away, nobody hangs.
  {
    std::vector<raw::Tcp> crowd;
    for (int i = 0; i < 40; ++i) crowd.emplace_back(ports.rtde);
    std::size_t answered = 0;
    for (auto& c : crowd) {
      c.send(raw::version_request(2));
      const raw::Bytes b = c.receive(4, 0.3);
      if (b == raw::Bytes{0, 4, 'V', 1}) ++answered;
    }
    CHECK(answered == 32);
  }
  CHECK(eventually(robot, 5, [&](const Snapshot&) {
    try {
      raw::Tcp tcp = raw::rtde_client(ports.rtde, 125, "timestamp");
      raw::start(tcp);
      return raw::read_until(tcp, 'U').payload.size() == 9;
    } catch (const std::exception&) {
      return false;
    }
  }));
}

TEST_CASE("Network: a taken port is told, and a simulator can be stopped at any time") {
  SimulatedUr5 robot(quiet());
  robot.start();
  Config other = quiet();
  other.ports.rtde = robot.ports().rtde;
  SimulatedUr5 second(other);
  CHECK_THROWS_AS(second.start(), std::runtime_error);
  CHECK_THROWS(robot.start());
  raw::Listener listener;
  raw::Tcp script(robot.ports().secondary);
  script.send(raw::stream_program(listener.port));
  raw::Tcp reverse = listener.accept();
  raw::Tcp rtde = raw::rtde_client(robot.ports().rtde, 125, "timestamp");
  raw::start(rtde);
  robot.stop();
  robot.stop();
  CHECK(reverse.closes());
  CHECK(rtde.closes());
  CHECK(robot.wait(0));
}

TEST_CASE("Primary: clients get a version and robot states ten times a second") {
  SimulatedUr5 robot(quiet(10));
  robot.start();
  raw::Tcp tcp(robot.ports().primary);
  int versions = 0, states = 0;
  for (int i = 0; i < 12; ++i) {
    const raw::Bytes head = tcp.exactly(5);
    const std::size_t size = raw::take(head, 0, 4);
    REQUIRE(size > 5);
    REQUIRE(size < 2000);
    const raw::Bytes body = tcp.exactly(size - 5);
    if (head[4] == 20) {
      ++versions;
      CHECK(body.at(9) == 3);
    } else {
      REQUIRE(head[4] == 16);
      ++states;
      CHECK(raw::take(body, 0, 4) == 47);
      CHECK(body.at(4) == 0);
      CHECK(body.at(20) == 7);  // robot mode running
      CHECK(raw::take_double(body, 47 + 5 + 41) == doctest::Approx(-pi / 2).epsilon(1e-3));
    }
  }
  CHECK(versions == 1);
  CHECK(states == 11);
}

TEST_SUITE_END();
