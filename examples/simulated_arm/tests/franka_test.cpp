// Franka's FCI: bytes of its messages, what a client is told, and a simulated FR3 at the other end.
//
// Promise: messages of Franka's FCI are read whatever the bytes, and a simulated FR3 keeps its rules
// Tried: truncated, mutated and random messages; a client that is late, jumps, or talks nonsense

#include "examples/simulated_arm/franka.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <random>

#include "examples/adapters/clocked_driver.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace simulated_arm;
using namespace adapters::franka;
using adapters::ClockedStateOf;
using adapters::ClockFault;
using adapters::Read;
using adapters::Timeout;

namespace {

State full_state() {
  State s;
  s.number = 70'000;
  s.mode = Mode::move, s.generator = Generator::position, s.control = Control::joint_impedance;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto x = 0.1 * static_cast<double>(i);
    s.q[i] = x, s.told[i] = x + 0.01, s.dq[i] = -x, s.told_dq[i] = 1 - x, s.told_ddq[i] = 2 - x;
    s.motor_torque[i] = 10 + x, s.told_torque[i] = 20 + x, s.external[i] = 30 + x;
  }
  s.wrench = {1, 2, 3, 4, 5, 6};
  s.errors.set(6), s.reasons.set(40);
  s.success = 0.97;
  return s;
}
std::vector<std::uint8_t> bytes_of(const auto& message) {
  std::vector<std::uint8_t> out(4096);
  out.resize(print(message, out));
  return out;
}
double real_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  double x = 0;
  std::memcpy(&x, bytes.data() + at, 8);
  return x;
}
SpringArm::Model fr3() {
  return skinctl::calibrated_from<skinctl::Chain<7>>(skinctl::read_urdf(SIMULATED_ARM_FR3));
}

/// A client of its own, for what no driver does.
class Client {
 public:
  explicit Client(std::uint16_t port) {
    stream_.connect("127.0.0.1", port, "the robot", Timeout(2000));
    udp_ = adapters::UdpSocket::at("127.0.0.1", 0);
  }
  void say(Function function, std::span<const std::uint8_t> payload = {}) {
    std::array<std::uint8_t, 512> bytes;
    const auto size = print(Message{function, ++requests_, payload}, bytes);
    REQUIRE(stream_.write({bytes.data(), size}, Timeout(1000)));
  }
  /// The status of the next answer; 255: it hung up.
  std::uint8_t heard() {
    Message m;
    while (!inbox_.next(m)) {
      std::size_t count = 0;
      if (stream_.read_some(inbox_.room(), count, Timeout(3000)) != Read::some) return 255;
      inbox_.took(count);
    }
    return m.payload.empty() ? 254 : m.payload[0];
  }
  std::uint8_t ask(Function function, std::span<const std::uint8_t> payload = {}) {
    say(function, payload);
    return heard();
  }
  std::uint8_t connect(std::uint16_t version = adapters::franka::version) {
    std::array<std::uint8_t, 4> bytes;
    return ask(Function::connect, {bytes.data(), print(Connect{version, udp_.port()}, bytes)});
  }
  std::uint8_t move(Control control, Generator generator) {
    std::array<std::uint8_t, 64> bytes;
    return ask(Function::move, {bytes.data(), print(Move{control, generator}, bytes)});
  }
  std::uint8_t set(Function function, std::span<const double> numbers) {
    std::array<std::uint8_t, 512> bytes;
    return ask(function, {bytes.data(), print(numbers, bytes)});
  }
  State state() {
    State s;
    std::array<std::uint8_t, 4096> bytes;
    std::size_t size = 0;
    do REQUIRE(udp_.receive(bytes, size, std::chrono::steady_clock::now() + Timeout(3000)) == Read::some);
    while (!parse({bytes.data(), size}, s));
    return s;
  }
  void forget() { due_.reset(); }
  void command(const Command& c) {
    const auto bytes = bytes_of(c);
    REQUIRE(udp_.send(bytes));
  }
  /// Answers states by `command(state, k)` until the motion ends; the last state.
  template <class F>
  State follow(int cycles, F&& f) {
    State s = due_.value_or(State{});
    while (s.mode != Mode::move) s = state();
    for (int k = 0; k < cycles && s.mode == Mode::move; ++k) {
      Command c = f(s, k);
      c.number = s.number;
      command(c);
      s = state();
    }
    due_.reset();
    if (s.mode == Mode::move) due_ = s;
    return s;
  }

