// A program of the size and means of the makers' external-control script, sent in their way: three sockets,
// threads, servoj, speedj, torques, trajectories by points and by splines, script commands. Raw bytes only.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

using namespace simulated_ur5;

namespace {

constexpr int stopped = -2, idle = 0, servo = 1, speed = 2, forward = 3, freedrive = 6, torque = 8;

std::string external_control(std::uint16_t reverse, std::uint16_t trajectory, std::uint16_t commands) {
  const auto port = [](std::uint16_t p) { return std::to_string(p); };
  std::string text = R"(def externalControl():
  steptime = get_steptime()
  textmsg("steptime=", steptime)
  MULT = 1000000
  IDLE = 0
  global mode = -1
  global state = -1
  global target = get_joint_positions()
  global last = target
  global wanted_speed = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
  global wanted_torque = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
  global points = 0
  global spline_speed = [0, 0, 0, 0, 0, 0]
  global result = 0
  global viscous = [0.9, 0.9, 0.8, 0.9, 0.9, 0.9]
  global coulomb = [0.8, 0.8, 0.7, 0.8, 0.8, 0.8]
  mover = 0
  walker = 0
  def reachable(from, to, time):
    local i = 0
    while i < 6:
      local v = norm(to[i] - from[i]) / time
      if v > 20.0:
        local words = str_cat(str_cat("Velocity ", v), str_cat(" in joint ", i))
        textmsg(words)
        return False
      end
      i = i + 1
    end
    return True
  end
  def set_target(q):
    state = 1
    if reachable(target, q, steptime):
      last = target
      target = q
    elif reachable(get_joint_positions(), q, steptime):
      last = target
      target = q
    end
  end
  thread servos():
    while mode == 1:
      enter_critical
      q = target
      go_on = state == IDLE
      s = state
      if state > -1:
        state = IDLE
      end
      if go_on:
        last = target
        target = target + (get_target_joint_speeds() * steptime)
        q = target
        servoj(q, t=steptime, lookahead_time=0.03, gain=2000)
      elif s == 1:
        servoj(q, t=steptime, lookahead_time=0.03, gain=2000)
      else:
        sync()
      end
      exit_critical
    end
    stopj(4.0)
  end
  thread speeds():
    while mode == 2:
      qd = wanted_speed
      speedj(qd, 40.0, steptime)
    end
    stopj(4.0)
  end
  thread torques():
    while mode == 8:
      direct_torque(wanted_torque, viscous_scale=viscous, coulomb_scale=coulomb)
    end
    stopj(4.0)
  end
  def spline(end_q, end_qd, time, is_last = False):
    local start_q = get_joint_positions()
    local c1 = spline_speed
    local c2 = (-3 * start_q + end_q * 3 - spline_speed * 2 * time - end_qd * time) / pow(time, 2)
    local c3 = (2 * start_q - 2 * end_q + spline_speed * time + end_qd * time) / pow(time, 3)
    local t = 0.0
    while (time - t) > get_steptime():
      t = t + get_steptime()
      step(c1, c2, c3, t, get_steptime())
    end
    step(c1, c2, c3, time, time - t)
  end
  def step(c1, c2, c3, t, dt):
    local before = spline_speed
    spline_speed = c1 + 2.0 * t * c2 + 3.0 * pow(t, 2) * c3
    speedj(spline_speed, largest((spline_speed - before) / dt), dt)
  end
  def largest(list):
    local i = 1
    local most = norm(list[0])
    while i < get_list_length(list):
      if norm(list[i]) > most:
        most = norm(list[i])
      end
      i = i + 1
    end
    return most
  end
  thread walk():
    result = 0
    spline_speed = [0, 0, 0, 0, 0, 0]
    enter_critical
    while result == 0 and points > 0:
      local raw = socket_read_binary_integer(21, "trajectory_socket", 0.5)
      points = points - 1
      if raw[0] > 0:
        local q = [raw[1] / MULT, raw[2] / MULT, raw[3] / MULT, raw[4] / MULT, raw[5] / MULT, raw[6] / MULT]
        local time = raw[19] / 1000
        if raw[21] == 0:
          movej(q, a = raw[13] / MULT, v = raw[14] / MULT, t = time, r = 0)
        elif raw[21] == 1:
          movel(p[q[0], q[1], q[2], q[3], q[4], q[5]], a = raw[13] / MULT, v = raw[14] / MULT, t = time)
        elif raw[21] == 51 or
          raw[21] == 52:
          qd = [raw[7] / MULT, raw[8] / MULT, raw[9] / MULT, raw[10] / MULT, raw[11] / MULT, raw[12] / MULT]
          spline(q, qd, time, points == 0)
        end
      else:
        result = 2
      end
    end
    exit_critical
    stopj(4.0)
    socket_send_int(result, "trajectory_socket")
  end
  thread commands():
    while mode > -2:
      raw = socket_read_binary_integer(28, "command_socket", 0)
      if raw[0] > 0:
        if raw[1] == 1:
          set_payload(raw[2] / MULT, [raw[3] / MULT, raw[4] / MULT, raw[5] / MULT])
        elif raw[1] == 10:
          tcp_offset = p[raw[2] / MULT, raw[3] / MULT, raw[4] / MULT, raw[5] / MULT, raw[6] / MULT, raw[7] / MULT]
          set_tcp(tcp_offset)
        end
      end
    end
  end
  def connect(host, port, name, attempts = 5, dt = 0.2):
    attempt = 0
    while attempt < attempts:
      if socket_open(host, port, name):
        return True
      end
      sleep(dt)
      attempt = attempt + 1
    end
    return False
  end
)";
  // The makers' script is 48 kB long.
  while (text.size() < 44'000) {
    const std::string n = std::to_string(text.size());
    text += "  # a comment with def, thread, if and end in it: " + n + "\n  def unused_" + n +
            "(a, b = 1):\n    local c = [a, b, " + n +
            "]\n    if c[0] == c[1]:\n      return c[2] * 2.5\n    end\n" +
            "    return str_cat(\"n\", c[2])\n  end\n";
  }
  text += "  if not (connect(\"127.0.0.1\", " + port(trajectory) +
          ", \"trajectory_socket\") and connect(\"127.0.0.1\", " + port(commands) +
          ", \"command_socket\") and connect(\"127.0.0.1\", " + port(reverse) +
          R"(, "reverse_socket")):
    popup("not connected", title="Error", blocking=False, error=True)
    halt
  end
  textmsg("active")
  global read_timeout = 0.0
  thread_commands = run commands()
  while mode > -2:
    enter_critical
    got = socket_read_binary_integer(8, "reverse_socket", read_timeout)
    if got[0] > 0:
      read_timeout = got[1] / 1000.0
      if mode != got[8]:
        if mode == 3:
          kill walker
        elif mode == 6:
          end_freedrive_mode()
        end
        mode = got[8]
        join mover
        if mode == 1:
          target = get_joint_positions()
          mover = run servos()
        elif mode == 2:
          mover = run speeds()
        elif mode == 8:
          mover = run torques()
        elif mode == 3:
          kill mover
          stopj(4.0)
        end
      end
      values = [got[2] / MULT, got[3] / MULT, got[4] / MULT, got[5] / MULT, got[6] / MULT, got[7] / MULT]
      if mode == 1:
        set_target(values)
      elif mode == 2:
        wanted_speed = values
      elif mode == 8:
        wanted_torque = values
      elif mode == 3:
        if got[2] == 1:
          kill walker
          points = got[3]
          walker = run walk()
        elif got[2] == -1:
          kill walker
          stopj(4.0)
          socket_send_int(1, "trajectory_socket")
        end
      elif mode == 6:
        freedrive_mode()
      end
    else:
      textmsg("Socket timed out")
      mode = -2
      kill mover
      kill walker
      stopj(4.0)
      halt
    end
    exit_critical
  end
  join mover
  stopj(4.0)
  socket_close("reverse_socket")
end
)";
  return text;
}

