// Promise: a controller that is told of a payload holds it
// Tried: a simulated UR5 with 5 kg at its flange and soft servos droops, and comes back when told;
// `compliant_arm_and_hand` tells its hand's 0.95 kg, and what it tells holds the hand as the whole model
// does, to 1e-11. Also: `examples/compliant_arm_and_hand/tests`

#include "examples/simulated_ur5/controller.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "examples/simulated_ur5/random.hpp"
#include "examples/simulated_ur5/tests/streaming.hpp"
#include "skinctl/core/contract.hpp"

using namespace simulated_ur5;

namespace {

ControllerConfig exact(Series series = Series::e_series) {
  ControllerConfig c;
  c.series = series;
  c.powered = true;
  c.arm.position_noise = c.arm.velocity_noise = 0;
  return c;
}

double speed(const Controller& c) {
  double v = 0;
  for (double x : c.arm().dq()) v = std::max(v, std::abs(x));
  return v;
}

}  // namespace

TEST_CASE("Power: from power off over booting and idle to running, as the dashboard asks") {
  ControllerConfig config = exact();
  config.powered = false;
  Controller c(config);
  std::vector<RobotMode> seen{c.state().robot_mode};
  const auto run = [&](int n) {
    for (int i = 0; i < n; ++i) {
      c.step();
      if (c.state().robot_mode != seen.back()) seen.push_back(c.state().robot_mode);
    }
  };
  run(100);
  CHECK(seen == std::vector{RobotMode::power_off});
  CHECK_FALSE(c.state().power_on);
  CHECK(c.run("movej([0,0,0,0,0,0])\n").find("not running") != std::string::npos);
  CHECK(c.power_on());
  run(1000);
  CHECK(seen == std::vector{RobotMode::power_off, RobotMode::power_on, RobotMode::booting, RobotMode::idle});
  CHECK(c.brake_release());
  run(1000);
  CHECK(seen.back() == RobotMode::running);
  CHECK(c.state().joint_mode == 253);
  c.power_off();
  run(1);
  CHECK(seen.back() == RobotMode::power_off);
  // brake release powers on by itself.
  CHECK(c.brake_release());
  run(2000);
  CHECK(seen.back() == RobotMode::running);
}

TEST_CASE("Stream: the read timeout counts for the next read, in simulated time") {
  for (const Series series : {Series::cb3, Series::e_series}) {
    CAPTURE(int(series));
    const double cycle = seconds(cycle_of(series));
    Streaming s(exact(series));
    // Before the first message the robot waits for ever.
    s.steps(2000);
    CHECK(s.c.state().runtime_state == RuntimeState::playing);
    CHECK(s.c.awaits_command());
    for (int i = 0; i < 100; ++i) s.send(20, {0.5, 0, 0, 0, 0, 0}, 2);
    CHECK(s.c.awaits_command());
    s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
    const Nanoseconds last = s.c.now() - s.c.cycle();  // when the message was read
    const double speed_held = s.c.arm().target_dq()[0];
    while (s.c.arm().target_dq()[0] >= speed_held) s.c.step();
    CHECK(seconds(s.c.now() - last) >= 0.1 - 1e-9);
    CHECK(seconds(s.c.now() - last) <= 0.1 + 2 * cycle + 1e-9);
    // stopj(4): 0.5 rad/s in 0.125 s.
    const Nanoseconds began = s.c.now();
    while (s.c.arm().target_dq()[0] > 0) s.c.step();
    CHECK(seconds(s.c.now() - began) == doctest::Approx(0.125).epsilon(0.15));
    s.steps(100);
    CHECK(s.c.state().runtime_state == RuntimeState::stopped);
    CHECK(s.c.sockets().all().empty());
    CHECK(speed(s.c) < 1e-9);
    // Messages after the end change nothing.
    s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
    s.steps(10);
    CHECK(speed(s.c) < 1e-9);
  }
}

TEST_CASE("Stream: a timeout of 0 or less waits for ever") {
  for (const std::int32_t forever : {0, -1, -2147483647}) {
    Streaming s(exact());
    s.send(forever, {0.2, 0, 0, 0, 0, 0}, 2);
    s.steps(3000);
    CHECK(s.c.state().runtime_state == RuntimeState::playing);
    CHECK(s.c.arm().dq()[0] == doctest::Approx(0.2));
  }
}