 private:
  adapters::Stream stream_;
  adapters::UdpSocket udp_;
  Inbox inbox_;
  std::uint32_t requests_ = 0;
  std::optional<State> due_;  ///< of a motion, without an answer yet
};
Config in_lock_step() {
  Config c;
  c.speed = 0;
  return c;
}

}  // namespace

TEST_CASE("FCI: a state and a command have their sizes and places, and come back as they were") {
  const State s = full_state();
  const auto bytes = bytes_of(s);
  REQUIRE(bytes.size() == 2373);
  CHECK((bytes[0] == 0x70 && bytes[1] == 0x11 && bytes[2] == 1 && bytes[3] == 0));
  // After 8 bytes, six poses of 128 and 26 + 4 numbers: the torques of the joints.
  CHECK(real_at(bytes, 8 + 6 * 128 + 30 * 8) == 10);
  CHECK(real_at(bytes, 8 + 6 * 128 + 30 * 8 + 21 * 8 + 8) == 0.1);  // q of the second joint
  CHECK((bytes[2280] == 1 && bytes[2281] == 0 && bytes[2282 + 6] == 1 && bytes[2282 + 41 + 40] == 1));
  CHECK((bytes[2364] == 2 && real_at(bytes, 2365) == 0.97));
  State back;
  REQUIRE(parse(bytes, back));
  CHECK((back.number == s.number && back.pose == s.pose && back.q == s.q && back.told == s.told));
  CHECK((back.dq == s.dq && back.told_dq == s.told_dq && back.told_ddq == s.told_ddq));
  CHECK((back.motor_torque == s.motor_torque && back.told_torque == s.told_torque));
  CHECK((back.external == s.external && back.wrench == s.wrench && back.success == s.success));
  CHECK((back.mode == s.mode && back.generator == s.generator && back.control == s.control));
  CHECK((back.errors == s.errors && back.reasons == s.reasons));

  const Command c{9, {1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14}, {-1, 0, 0, 0, 0, 0, 1}, true};
  const auto sent = bytes_of(c);
  REQUIRE(sent.size() == 371);
  CHECK((real_at(sent, 8) == 1 && real_at(sent, 8 + 7 * 8) == 8 && real_at(sent, 314) == -1));
  CHECK((sent[312] == 0 && sent[313] == 1 && sent[370] == 1));
  Command read;
  REQUIRE(parse(sent, read));
  CHECK((read.number == 9 && read.q == c.q && read.dq == c.dq && read.torque == c.torque && read.finished));
  auto wrong = s;
  wrong.dq[3] = std::nan("");
  CHECK_FALSE(parse(bytes_of(wrong), back));
  for (std::size_t n = 0; n < bytes.size(); ++n) CHECK_FALSE(parse({bytes.data(), n}, back));
  for (std::size_t room = 0; room < sent.size(); ++room) {
    std::vector<std::uint8_t> out(room);
    CHECK(print(c, out) == 0);
  }
  CHECK(std::string(name(25)) == "communication_constraints_violation");
  CHECK(std::string(name(40)) == "base_acceleration_invalid_reading");
  CHECK(std::string(name(4000)) == "unknown_error");
}

TEST_CASE("FCI: requests come in pieces, and what is none ends the stream") {
  std::array<std::uint8_t, 64> payload;
  std::vector<std::uint8_t> stream(256);
  auto size = print(Move{Control::torque, Generator::velocity}, payload);
  REQUIRE(size == 56);
  size = print(Message{Function::move, 7, {payload.data(), size}}, stream);
  REQUIRE(size == 68);
  CHECK((stream[0] == 1 && stream[4] == 7 && stream[8] == 68 && stream[12] == 2 && stream[16] == 1));
  size += print(Message{Function::stop_move, 8, {}}, std::span(stream).subspan(size));
  Inbox inbox;
  Message m;
  std::vector<Function> heard;
  for (std::size_t k = 0; k < size; ++k) {
    inbox.room()[0] = stream[k];
    inbox.took(1);
    while (inbox.next(m)) {
      heard.push_back(m.function);
      Move move;
      if (m.function == Function::move) REQUIRE(parse(m.payload, move));
      if (m.function == Function::move) CHECK(move.generator == Generator::velocity);
    }
  }
  CHECK(heard == std::vector{Function::move, Function::stop_move});
  std::mt19937 rng(3);
  int whole = 0, broken = 0;
  for (int k = 0; k < 20'000; ++k) {
    Inbox other;
    auto bytes = stream;
    bytes.resize(size);
    bytes[rng() % size] = static_cast<std::uint8_t>(rng());
    const auto room = other.room();
    std::copy(bytes.begin(), bytes.end(), room.begin());
    other.took(size);
    while (other.next(m)) {
      ++whole;
      Move move;
      Connect connect;
      SevenJoints seven;
      REQUIRE((!parse(m.payload, move) || move.generator <= Generator::twist));
      static_cast<void>(parse(m.payload, connect));
      static_cast<void>(parse(m.payload, std::span<double>(seven)));
    }
    broken += other.broken();
  }
  CHECK((whole > 1000 && broken > 1000));
}