/// The driver's side: three servers that the program connects to.
struct Driver {
  explicit Driver(Config config) : robot((config.ports = {0, 0, 0, 0, 0}, config)) {
    robot.start();
    raw::Tcp script(robot.ports().primary);
    std::string program =
        "stop program\n" + external_control(reverse_server.port, trajectory_server.port, command_server.port);
    if (config.controller.series == Series::cb3) {
      // The makers' client leaves torques out for controllers that do not know them.
      const auto at = program.find("direct_torque(");
      program.replace(at, program.find('\n', at) - at, "sync()");
    }
    script.send(program);
    trajectory.emplace(trajectory_server.accept());
    command.emplace(command_server.accept());
    reverse.emplace(reverse_server.accept());
  }
  void send(int mode, const std::array<double, 6>& values, std::int32_t timeout = 2000) {
    reverse->send(raw::reverse_message(timeout, values, mode));
  }
  /// Keeps sending until the robot is as expected; false: it was not within `limit` seconds.
  template <class Condition>
  bool hold_until(int mode, const std::array<double, 6>& values, Condition&& as_expected, double limit = 10) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
    do {
      send(mode, values);
      std::this_thread::sleep_for(std::chrono::milliseconds(4));
      if (as_expected(now())) return true;
    } while (std::chrono::steady_clock::now() < end);
    return false;
  }
  void hold(int mode, const std::array<double, 6>& values, double time) {
    hold_until(mode, values, [](const Snapshot&) { return false; }, time);
  }
  /// Numbers that are no joint values: mode 3 with its action and count.
  void send_whole(std::int32_t timeout, std::int32_t first, std::int32_t second, int mode) {
    raw::Bytes b;
    for (const std::int32_t v : {timeout, first, second, 0, 0, 0, 0, mode})
      raw::put(b, static_cast<std::uint32_t>(v), 4);
    reverse->send(b);
  }
  void point(const std::array<double, 6>& q, const std::array<double, 6>& qd, double a, double v, double time,
             int type) {
    raw::Bytes b;
    const auto put = [&](double x) {
      raw::put(b, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(x))), 4);
    };
    for (const double x : q) put(x * 1e6);
    for (const double x : qd) put(x * 1e6);
    put(a * 1e6);
    put(v * 1e6);
    for (int i = 0; i < 4; ++i) put(0);
    put(time * 1000);
    put(0);
    put(type);
    trajectory->send(b);
  }
  Snapshot now() { return robot.snapshot(); }
  /// The program ends and the arm stands.
  bool comes_to_rest(double limit = 10) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
    while (std::chrono::steady_clock::now() < end) {
      const Snapshot s = now();
      double v = 0;
      for (const double x : s.true_dq) v = std::max(v, std::abs(x));
      if (!s.state.program_running && v < 1e-6) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  bool running() { return now().state.program_running; }

  raw::Listener reverse_server, trajectory_server, command_server;
  SimulatedUr5 robot;
  std::optional<raw::Tcp> reverse, trajectory, command;
};