TEST_CASE("Stream: servoj follows to the microradian, and holds without news") {
  Streaming s(exact());
  Joints q = ArmConfig{}.home;
  for (int i = 0; i < 500; ++i) {
    q[1] += 0.4 * 0.002;
    q[5] -= 0.2 * 0.002;
    s.send(200, q, 1);
    // Behind its lookahead of 30 ms.
    if (i > 300) CHECK(std::abs(s.c.state().target_q[1] - (q[1] - 0.4 * 0.03)) < 1e-6);
  }
  for (int i = 0; i < 250; ++i) s.send(200, q, 1);
  s.steps(50);
  CHECK(std::abs(s.c.arm().q()[5] - q[5]) < 2e-6);
  CHECK(s.c.state().runtime_state == RuntimeState::playing);
}

TEST_CASE("A payload that the controller does not know of lets a soft arm droop by its weight") {
  ControllerConfig config;
  config.powered = true;
  config.arm.unknown_payload = 5;
  config.arm.stiffness.fill(2000);
  config.arm.home = {0, 0, 0, 0, 0, 0};  // stretched out
  Controller c(config);
  for (int i = 0; i < 500; ++i) c.step();
  const double reach = 0.425 + 0.39225;  // the wrist hangs beside: levers of the maker's table
  CHECK(c.arm().q()[1] == doctest::Approx(5 * 9.81 * reach / 2000).epsilon(0.15));
  CHECK(c.arm().q()[0] == doctest::Approx(0).scale(1));
  c.run("sec told():\n  set_payload(5, [0, 0, 0])\nend\n");
  for (int i = 0; i < 500; ++i) c.step();
  CHECK(std::abs(c.arm().q()[1]) < 1e-3);
}

TEST_CASE("Stream: of several messages in one cycle the last counts") {
  Streaming s(exact());
  for (int i = 0; i < 200; ++i) {
    s.say(100, {0.9, 0, 0, 0, 0, 0}, 2);
    s.say(100, {0.1, 0, 0, 0, 0, 0}, 2);
    s.c.step();
  }
  CHECK(s.c.arm().dq()[0] == doctest::Approx(0.1));
}

TEST_CASE("Stream: changing the mode stops the motion first; mode -2 ends the program") {
  Streaming s(exact());
  for (int i = 0; i < 300; ++i) s.send(100, {0, 0, 0, 0.6, 0, 0}, 2);
  // To servoj while moving: the speed thread stops the arm, then servoing begins where it stands.
  double slowest = 1, before = s.c.state().target_dq[3];
  for (int i = 0; i < 400; ++i) {
    s.send(100, s.c.state().target_q, 1);
    CHECK(std::abs(s.c.state().target_dq[3] - before) <= 4 * 0.002 + 1e-9);  // stopj(4.0)
    before = s.c.state().target_dq[3];
    slowest = std::min(slowest, std::abs(s.c.state().target_dq[3]));
    REQUIRE(s.c.state().safety_mode == SafetyMode::normal);
  }
  CHECK(slowest == 0);
  s.send(100, {}, 0);  // idle
  s.steps(20);
  for (int i = 0; i < 100; ++i) s.send(100, {0, 0, 0, 0.6, 0, 0}, 2);
  CHECK(s.c.arm().dq()[3] > 0.3);
  s.send(100, {}, -2);
  s.steps(300);
  CHECK(s.c.state().runtime_state == RuntimeState::stopped);
  CHECK(speed(s.c) == 0);
  CHECK(s.c.sockets().all().empty());
}

TEST_CASE("Stream: unknown modes keep the arm still") {
  for (const std::int32_t mode : {3, 8, 1000000, -1, -3}) {
    Streaming s(exact());
    for (int i = 0; i < 200; ++i) s.send(100, {1, 1, 1, 1, 1, 1}, mode);
    CHECK(speed(s.c) == 0);
    CHECK(s.c.state().runtime_state == RuntimeState::playing);
  }
}

TEST_CASE("Stream: a peer that leaves ends the program") {
  Streaming s(exact());
  for (int i = 0; i < 200; ++i) s.send(0, {0.5, 0, 0, 0, 0, 0}, 2);
  s.socket->peer_gone = true;
  s.steps(300);
  CHECK(s.c.state().runtime_state == RuntimeState::stopped);
  CHECK(speed(s.c) == 0);
}