TEST_CASE("FCI: 100 000 damaged states and commands do no harm, and what is read is finite") {
  const auto state = bytes_of(full_state()), command = bytes_of(Command{});
  std::mt19937 rng(5);
  int read = 0;
  const auto finite = [](const auto& x) {
    return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  };
  for (int k = 0; k < 100'000; ++k) {
    auto bytes = k % 4 == 0 ? state : command;
    for (auto n = rng() % 4; n > 0; --n) bytes[rng() % bytes.size()] = static_cast<std::uint8_t>(rng());
    State s;
    Command c;
    if (parse(bytes, s)) {
      ++read;
      REQUIRE((finite(s.q) && finite(s.external) && s.mode <= Mode::recovery));
    }
    if (parse(bytes, c)) {
      ++read;
      REQUIRE((finite(c.q) && finite(c.torque)));
    }
  }
  CHECK(read > 10'000);
}

TEST_CASE("FCI: what a robot says against a job is told apart") {
  Franka protocol({});
  ClockedStateOf<7> out;
  State s = full_state();
  s.errors.reset(), s.reasons.reset();
  const auto reads = [&](auto&& change) {
    ++s.number;
    State other = s;
    change(other);
    return protocol.read(bytes_of(other), out);
  };
  const auto idle = [](State& x) { x.mode = Mode::idle, x.generator = Generator::idle, x.success = 0; };
  CHECK(reads(idle) == ClockFault::none);
  CHECK_FALSE(out.takes);
  CHECK(std::string(protocol.why()) == "it has not begun to move");
  CHECK(reads([](State&) {}) == ClockFault::none);
  CHECK((out.takes && out.q == s.q && out.told == s.told && out.external == s.external));
  s.success = 0.95;  // two more
  CHECK(reads([](State&) {}) == ClockFault::none);
  CHECK(out.late == 2);
  const auto ended_by = [](Error error) {
    return [error](State& x) { x.mode = Mode::reflex, x.reasons.set(static_cast<std::size_t>(error)); };
  };
  CHECK(reads(ended_by(Error::communication)) == ClockFault::late);
  CHECK(reads(ended_by(Error::acceleration_step)) == ClockFault::limit);
  CHECK(std::string(protocol.why()) == "joint_motion_generator_acceleration_discontinuity");
  CHECK(reads(ended_by(Error::joint_reflex)) == ClockFault::stopped);
  CHECK(reads([](State& x) { x.mode = Mode::user_stopped; }) == ClockFault::stopped);
  CHECK(reads(idle) == ClockFault::stopped);
  CHECK(std::string(protocol.why()) == "it ended the motion");
  CHECK(protocol.read({}, out) == ClockFault::nonsense);
}

TEST_CASE("FCI: after cycles that a robot bridged, answers lead back to the plan within its limits") {
  constexpr double dt = 1e-3;
  const auto plan = [](double t) { return 0.1 * std::sin(3 * t); };
  std::mt19937 rng(9);
  for (const int gap : {0, 1, 5, 10, 19, 100}) {  // the last: any cycle may be one, for a second
    CAPTURE(gap);
    Franka protocol({});
    ClockedStateOf<7> out;
    State s = full_state();
    s.errors.reset(), s.reasons.reset();
    s.told = s.told_dq = s.told_ddq = {};
    s.told_dq[0] = 0.3;
    s.success = 1;
    double last = 0, farthest = 0, jerk = 0;
    std::array<std::uint8_t, 4096> bytes;
    for (int k = 1; k < 2000; ++k) {
      ++s.number;
      REQUIRE(protocol.read(bytes_of(s), out) == ClockFault::none);
      const bool bridged = gap == 100 ? k < 1000 && rng() % 2 == 0 : k >= 300 && k < 300 + gap;
      double dq = s.told_dq[0] + dt * s.told_ddq[0];  // it goes on by itself
      if (!bridged) {
        SevenJoints q{};
        q[0] = plan(k * dt);
        Command c;
        REQUIRE(parse({bytes.data(), protocol.answer(s.number, q, false, bytes)}, c));
        dq = (c.q[0] - s.told[0]) / dt;
        last = std::abs(c.q[0] - q[0]);
        farthest = std::max(farthest, last);
      }
      const double ddq = (dq - s.told_dq[0]) / dt;
      jerk = std::max(jerk, std::abs(ddq - s.told_ddq[0]) / dt);
      REQUIRE(std::abs(ddq) < 10);
      s.told[0] += dt * dq;
      s.told_dq[0] = dq, s.told_ddq[0] = ddq;
    }
    CHECK(jerk < 4000);  // an FR3 takes 5000
    CHECK(last < 1e-8);  // [rad]
    CHECK(farthest < (gap == 0 ? 1e-7 : 5e-3));
  }
}

TEST_SUITE_BEGIN("real time");

TEST_CASE("FCI: an arm on springs is held while a scene is built, moves, and is brought to rest") {
  const auto robot = franka_controller(fr3(), in_lock_step(), {}, 0);
  for (int run = 0; run < 2; ++run) {  // one client after the other
    adapters::ClockedDriver driver(Franka({.port = robot->port()}),
                                   {.give_up = Timeout(4000), .real_time = false});
    driver.connect();
    CHECK(driver.hold_while([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      return 7;
    }) == 7);
    skinctl::State<7> state;
    skinctl::PositionCommand<7> command;
    command.valid = true;
    const auto start = driver.newest().told;
    for (int k = 0; k < 700; ++k) {
      REQUIRE(driver.wait(state) != skinctl::Heard::lost);
      const double t = skinctl::seconds<double>(state.time), rise = std::min(1.0, t);
      for (std::size_t i = 0; i < joints; ++i) command.position[i] = start[i];
      command.position[0] += 0.2 * rise * rise * rise * (10 - 15 * rise + 6 * rise * rise);
      REQUIRE(driver.send(command));
    }
    const auto before = robot->snapshot();
    CHECK(std::abs(before.told[0] - start[0]) > 0.05);
    driver.stop();
    CHECK(driver.fault() == ClockFault::none);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto after = robot->snapshot();
    CHECK(after.ended == "");
    CHECK(std::abs(after.told[0] - before.told[0]) < 0.1);
    CHECK(std::abs(after.dq[0]) < 1e-2);
  }
}

TEST_CASE("FCI: a simulated FR3 keeps its rules: who may speak, motions, reflexes and the way back") {
  const auto robot = franka_controller(fr3(), in_lock_step(), {}, 0);
  {
    Client rude(robot->port());
    CHECK(rude.ask(Function::move) == 255);  // before connect
  }
  {
    Client other(robot->port());
    CHECK(other.connect(5) == other_version);
  }
  Client client(robot->port());
  REQUIRE(client.connect() == success);
  const State home = client.state();
  CHECK(home.mode == Mode::idle);
  CHECK(client.state().number > home.number);
  CHECK(home.pose[14] == doctest::Approx(0.59).epsilon(0.05));  // of the flange above the base [m]
  CHECK(home.motor_torque[3] > 10);                             // bears the forearm
  CHECK(client.ask(Function::stop_move) == not_possible);
  CHECK(client.ask(Function::load_model) != success);
  SevenJoints k;
  k.fill(-1);
  CHECK(client.set(Function::set_joint_impedance, k) == invalid);
  CHECK(client.set(Function::set_collision_behavior, k) == invalid);  // too few
  k.fill(1000);
  CHECK(client.set(Function::set_joint_impedance, k) == success);
  CHECK(client.move(Control::cartesian_impedance, Generator::position) == moved::invalid);
  CHECK(client.move(Control::joint_impedance, Generator::pose) == moved::invalid);

  const auto hold = [](const State& s, int) { return Command{.q = s.told}; };
  const auto runs = [&](Control control, Generator generator, int cycles, auto&& f) {
    REQUIRE(client.move(control, generator) == moved::started);
    return client.follow(cycles, f);
  };
  const auto ends_by = [&](Control control, Generator generator, Error error, auto&& f) {
    CAPTURE(std::string(name(static_cast<std::size_t>(error))));
    const State last = runs(control, generator, 3000, f);
    CHECK(last.mode == Mode::reflex);
    CAPTURE(last.reasons.to_string());
    CHECK(last.reasons.test(static_cast<std::size_t>(error)));
    CHECK(client.heard() == moved::by_reflex);
    CHECK(client.move(control, generator) == moved::not_possible);
    CHECK(client.ask(Function::recover) == success);
    while (client.state().mode != Mode::idle) continue;
  };
  // Held, set in motion and ended by its client.
  CHECK(runs(Control::joint_impedance, Generator::position, 20, hold).mode == Mode::move);
  CHECK(client.set(Function::set_joint_impedance, k) == not_possible);
  CHECK(client.move(Control::joint_impedance, Generator::position) == moved::not_possible);
  CHECK(client.follow(2, [](const State& s, int) { return Command{.q = s.told, .finished = true}; }).mode ==
        Mode::idle);
  CHECK(client.heard() == success);
  const State stopped =
      runs(Control::joint_impedance, Generator::velocity, 20, [](const State&, int) { return Command{}; });
  CHECK(stopped.mode == Mode::move);
  client.say(Function::stop_move);
  client.forget();
  CHECK(client.heard() == moved::preempted);
  CHECK(client.heard() == success);

  const auto impedance = Control::joint_impedance;
  const auto jump = [](double by, int at) {
    return [=](const State& s, int n) {
      Command c{.q = s.told};
      if (n >= at) c.q[0] += by;
      return c;
    };
  };
  ends_by(impedance, Generator::position, Error::start_pose, jump(0.01, 0));
  ends_by(impedance, Generator::position, Error::velocity_limits, jump(0.01, 5));
  ends_by(impedance, Generator::position, Error::velocity_step, jump(2e-5, 5));
  ends_by(impedance, Generator::position, Error::acceleration_step, jump(6e-6, 5));
  ends_by(impedance, Generator::position, Error::velocity_step, [](const State& s, int n) {
    const double t = 1e-3 * n, rest = std::min(t, 0.2);
    Command c{.dq = {}, .finished = n > 150};
    c.q = s.told;
    c.q[0] += 1e-3 * 10 * rest * rest;  // ends while it is fast
    return c;
  });
  ends_by(Control::torque, Generator::velocity, Error::torque_step,
          [](const State&, int n) { return Command{.torque = {0, 0, 0, 0, 0, 0, n > 5 ? 1.1 : 0}}; });
  ends_by(Control::torque, Generator::velocity, Error::velocity,
          [](const State&, int n) { return Command{.torque = {std::min(80.0, 0.5 * n), 0, 0, 0, 0, 0, 0}}; });
  // Commands of other states are none.
  const State wrong = runs(impedance, Generator::position, 20, [&](const State& at, int) {
    for (const std::uint64_t by : {1u, 5u}) client.command({.number = at.number - by});
    client.command({.number = at.number + 1});
    return Command{.q = at.told};
  });
  CHECK(wrong.mode == Mode::move);
}

TEST_CASE("FCI: a client that falls silent, or hangs up, ends its motion after 20 cycles") {
  if (skinctl::testing::sanitized) return;
  const auto robot = franka_controller(fr3(), {}, {}, 0);
  for (const bool hangs_up : {false, true}) {
    CAPTURE(hangs_up);
    std::optional<Client> client(robot->port());
    REQUIRE(client->connect() == success);
    REQUIRE(client->ask(Function::recover) == success);
    REQUIRE(client->move(Control::joint_impedance, Generator::position) == moved::started);
    State s = client->follow(30, [](const State& at, int) { return Command{.q = at.told}; });
    REQUIRE(s.mode == Mode::move);
    const auto begin = s.number;
    if (!hangs_up) {
      while (s.mode == Mode::move) s = client->state();
      CHECK(s.mode == Mode::reflex);
      CHECK((s.number - begin >= 18 && s.number - begin <= 22));
      CHECK(client->heard() == moved::by_reflex);
    }
    client.reset();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    CHECK(robot->snapshot().ended == "communication_constraints_violation");
  }
}

TEST_SUITE_END();