Config config(Series series = Series::e_series) {
  Config c;
  c.controller.series = series;
  c.controller.powered = true;
  c.controller.arm.position_noise = c.controller.arm.velocity_noise = 0;
  return c;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("External control: connects, servos, speeds, torques, and stops when told") {
  CHECK(external_control(1, 2, 3).size() > 44'000);
  Driver d(config());
  d.hold(idle, {}, 0.02);
  CHECK(d.running());
  const auto home = d.now().true_q;
  std::array<double, 6> goal = home;
  for (int i = 0; i < 20; ++i) {
    goal[0] += 0.005;
    d.hold(servo, goal, 0.004);
  }
  CHECK(d.hold_until(servo, goal, [&](const Snapshot& s) { return std::abs(s.true_q[0] - goal[0]) < 1e-4; }));
  CHECK(d.hold_until(speed, {0, 0, 0, 0, 0.3, 0},
                     [](const Snapshot& s) { return std::abs(s.true_dq[4] - 0.3) < 1e-3; }));
  CHECK(d.hold_until(torque, {10, 0, 0, 0, 0, 0}, [](const Snapshot& s) {
    return s.true_dq[0] > 0.1 && s.state.control_mode == ControlMode::torque;
  }));
  CHECK(d.hold_until(freedrive, {},
                     [](const Snapshot& s) { return s.state.control_mode == ControlMode::teach; }));
  CHECK(d.running());
  d.send(stopped, {});
  CHECK(d.reverse->closes(10));
  CHECK(d.comes_to_rest());
}

TEST_CASE("External control: a commander that falls silent ends the program and the motion") {
  Driver d(config(Series::cb3));
  CHECK(d.hold_until(speed, {0.3, 0, 0, 0, 0, 0},
                     [](const Snapshot& s) { return std::abs(s.true_dq[0] - 0.3) < 1e-3; }));
  d.send(speed, {0.3, 0, 0, 0, 0, 0}, 100);
  CHECK(d.comes_to_rest());
}

TEST_CASE("External control: trajectories of points and splines arrive and say so; a cancelled one too") {
  Driver d(config());
  d.hold(idle, {}, 0.02);
  const auto home = d.now().true_q;
  auto a = home, b = home;
  a[0] += 0.1;
  b[4] -= 0.1;
  const auto follow = [&](double limit) -> std::int32_t {
    for (int i = 0; i < static_cast<int>(limit * 100); ++i) {
      d.send_whole(2000, 0, 0, forward);
      const raw::Bytes answer = d.trajectory->receive(4, 0.01);
      if (answer.size() == 4) return static_cast<std::int32_t>(raw::take(answer, 0, 4));
    }
    return -1;
  };
  d.send_whole(2000, 1, 2, forward);
  d.point(a, {}, 3, 1.5, 0, 0);
  d.point(b, {}, 3, 1.5, 0, 0);
  CHECK(follow(10) == 0);
  for (std::size_t i = 0; i < 6; ++i) CHECK(d.now().true_q[i] == doctest::Approx(b[i]).epsilon(1e-3));
  // Cubic splines there and on, each in half a second.
  d.send_whole(2000, 1, 2, forward);
  d.point(a, {0.1, 0, 0, 0, 0.1, 0}, 0, 0, 0.5, 51);
  d.point(home, {}, 0, 0, 0.5, 52);
  CHECK(follow(10) == 0);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(d.now().true_q[i] - home[i]) < 0.02);
  // Cancelled on its way.
  auto far = home;
  far[0] += 1;
  d.send_whole(2000, 1, 1, forward);
  d.point(far, {}, 1, 0.5, 0, 0);
  CHECK(follow(0.2) == -1);
  d.send_whole(2000, -1, 0, forward);
  CHECK(follow(10) == 1);
  CHECK(d.now().true_q[0] < home[0] + 0.9);
  // Points that do not come are told.
  d.send_whole(2000, 1, 1, forward);
  CHECK(follow(10) == 2);
  CHECK(d.running());
}

TEST_CASE("External control: script commands set payload and tool") {
  Driver d(config());
  d.hold(idle, {}, 0.02);
  const auto command = [&](std::int32_t number, std::initializer_list<double> values) {
    raw::Bytes b;
    raw::put(b, static_cast<std::uint32_t>(number), 4);
    for (const double v : values)
      raw::put(b, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(v * 1e6))), 4);
    b.resize(28 * 4);
    d.command->send(b);
  };
  command(1, {1.5, 0.01, 0.02, 0.03});
  command(10, {0, 0, 0.2, 0, 0, 0});
  CHECK(d.hold_until(idle, {}, [](const Snapshot& s) { return s.state.tcp_offset[2] == 0.2; }));
  CHECK(d.now().state.payload == 1.5);
  CHECK(d.now().state.payload_cog.z == 0.03);
}

TEST_SUITE_END();