TEST_CASE("Stream: pause stops the arm and the clock of the read; play goes on") {
  Streaming s(exact());
  for (int i = 0; i < 200; ++i) s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
  CHECK(s.c.pause());
  s.steps(500);
  CHECK(s.c.state().runtime_state == RuntimeState::paused);
  CHECK(s.c.state().speed_scaling == 0);
  CHECK(speed(s.c) == 0);
  CHECK_FALSE(s.c.awaits_command());
  CHECK(s.c.play());
  for (int i = 0; i < 200; ++i) s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
  CHECK(s.c.arm().dq()[0] == doctest::Approx(0.5));
  CHECK(s.c.stop_program());
  s.steps(300);
  CHECK(s.c.state().runtime_state == RuntimeState::stopped);
}

TEST_CASE("Safety: a command beyond what the arm can do is a protective stop that must be unlocked") {
  Streaming s(exact());
  Joints q = ArmConfig{}.home;
  for (int i = 0; i < 200; ++i) {
    q[0] += 0.5 * 0.002;
    s.send(100, q, 1);
  }
  q[0] += 0.5;
  s.send(100, q, 1);
  CHECK(s.c.state().safety_mode == SafetyMode::protective_stop);
  CHECK(s.c.counters().protective_stops == 1);
  s.steps(200);
  CHECK(speed(s.c) == 0);
  CHECK(s.c.state().runtime_state == RuntimeState::paused);
  CHECK_FALSE(s.c.unlock_protective_stop());
  CHECK_FALSE(s.c.play());
  CHECK(s.c.run("stopj(1)\n").find("safety") != std::string::npos);
  s.steps(2500);
  CHECK(s.c.unlock_protective_stop());
  CHECK(s.c.state().safety_mode == SafetyMode::normal);
  // What goes on is the servoj that was under way, to the same place: only another program leads on.
  CHECK(s.c.play());
  s.send(100, s.c.state().target_q, 1);
  CHECK(s.c.state().safety_mode == SafetyMode::protective_stop);
  s.steps(2500);
  CHECK(s.c.unlock_protective_stop());
  CHECK(s.c.run("stopj(1)\n").empty());
  CHECK(s.c.state().runtime_state == RuntimeState::playing);
}

TEST_CASE("Safety: joint limits and emergency stops bring the arm to rest") {
  {
    ControllerConfig config = exact();
    config.arm.home = {0, -pi / 2, 2.9, 0, 0, 0};
    Streaming s(config);
    for (int i = 0; i < 1000 && s.c.state().safety_mode == SafetyMode::normal; ++i)
      s.send(100, {0, 0, 0.5, 0, 0, 0}, 2);
    CHECK(s.c.state().safety_mode == SafetyMode::protective_stop);
    s.steps(200);
    CHECK(speed(s.c) == 0);
    CHECK(s.c.arm().q()[2] < pi + 0.01);
  }
  Streaming s(exact());
  for (int i = 0; i < 200; ++i) s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
  s.c.emergency_stop();
  s.steps(300);
  CHECK(s.c.state().safety_mode == SafetyMode::robot_emergency_stop);
  CHECK(s.c.state().robot_mode == RobotMode::power_off);
  CHECK(speed(s.c) == 0);
  CHECK_FALSE(s.c.power_on());
  s.c.restart_safety();
  CHECK(s.c.power_on());
}

TEST_CASE("Contact: a strong touch on a stiff arm is a protective stop, and the forces are reported") {
  ControllerConfig config = exact();
  Touch t;
  t.link = 2;
  t.point = {-0.2, 0, 0.06};
  t.normal = {0, 0, 1};
  t.stiffness = 20000;
  t.travel = 0.02;
  t.gap = 0.02;
  config.touches = {t};
  {
    Streaming s(config);
    for (int i = 0; i < 1000; ++i) s.send(100, config.arm.home, 1);
    CHECK(s.c.state().safety_mode == SafetyMode::protective_stop);
    CHECK(s.c.world().results()[0].peak_force > 150);
  }
  config.protective_force = 0;
  Streaming s(config);
  double felt = 0;
  for (int i = 0; i < 400; ++i) {
    s.send(100, config.arm.home, 1);
    const auto& w = s.c.state().wrench_by_currents;
    felt = std::max(felt, norm({w[0], w[1], w[2]}));
  }
  CHECK(felt == doctest::Approx(400).epsilon(0.01));
  CHECK(s.c.state().safety_mode == SafetyMode::normal);
  // The scenario's clock starts with the first motion command.
  CHECK(s.c.scenario_time() == doctest::Approx(0.8).epsilon(0.005));
}

