// The driver and the simulated hand, whose bytes are written apart from each other, over every link.
//
// Promise: an Allegro hand is left without torque at any end: return, exception, signal, SIGKILL, lost
// link, fault of the hand
// Tried: 21 faults over CAN and UDP: no torque 0.4 s after a fault that ends the job, and its exit code.
// Also: `examples/compliant_allegro/tests`

#include "examples/adapters/allegro/driver.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "examples/adapters/allegro/limits.hpp"
#include "examples/simulated_allegro/simulated_hand.hpp"

using namespace adapters::allegro;
using namespace std::chrono_literals;
using adapters::ConnectionError;
using simulated_allegro::SimulatedHand;
using skinctl::Heard;

namespace {

simulated_allegro::Config quick(Generation g, Side side = Side::right) {
  simulated_allegro::Config c;
  c.generation = g;
  c.plant.side = side;
  c.speed = 0;
  return c;
}
HandOptions options(Generation g) {
  HandOptions o;
  o.generation = g;
  o.answer = adapters::Timeout(500);
  o.stamps = Stamps::counted;
  return o;
}
constexpr DriverOptions patient{.give_up = adapters::Timeout(2000)};

skinctl::TorqueCommand<16> command(const skinctl::JointTorque<16>& tau) {
  skinctl::TorqueCommand<16> c;
  c.valid = true;
  c.torque = tau;
  return c;
}

/// Holds the joints by springs at `goal` for so many states; the last state.
template <class D>
skinctl::State<16> hold(D& driver, const skinctl::JointPosition<16>& goal, int states) {
  skinctl::State<16> state;
  for (int k = 0; k < states; ++k) {
    REQUIRE(driver.wait(state) == Heard::state);
    skinctl::JointTorque<16> tau;
    for (std::size_t i = 0; i < 16; ++i) tau[i] = 0.6 * (goal[i] - state.q[i]) - 0.01 * state.dq[i];
    REQUIRE(driver.send(command(tau)));
  }
  return state;
}

/// Connects over each link and says which hand it is.
template <class Link>
void goes(Link link, SimulatedHand& hand, const HandOptions& o, Side side) {
  Driver<Link> driver(std::move(link), o, patient);
  driver.connect();
  CHECK(driver.introduction().side == side);
  const auto goal = skinctl::JointPosition<16>::constant(0.3);
  const auto state = hold(driver, goal, 300);
  const auto seen = hand.snapshot();
  CHECK(seen.servo);
  CHECK(seen.nonsense == 0);
  CHECK(driver.condition().nonsense == 0);
  CHECK(driver.condition().incomplete == 0);
  for (std::size_t i = 0; i < 16; ++i) {
    if (i != 12) CHECK(std::abs(state.q[i] - 0.3) < 0.08);  // friction and gravity over stiffness
    CHECK(std::abs(state.dq[i]) < 0.02 + driver.estimator().worst_noise());
    // The state is the encoder's: half a step of the truth of at most one period before.
    CHECK(std::abs(state.q[i] - seen.q[i]) <
          0.5 * encoder_step(o.generation) + 0.003 * std::abs(seen.dq[i]) + 1e-6);
  }
  driver.stop();
  for (int k = 0; k < 200 && hand.snapshot().servo; ++k) std::this_thread::sleep_for(1ms);
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("Driver: every generation and side over every link; the servo is off at the end") {
  for (const Generation g : {Generation::v4, Generation::v5, Generation::v5_sense}) {
    for (const Side side : {Side::right, Side::left}) {
      CAPTURE(int(g));
      CAPTURE(int(side));
      HandOptions o = options(g);
      o.side = side;
      {
        SimulatedHand hand(quick(g, side));
        goes(CanHand(hand.pair()), hand, o, side);
        CHECK_FALSE(hand.snapshot().servo);
      }
      if (side == Side::right) {
        SimulatedHand hand(quick(g, side));
        goes(CanHand(SlcanLink::open(hand.terminal())), hand, o, side);
        CHECK_FALSE(hand.snapshot().servo);
      }
      if (g == Generation::v5_sense) {
        SimulatedHand hand(quick(g, side));
        goes(UdpHand("127.0.0.1", hand.udp()), hand, o, side);
        CHECK(hand.snapshot().torque == simulated_allegro::Joints{});  // UDP has no servo off
      }
    }
  }
}

TEST_CASE("Driver: a hand of another generation than declared gets no torque") {
  const auto refused = [](Generation is, int hardware, Generation declared, const char* words) {
    auto c = quick(is);
    c.hardware = hardware;
    SimulatedHand hand(c);
    std::string why;
    {
      Driver driver(CanHand(hand.pair()), options(declared), patient);
      try {
        driver.connect();
        skinctl::State<16> state;
        for (int k = 0; k < 50 && driver.wait(state) != Heard::lost; ++k) driver.send(command({}));
        why = driver.error();
      } catch (const ConnectionError& e) {
        why = e.what();
        CHECK_FALSE(hand.snapshot().servo);
      }
    }
    CHECK_MESSAGE(why.find(words) != std::string::npos, why);
    std::this_thread::sleep_for(30ms);  // the hand has heard the driver's last words by then
    CHECK(hand.snapshot().torques == 0);
    CHECK_FALSE(hand.snapshot().servo);
  };
  refused(Generation::v4, -1, Generation::v5, "this is a V4 (hardware version 0x0401), a V5 was expected");
  refused(Generation::v5, -1, Generation::v4, "this is a V5 (hardware version 0x0501), a V4 was expected");
  refused(Generation::v4, -1, Generation::v5_sense, "this is a V4");
  refused(Generation::v4, 3, Generation::v4, "this is a V3");
  // Numbers that nobody knows: the positions tell.
  refused(Generation::v4, 9, Generation::v5, "of another generation");
  refused(Generation::v4, 9, Generation::v5_sense, "of another generation");
}

TEST_CASE(
    "Driver: the servo goes off with an exception, with the destructor, and after a lost link nothing "
    "hangs") {
  SimulatedHand hand(quick(Generation::v4));
  try {
    Driver driver(CanHand(hand.pair()), options(Generation::v4), patient);
    driver.connect();
    hold(driver, skinctl::JointPosition<16>::constant(0.3), 20);
    CHECK(hand.snapshot().servo);
    throw std::runtime_error("on the way");
  } catch (const std::runtime_error&) {
  }
  for (int k = 0; k < 500 && hand.snapshot().servo; ++k) std::this_thread::sleep_for(1ms);
  CHECK_FALSE(hand.snapshot().servo);

  auto c = quick(Generation::v4);
  c.faults.unplug_at = 0.05;
  SimulatedHand leaves(c);
  Driver driver(CanHand(leaves.pair()), options(Generation::v4), patient);
  driver.connect();
  skinctl::State<16> state;
  Heard heard = Heard::state;
  for (int k = 0; k < 100 && heard != Heard::lost; ++k)
    if ((heard = driver.wait(state)) == Heard::state) driver.send(command({}));
  CHECK(heard == Heard::lost);
  CHECK(driver.error() == "the CAN link is gone");
  driver.stop();
  driver.stop();
  CHECK(driver.wait(state) == Heard::lost);
}

TEST_CASE("Driver: a hand of the other side, of another number, and one that is mute are refused in time") {
  const auto why = [](auto link, HandOptions o) {
    o.tries = 2;
    o.answer = adapters::Timeout(30);
    Driver driver(std::move(link), o, patient);
    const auto begin = std::chrono::steady_clock::now();
    try {
      driver.connect();
    } catch (const ConnectionError& e) {
      CHECK(std::chrono::steady_clock::now() - begin < 1s);
      return std::string(e.what());
    }
    return std::string();
  };
  HandOptions left = options(Generation::v5);
  left.side = Side::left;
  SimulatedHand right(quick(Generation::v5));
  CHECK(why(CanHand(right.pair()), left) == "this is a right hand, the other one was expected");
  HandOptions second = options(Generation::v4);
  second.hand = 1;
  SimulatedHand first(quick(Generation::v4));
  CHECK(why(CanHand(first.pair()), second).find("asked 2 times") != std::string::npos);
  auto mute = quick(Generation::v5_sense);
  mute.faults.mute = true;
  SimulatedHand silent(mute);
  CHECK(why(UdpHand("127.0.0.1", silent.udp()), options(Generation::v5_sense)).find("HELLO") !=
        std::string::npos);
  CHECK(why(UdpHand("127.0.0.1", 9), options(Generation::v5_sense)).find("HELLO") != std::string::npos);
  CHECK_THROWS_AS(UdpHand("not an address", 9), ConnectionError);
  CHECK_THROWS_AS(static_cast<void>(FrameSocket::open("no_such_interface_of_can")), ConnectionError);
  CHECK_THROWS_AS(static_cast<void>(SlcanLink::open("/dev/null")), ConnectionError);
  HandOptions wrong = options(Generation::v4);
  wrong.hand = 4;
  auto pair = FrameSocket::pair();
  CHECK_THROWS_AS(Driver(CanHand(std::move(pair[0])), wrong, patient), skinctl::ConfigurationError);
}

TEST_CASE("Guardian: a program that is killed leaves no torque behind, on every link") {
  for (const int kind : {0, 1, 2}) {
    CAPTURE(kind);
    auto c = quick(kind == 2 ? Generation::v5_sense : Generation::v4);
    c.speed = 1;
    SimulatedHand hand(c);
    std::optional<FrameSocket> socket;
    std::string terminal;
    std::uint16_t port = 0;
    if (kind == 0) socket.emplace(hand.pair());
    if (kind == 1) terminal = hand.terminal();
    if (kind == 2) port = hand.udp();
    const auto drive = [&](auto link) {
      HandOptions o;
      o.generation = c.generation;
      Driver driver(std::move(link), o, patient);
      driver.connect();
      const Guardian guardian(driver.link().handle(), driver.link().last_words());
      skinctl::State<16> state;
      const auto end = std::chrono::steady_clock::now() + 20s;
      while (std::chrono::steady_clock::now() < end)
        if (driver.wait(state) == Heard::state)
          driver.send(command(skinctl::JointTorque<16>::constant(0.05)));
    };
    std::fflush(nullptr);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      if (kind == 0) drive(CanHand(std::move(*socket)));
      if (kind == 1) drive(CanHand(SlcanLink::open(terminal)));
      if (kind == 2) drive(UdpHand("127.0.0.1", port));
      ::_exit(1);
    }
    for (int k = 0; k < 3000 && hand.snapshot().torque[1] < 0.03; ++k) std::this_thread::sleep_for(1ms);
    CHECK(hand.snapshot().torque[1] > 0.03);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    for (int k = 0; k < 500 && hand.snapshot().torque[1] != 0; ++k) std::this_thread::sleep_for(1ms);
    CHECK(hand.snapshot().torque == simulated_allegro::Joints{});
    if (kind != 2) CHECK_FALSE(hand.snapshot().servo);
  }
}

TEST_CASE("Driver: torques reach the joints in N m, gears included, and are cut at the caps") {
  struct Case {
    Generation generation;
    bool geared;
  };
  for (const auto& [generation, geared] :
       {Case{Generation::v5, false}, {Generation::v5, true}, {Generation::v5_sense, true}}) {
    auto c = quick(generation);
    c.geared = geared;
    SimulatedHand hand(c);
    auto with = options(generation);
    if (generation == Generation::v5) with.geared = geared;
    Driver driver(CanHand(hand.pair()), with, patient);
    driver.connect();
    skinctl::State<16> state;
    skinctl::JointTorque<16> tau;
    for (std::size_t i = 0; i < 16; ++i) tau[i] = i % 2 == 0 ? 0.05 : 10;
    for (int k = 0; k < 3; ++k) {
      REQUIRE(driver.wait(state) == Heard::state);
      REQUIRE(driver.send(command(tau)));
    }
    REQUIRE(driver.wait(state) == Heard::state);
    const auto at = hand.snapshot().torque;
    for (std::size_t i = 0; i < 16; ++i) {
      const double most = geared && (i == 1 || i == 5 || i == 9) ? 480.0 / 1430 : 240.0 / 1430;
      CHECK(at[i] == doctest::Approx(i % 2 == 0 ? 0.05 : most).epsilon(0.02));
    }
  }
}

TEST_CASE("Driver: a V5 whose gears nobody chose never gets more torque than asked, whatever its letter") {
  for (const char type : {'A', 'B'})
    for (const bool geared : {false, true}) {
      CAPTURE(type);
      CAPTURE(geared);
      auto c = quick(Generation::v5);
      c.type = type;
      c.geared = geared;
      SimulatedHand hand(c);
      Driver driver(CanHand(hand.pair()), options(Generation::v5), patient);
      driver.connect();
      skinctl::State<16> state;
      REQUIRE(driver.wait(state) == Heard::state);
      for (const double tau : {0.1, 10.0}) {
        for (int k = 0; k < 3; ++k) {
          REQUIRE(driver.send(command(skinctl::JointTorque<16>::constant(tau))));
          REQUIRE(driver.wait(state) == Heard::state);
        }
        const auto at = hand.snapshot().torque;
        const double most = std::min(tau, driver.scale().limit()[0]);
        for (const std::size_t i : {1u, 5u, 9u}) {
          CHECK(at[i] <= most);
          CHECK(at[i] >= 0.48 * most);
        }
        CHECK(at[0] == doctest::Approx(most).epsilon(0.02));
      }
    }
}

TEST_CASE("Tactile cells: a touch shows on its cell only, over CAN and UDP, with a fresh stamp") {
  for (const bool udp : {false, true}) {
    auto c = quick(Generation::v5_sense);
    c.plant.touches = {{.cell = 7, .start = 0.1, .duration = 5, .force = 0.5}};
    SimulatedHand hand(c);
    const auto run = [&](auto link) {
      Driver driver(std::move(link), options(Generation::v5_sense), patient);
      TactileSkin skin(driver, true);
      driver.connect();
      const auto state = hold(driver, skinctl::JointPosition<16>::constant(0.3), 100);
      const auto samples = skin.poll();
      REQUIRE(samples.size() == 16);
      for (const auto& s : samples) {
        CHECK(s.force[0] == doctest::Approx(s.cell == 7 ? 0.1 : 0).epsilon(0.05));  // 0.5 of 5 N
        CHECK(std::abs((s.time - state.time).count()) <= 3'000'000);
      }
      CHECK(skin.poll().empty());
    };
    if (udp) {
      run(UdpHand("127.0.0.1", hand.udp()));
    } else {
      run(CanHand(hand.pair()));
    }
  }
}

TEST_SUITE_END();