TEST_CASE(
    "ForceSensor: an e-Series feels what touches link 5, less the payload it was told, along the base's "
    "axes") {
  ControllerConfig config = exact();
  config.series = Series::e_series;
  config.force_sensor.force_noise = config.force_sensor.moment_noise = 0;
  config.arm.unknown_payload = 2;
  config.arm.payload_centre = {0.01, 0, 0.08};
  Touch push;
  push.link = 5;
  push.point = {0, 0, 0.2};
  push.normal = {0, 0, 1};  // onto the tool's end: the finger pushes it along its -z
  push.profile = {{0, 0.1, 1}, {20, 20, 20}};
  push.impose_force = true;
  Touch elbow = push;
  elbow.link = 2, elbow.point = {-0.2, 0, 0.06}, elbow.start = 3;
  config.touches = {push, elbow};
  const auto at = [&](const ControllerConfig& c, double t) {
    Streaming s(c);
    for (int k = 0; k < static_cast<int>(t / 0.002); ++k) s.send(100, c.arm.home, 1);
    return s.c.state();
  };
  const Pose flange = forward_kinematics(config.arm.home).flange;
  const auto force = [](const RobotState& s) {
    return Vec3{s.actual_tcp_force[0], s.actual_tcp_force[1], s.actual_tcp_force[2]};
  };
  // Untouched: the weight that nobody told it; its moment about the flange, where the tool's point is.
  const RobotState untouched = at(config, 0.3);
  CHECK(norm(force(untouched) - Vec3{0, 0, -19.62}) < 1e-6);
  const Vec3 moment = cross(flange.rotate(config.arm.payload_centre), {0, 0, -19.62});
  CHECK(untouched.actual_tcp_force[3] == doctest::Approx(moment.x));
  CHECK(untouched.actual_tcp_force[4] == doctest::Approx(moment.y));
  CHECK(untouched.actual_tcp_force[5] == doctest::Approx(moment.z));
  // Pushed: along the flange's axes the raw wrench has it, with the weight.
  const RobotState pushed = at(config, 1);
  CHECK(norm(force(pushed) - force(untouched) + 20 * flange.z) < 1e-3);
  const Vec3 raw{pushed.raw_wrench[0], pushed.raw_wrench[1], pushed.raw_wrench[2]};
  CHECK(norm(flange.rotate(raw) - force(pushed)) < 1e-6);
  CHECK(norm(force(at(config, 4)) - force(untouched)) <
        1e-6);                  // the forearm is on the other side of the sensor
  config.series = Series::cb3;  // has none: its currents know of all that acts
  CHECK(norm(force(at(config, 0.25)) + 20 * flange.z) < 1e-3);
}

TEST_CASE("ForceSensor, Arm: noise, bias and creep from their time on; warm motors rub less") {
  ControllerConfig config = exact();
  config.series = Series::e_series;
  config.force_sensor.force_noise = 0.3;
  config.force_sensor.force_bias = {0, 4, 0};
  config.force_sensor.force_creep = {0, 0, 1};
  config.force_sensor.bias_from = 1;
  config.arm.torque_bias = {0, 0, 3, 0, 0, 0};
  config.arm.torque_noise = {};
  config.arm.warming = 20;
  config.arm.warming_time = 1;
  config.force_sensor.force_per_kelvin = {0.1, 0, 0};
  Streaming s(config);
  Vec3 sum, square;
  const auto read = [&](int steps) {
    sum = square = {};
    for (int k = 0; k < steps; ++k) {
      s.send(100, config.arm.home, 1);
      const auto& w = s.c.state().raw_wrench;
      sum = sum + Vec3{w[0], w[1], w[2]};
      square.y += w[1] * w[1];
    }
    sum = (1.0 / steps) * sum;
  };
  read(450);
  CHECK(std::abs(sum.y) < 0.1);
  CHECK(std::sqrt(square.y / 450 - sum.y * sum.y) == doctest::Approx(0.3).epsilon(0.15));
  read(1550);  // until 4 s
  read(500);
  CHECK(sum.y == doctest::Approx(4).epsilon(0.03));
  CHECK(sum.z == doctest::Approx(3.5).epsilon(0.03));
  CHECK(sum.x == doctest::Approx(0.1 * 20).epsilon(0.05));
  CHECK(s.c.state().temperatures[2] == doctest::Approx(48).epsilon(0.01));
  ControllerConfig unbiased = config;
  unbiased.arm.torque_bias = {};
  Streaming u(unbiased);
  for (int k = 0; k < 2500; ++k) u.send(100, config.arm.home, 1);
  CHECK(s.c.state().torque[2] - u.c.state().torque[2] == doctest::Approx(3));
}

TEST_CASE("Controller: from the first command on everything is a function of seed and commands") {
  const auto trace = [](int idle_steps, std::uint64_t seed) {
    ControllerConfig config = exact();
    config.arm.position_noise = 1e-4;
    config.seed = seed;
    Touch t;
    t.link = 2;
    t.point = {-0.2, 0, 0.06};
    config.touches = {t};
    config.cells.resize(4);
    for (std::size_t i = 0; i < 4; ++i) {
      config.cells[i].id = static_cast<std::uint32_t>(i);
      config.cells[i].link = 2;
      config.cells[i].position = {-0.15 - 0.03 * static_cast<double>(i), 0, 0.06};
      config.cells[i].normal = {0, 0, 1};
      complete(config.cells[i]);
    }
    Streaming s(config);
    s.steps(idle_steps);
    std::vector<double> out;
    Nanoseconds begin{};
    s.c.on_skin = [&](Nanoseconds now, const std::vector<SkinSample>& samples) {
      if (begin == 0) return;
      out.push_back(static_cast<double>(now - begin));
      for (const SkinSample& x : samples) out.push_back(static_cast<double>(x.force[0]) + x.proximity);
    };
    begin = s.c.now();
    for (int i = 0; i < 600; ++i) {
      s.send(100, {0.1 * std::sin(0.01 * i), 0, 0, 0, 0, 0}, 2);
      for (const double q : s.c.state().actual_q) out.push_back(q);
      out.push_back(s.c.state().tcp_force);
    }
    return out;
  };
  const auto a = trace(3, 1);
  CHECK(a == trace(3, 1));
  CHECK(a == trace(1234, 1));
  CHECK(a != trace(3, 2));
}

TEST_CASE("Scripts: movej, outputs, registers and texts run line by line") {
  Controller c(exact());
  std::vector<std::string> said;
  c.on_notice = [&](const Notice& n) { said.push_back(n.text); };
  REQUIRE(c.run("def f():\n"
                "  set_standard_digital_out(2, True)\n"
                "  movej([0.3,-1.5,-1.5,-1.5,1.5,0.1], a=3, v=1)\n"
                "  set_tool_digital_out(0, True)\n"
                "  write_output_integer_register(3, 42)\n"
                "  write_output_float_register(4, 0.5)\n"
                "  write_output_boolean_register(70, True)\n"
                "  sleep(0.1)\n"
                "  textmsg(\"done\")\n"
                "end\n")
              .empty());
  c.step();
  CHECK(c.state().digital_outputs == 4);
  CHECK(c.state().program_running);
  int steps = 0;
  while (c.state().runtime_state != RuntimeState::stopped && ++steps < 5000) c.step();
  CHECK(steps < 1000);
  CHECK(c.state().digital_outputs == (4u | 1u << 16));
  CHECK(c.state().outputs.integers[3] == 42);
  CHECK(c.state().outputs.doubles[4] == 0.5);
  CHECK(c.state().outputs.bits[70]);
  CHECK(c.arm().q()[0] == doctest::Approx(0.3));
  CHECK(std::find(said.begin(), said.end(), "done") != said.end());
}

TEST_CASE("Scripts: a new program replaces the one that runs; a secondary one runs beside it") {
  Streaming s(exact());
  for (int i = 0; i < 200; ++i) s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
  CHECK(s.c.run("sec o():\n set_standard_digital_out(0, True)\n stopj(2)\nend\n").empty());
  CHECK(s.c.state().digital_outputs == 1);
  CHECK_FALSE(s.c.sockets().all().empty());
  s.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
  CHECK(s.c.arm().dq()[0] == doctest::Approx(0.5));
  // A line without `sec` is a program of its own: the way to stop a robot from outside.
  CHECK(s.c.run("stopj(2.0)\n").empty());
  CHECK(s.c.sockets().all().empty());
  int steps = 0;
  while (s.c.arm().target_dq()[0] > 0) {
    s.c.step();
    ++steps;
  }
  CHECK(steps * 0.002 == doctest::Approx(0.25).epsilon(0.05));
  s.steps(100);
  CHECK(s.c.state().runtime_state == RuntimeState::stopped);
  // A movej that follows a motion waits until the arm stands.
  Streaming t(exact());
  for (int i = 0; i < 200; ++i) t.send(100, {0.5, 0, 0, 0, 0, 0}, 2);
  CHECK(t.c.run("movej([0,-1.5,-1.5,-1.5,1.5,0])\n").empty());
  double last = t.c.arm().target_dq()[0];
  for (int i = 0; i < 3000 && t.c.state().runtime_state != RuntimeState::stopped; ++i) {
    t.c.step();
    CHECK(std::abs(t.c.arm().target_dq()[0] - last) <= 40 * 0.002 + 1e-9);
    last = t.c.arm().target_dq()[0];
  }
  CHECK(t.c.arm().q()[0] == doctest::Approx(0).scale(1));
  CHECK(t.c.state().runtime_state == RuntimeState::stopped);
}

TEST_CASE("Scripts: an RTDE watchdog stops or pauses when its input falls silent") {
  for (const bool stops : {true, false}) {
    std::string program = raw::stream_program(50001);
    program.insert(program.find("  steptime"),
                   std::string("  rtde_set_watchdog(\"input_int_register_0\", 10, \"") +
                       (stops ? "stop" : "pause") + "\")\n");
    Streaming s(exact(), program);
    CHECK(s.c.watched_input() == "input_int_register_0");
    for (int i = 0; i < 500; ++i) {
      if (i % 20 == 0) s.c.watchdog_fed();
      s.send(100, {0.2, 0, 0, 0, 0, 0}, 2);
    }
    CHECK(s.c.arm().dq()[0] == doctest::Approx(0.2));
    for (int i = 0; i < 300; ++i) s.send(100, {0.2, 0, 0, 0, 0, 0}, 2);
    CHECK(speed(s.c) == 0);
    CHECK(s.c.state().runtime_state == (stops ? RuntimeState::stopped : RuntimeState::paused));
  }
}

TEST_CASE("Speed slider: slows the stream, and 0 stands still") {
  Streaming s(exact());
  s.c.inputs().speed_slider_mask = 1;
  s.c.inputs().speed_slider_fraction = 0.5;
  s.c.inputs_written({.slider = true});
  for (int i = 0; i < 200; ++i) s.send(100, {0.4, 0, 0, 0, 0, 0}, 2);
  CHECK(s.c.arm().dq()[0] == doctest::Approx(0.2));
  CHECK(s.c.state().speed_scaling == 0.5);
  s.c.inputs().speed_slider_fraction = 0;
  s.c.inputs_written({.slider = true});
  for (int i = 0; i < 200; ++i) s.send(100, {0.4, 0, 0, 0, 0, 0}, 2);
  CHECK(std::abs(s.c.arm().dq()[0]) < 1e-6);
  s.c.inputs().speed_slider_mask = 0;
  s.c.inputs().speed_slider_fraction = 1;
  s.c.inputs_written({.slider = true});
  CHECK(s.c.state().target_speed_fraction == 0);
}

TEST_CASE("Stream: whatever comes, the arm obeys its limits and ends at rest") {
  Random random(31);
  Streaming s(exact());
  for (int i = 0; i < 5000; ++i) {
    for (auto n = static_cast<std::size_t>(random.uniform() * 200); n > 0; --n)
      s.socket->received.push_back(random.uniform() < 0.7 ? 0 : static_cast<std::uint8_t>(random.bits()));
    s.c.step();
    for (std::size_t j = 0; j < joint_count; ++j) {
      REQUIRE(std::isfinite(s.c.arm().q()[j]));
      REQUIRE(std::abs(s.c.arm().target_dq()[j]) <= pi + 1e-9);
    }
  }
  s.socket->peer_gone = true;
  s.steps(1000);
  CHECK(speed(s.c) == 0);
}

TEST_CASE("Controller: refuses a configuration that cannot work") {
  ControllerConfig c = exact();
  c.protective_force = -1;
  CHECK_THROWS_AS(Controller{c}, skinctl::ConfigurationError);
  c = exact();
  c.skin.period = 300'000;
  CHECK_THROWS_AS(Controller{c}, skinctl::ConfigurationError);
}
