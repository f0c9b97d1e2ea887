// The drivers of arms that are the clock, against simulated controllers, in real time.
#include <doctest/doctest.h>

#include <random>

#include "examples/adapters/clocked_driver.hpp"
#include "examples/simulated_arm/egm.hpp"
#include "examples/simulated_arm/fri.hpp"
#include "examples/simulated_arm/rsi.hpp"
#include "examples/simulated_arm/stream_motion.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace simulated_arm;
using namespace adapters;
using adapters::rsi::Correction;
using adapters::rsi::Rsi;
using adapters::stream_motion::StreamMotion;
using skinctl::Heard;
using Clock = std::chrono::steady_clock;

namespace {

rsi::Options options(Correction correction, double max_correction = 90) {
  rsi::Options out;
  out.correction = correction;
  out.max_correction = max_correction;
  return out;
}
/// A driver and its controller.
struct RsiPair {
  explicit RsiPair(const Config& config = {}, const RsiConfig& there = {}, rsi::Options here = {},
                   const ClockOptions& options = {}) {
    here.port = 0;
    Rsi protocol(here);
    controller = rsi_controller(config, there, "127.0.0.1", protocol.socket().port());
    driver.emplace(std::move(protocol), options);
  }
  std::unique_ptr<Controller> controller;
  std::optional<ClockedDriver<Rsi>> driver;
};
struct StreamPair {
  explicit StreamPair(const Config& config = {}, const StreamMotionConfig& there = {}) {
    controller = stream_motion_controller(config, there, "127.0.0.1", 0);
    driver.emplace(StreamMotion({.host = "127.0.0.1", .port = controller->port()}));
  }
  std::unique_ptr<Controller> controller;
  std::optional<ClockedDriver<StreamMotion>> driver;
};

/// Joint 1 goes forth and back by `size`, with a velocity at the end if it is cut.
template <class Driver>
Heard swing(Driver& driver, double duration, double size, double omega) {
  constexpr std::size_t N = Driver::joints;
  skinctl::State<N> state;
  const auto start = driver.newest().told;
  skinctl::PositionCommand<N> command;
  command.valid = true;
  Heard heard = Heard::silent;
  double t = 0;
  skinctl::Nanoseconds begin{-1};
  while (t < duration && (heard = driver.wait(state)) != Heard::lost) {
    if (begin.count() < 0) begin = state.time;
    t = skinctl::seconds<double>(state.time - begin);
    for (std::size_t i = 0; i < N; ++i) command.position[i] = start[i];
    const double rise = std::min(1.0, t);
    command.position[0] +=
        size * rise * rise * rise * (10 - 15 * rise + 6 * rise * rise) * std::sin(omega * t);
    if (!driver.send(command)) return Heard::lost;
  }
  return heard;
}
std::string refused(auto&& f) {
  try {
    f();
  } catch (const skinctl::ConfigurationError& e) {
    return std::string("refused: ") + e.what();
  } catch (const ConnectionError& e) {
    return std::string("lost: ") + e.what();
  }
  return "";
}
double farthest(const SixJoints& a, const SixJoints& b) {
  double most = 0;
  for (std::size_t i = 0; i < 6; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("RSI: an arm is held while a scene is built, moves, and is brought to rest smoothly") {
  for (const auto correction : {Correction::absolute, Correction::relative}) {
    CAPTURE(int(correction));
    Config config;
    ClockOptions clock;
    if (correction == Correction::relative) {  // one late answer ends it: the controller waits for each
      config.speed = 0;
      clock.real_time = false;
      clock.give_up = Timeout(4000);
    }
    RsiPair pair(config, {.correction = correction}, options(correction), clock);
    pair.driver->connect();
    CHECK(pair.driver->hold_while([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      return 7;
    }) == 7);
    CHECK(farthest(pair.controller->snapshot().told, Config{}.home) < 1e-6);
    CHECK(swing(*pair.driver, 1.5, 0.2, 3) == Heard::state);  // it moves when it ends
    const auto before = pair.controller->snapshot();
    CHECK(std::abs(before.told[0] - Config{}.home[0]) > 0.01);
    pair.driver->stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto after = pair.controller->snapshot();
    CHECK(pair.driver->fault() == ClockFault::none);
    CHECK(after.ended == "Stop was asked for");
    // 0.6 rad/s within 0.3 s: half of the way at full speed.
    CHECK(std::abs(after.told[0] - before.told[0]) < 0.6 * 0.3);
    CHECK(std::abs(after.dq[0]) < 1e-3);
  }
}

TEST_CASE("EGM: an arm moves once its controller is guided, and is brought to rest smoothly") {
  egm::Egm protocol({.port = 0});
  const Config config;
  const auto controller = egm_controller(config, {}, "127.0.0.1", protocol.socket().port());
  ClockedDriver<egm::Egm> driver(std::move(protocol));
  driver.connect();
  CHECK(swing(driver, 1.5, 0.2, 3) == Heard::state);
  const auto before = controller->snapshot();
  CHECK(std::abs(before.told[0] - config.home[0]) > 0.01);
  driver.stop();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto after = controller->snapshot();
  CHECK(driver.fault() == ClockFault::none);
  CHECK(after.ended == "");
  CHECK(std::abs(after.told[0] - before.told[0]) < 0.6 * 0.3);
  CHECK(std::abs(after.dq[0]) < 1e-3);
}

TEST_CASE("EGM: motors off, an error and an end of its program are told apart") {
  egm::Egm protocol({.port = 0});
  std::array<std::uint8_t, egm::longest> bytes{};
  const auto says = [&](auto&& change) {
    egm::RobotMessage m{.number = 1, .joints = 6, .guided = egm::Guided::running};
    change(m);
    ClockedState state;
    const auto size = print(m, bytes);
    CHECK(protocol.read({bytes.data(), size}, state) != ClockFault::none);
    return std::string(protocol.why());
  };
  ClockedState state;
  const auto size = print(egm::RobotMessage{.joints = 6, .guided = egm::Guided::stopped}, bytes);
  CHECK(protocol.read({bytes.data(), size}, state) == ClockFault::none);
  CHECK_FALSE(state.takes);
  CHECK(says([](auto& m) { m.motors = egm::Motors::off; }) == "its motors are off");
  CHECK(says([](auto& m) { m.guided = egm::Guided::error; }).find("EGM is in error") == 0);
  CHECK(says([](auto& m) { m.rapid = egm::Rapid::stopped; }) == "its RAPID program has stopped");
  CHECK(says([](auto& m) { m.joints = 4; }).find("six axes") != std::string::npos);
  const auto running = print(egm::RobotMessage{.joints = 6, .guided = egm::Guided::running}, bytes);
  CHECK(protocol.read({bytes.data(), running}, state) == ClockFault::none);
  CHECK(state.takes);
  CHECK(says([](auto& m) { m.guided = egm::Guided::stopped; }).find("EGMRunJoint has ended") == 0);
  CHECK(refused([] { egm::Egm wrong({.period = skinctl::Nanoseconds(1'000'000)}); }).find("refused: ") == 0);
}

TEST_CASE("FRI: a session is led to its motion, an arm on springs is held, moves, and is brought to rest") {
  const auto model = skinctl::calibrated_from<skinctl::Chain<7>>(skinctl::read_urdf(SIMULATED_ARM_IIWA));
  for (const unsigned multiplier : {1u, 2u}) {
    CAPTURE(multiplier);
    fri::Fri protocol({.port = 0});
    const FriConfig there{.send_period = 4 / multiplier, .multiplier = multiplier};
    const auto controller = fri_controller(model, {}, there, "127.0.0.1", protocol.socket().port());
    ClockedDriver<fri::Fri> driver(std::move(protocol));
    driver.connect();
    CHECK(driver.newest().told == there.arm.home);
    CHECK(driver.hold_while([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      return 7;
    }) == 7);
    CHECK(swing(driver, 1.5, 0.2, 3) == Heard::state);
    const auto before = controller->snapshot();
    CHECK(std::abs(before.told[0] - there.arm.home[0]) > 0.01);
    CHECK(std::abs(before.q[0] - before.told[0]) < 0.1);
    driver.stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    const auto after = controller->snapshot();
    CHECK(driver.fault() == ClockFault::none);
    CHECK(after.ended == "quality below GOOD");  // nobody answers any more, and the springs hold
    CHECK(std::abs(after.told[0] - before.told[0]) < 0.6 * 0.3);
    CHECK(std::abs(after.dq[0]) < 5e-3);
  }
}

TEST_CASE("FRI: what a controller says against a job is told apart, and its counters are kept") {
  fri::Monitoring good;
  good.axes = 7, good.control = fri::Control::joint_impedance, good.overlay = fri::Overlay::position;
  good.measured = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  good.commanded = {1, 2, 3, 4, 5, 6, 7}, good.interpolated = {7, 6, 5, 4, 3, 2, 1};
  good.session = fri::Session::commanding, good.quality = fri::Quality::good, good.period = 4;
  std::array<std::uint8_t, fri::longest> bytes{};
  ClockedStateOf<7> state;
  const auto reads = [&](fri::Fri& protocol, fri::Monitoring m, std::uint32_t number) {
    m.header.number = number;
    const auto size = print(m, bytes);
    return protocol.read({bytes.data(), size}, state);
  };
  const auto says = [&](ClockFault expected, auto&& change, bool commanded = true) {
    fri::Fri protocol({.port = 0});
    if (commanded) CHECK(reads(protocol, good, 1) == ClockFault::none);
    auto m = good;
    change(m);
    CHECK(reads(protocol, m, 2) == expected);
    return std::string(protocol.why());
  };
  using fri::Session;
  CHECK(says(ClockFault::joints, [](auto& m) { m.axes = 6; }) == "an iiwa has seven");
  CHECK(says(ClockFault::stopped, [](auto& m) { m.safety = 2; }).find("its safety state is not normal") == 0);
  CHECK(says(ClockFault::stopped, [](auto& m) { m.quality = fri::Quality::fair; }).find("its quality") == 0);
  CHECK(says(ClockFault::stopped, [](auto& m) {
          m.session = Session::monitoring_ready;
        }).find("the session fell back from COMMANDING_ACTIVE: the Java program's motion") == 0);
  CHECK(says(ClockFault::declared, [](auto& m) { m.control = fri::Control::position; }) ==
        "its control mode is position");
  CHECK(says(
            ClockFault::declared, [](auto& m) { m.control = fri::Control::cartesian_impedance; }, false) ==
        "its control mode is Cartesian impedance");
  CHECK(says(
            ClockFault::declared, [](auto& m) { m.overlay = fri::Overlay::torque; }, false) ==
        "its client command mode is TORQUE");
  CHECK(says(ClockFault::declared, [](auto& m) { m.multiplier = 2; }, false).find("its send period") == 0);
  // While it only monitors, modes are none of our business; what it waits for is said.
  for (const Session session : {Session::idle, Session::monitoring_wait, Session::monitoring_ready})
    CHECK(says(
              ClockFault::none,
              [&](auto& m) {
                m.session = session, m.control = fri::Control::position, m.quality = fri::Quality::poor;
              },
              false)
              .find("the session ") == 0);

  fri::Fri protocol({.port = 0, .period = skinctl::Nanoseconds(8'000'000)});
  auto m = good;
  m.multiplier = 2;
  REQUIRE(reads(protocol, m, 0xffff'fff0) == ClockFault::none);
  const auto first = state.number;
  CHECK((state.takes && state.q == good.measured && state.told == good.commanded));
  CHECK(reads(protocol, m, 0xffff'fff1) == ClockFault::none);
  CHECK_FALSE(state.takes);  // an answer is due to every second one
  CHECK(reads(protocol, m, 0xffff'fff2) == ClockFault::none);
  CHECK((state.takes && state.number == first + 1));
  CHECK(reads(protocol, m, 0xffff'fff2) == ClockFault::none);
  CHECK((state.takes && state.number == first + 1));  // twice: the driver counts it
  CHECK(reads(protocol, m, 6) == ClockFault::none);   // counters have 32 bits
  CHECK((state.takes && state.number == first + 11));
  CHECK(reads(protocol, m, 0xffff'fff4) == ClockFault::none);
  CHECK(state.number == first + 2);  // overtaken
  fri::Command c;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const auto size = protocol.answer(first, {1, 2, 3, 4, 5, 6, 7}, false, bytes);
    REQUIRE(parse({bytes.data(), size}, c));
    CHECK((c.header.reflected == 6 && c.header.number == k && !c.torque && c.axes == 7));
  }
  m.commanded.reset();
  CHECK(reads(protocol, m, 8) == ClockFault::none);
  CHECK(state.told == *good.interpolated);  // version 2 says no more

  fri::Fri torques({.port = 0, .period = skinctl::Nanoseconds(2'000'000), .overlay = fri::Overlay::torque});
  torques.beside({1, 0, 0, 0, 0, 0, -1});
  REQUIRE(parse({bytes.data(), torques.answer(1, {}, false, bytes)}, c));
  CHECK(c.torque == fri::SevenJoints{1, 0, 0, 0, 0, 0, -1});
  const auto refuses = [&](const fri::Options& o) {
    return refused([&] { fri::Fri wrong(o); }).find("refused: ") == 0;
  };
  CHECK(refuses({.port = 0, .overlay = fri::Overlay::torque}));  // 4 ms
  CHECK(refuses({.port = 0, .overlay = fri::Overlay::wrench}));
  CHECK(refuses({.port = 0, .control = fri::Control::cartesian_impedance}));
  CHECK(refuses({.port = 0, .period = skinctl::Nanoseconds(200'000'000)}));
}

TEST_CASE(
    "FRI: whatever counters, multipliers, states and bytes come, a job goes on or says why it does not") {
  std::mt19937 rng(5);
  const auto any = [&](std::size_t n) { return static_cast<std::uint32_t>(rng() % n); };
  fri::Fri protocol({.port = 0});
  std::array<std::uint8_t, fri::longest> bytes{};
  fri::Monitoring m;
  m.axes = 7, m.control = fri::Control::joint_impedance, m.overlay = fri::Overlay::position;
  m.quality = fri::Quality::good, m.commanded = m.interpolated = m.external_torque = fri::SevenJoints{};
  int taken = 0, refusals = 0, nonsense = 0;
  for (int k = 0; k < 20'000; ++k) {
    m.header.number = any(7) == 0 ? static_cast<std::uint32_t>(rng()) : m.header.number + 1;
    m.multiplier = any(11) == 0 ? static_cast<std::uint32_t>(rng()) : 1;
    m.period = m.multiplier == 1 ? 4 : 0;
    m.session = any(5) == 0 ? static_cast<fri::Session>(any(5)) : fri::Session::commanding;
    auto size = print(m, bytes);
    for (unsigned n = any(3); n > 0; --n) bytes[any(size)] = static_cast<std::uint8_t>(rng());
    if (any(13) == 0) size = any(size);
    if (any(100) == 0) protocol.open({});
    ClockedStateOf<7> state;
    const ClockFault fault = protocol.read({bytes.data(), size}, state);
    if (fault == ClockFault::none && state.takes) {
      ++taken;
      REQUIRE(protocol.answer(state.number, state.q, false, bytes) >= 77);
    } else if (fault == ClockFault::nonsense) {
      ++nonsense;
    } else if (fault != ClockFault::none) {
      ++refusals;
      REQUIRE(*protocol.why() != 0);
    }
  }
  CHECK((taken > 1000 && refusals > 1000 && nonsense > 1000));
}

TEST_CASE("Stream motion: limits are asked, commands keep them, the last one ends the motion") {
  StreamPair pair;
  pair.driver->connect();
  CHECK(pair.driver->protocol().period() == skinctl::Nanoseconds(8'000'000));
  CHECK(pair.driver->protocol().limits()[0][2] == doctest::Approx(180 * 3.14159265 / 180));
  CHECK(pair.driver->protocol().limits()[2][0] == doctest::Approx(1920 * 3.14159265 / 180));
  CHECK(swing(*pair.driver, 1.5, 0.1, 2) == Heard::state);
  pair.driver->stop();
  const auto end = pair.controller->snapshot();
  CHECK(end.ended == "");
  CHECK(end.answers > 150);
  CHECK(std::abs(end.dq[0]) < 2e-3);
}

TEST_CASE("Stream motion: a step beyond the limits stops the arm, and the driver says so") {
  StreamPair pair;
  pair.driver->connect();
  skinctl::State<6> state;
  skinctl::PositionCommand<6> command;
  Heard heard = Heard::silent;
  for (int k = 0; k < 100 && (heard = pair.driver->wait(state)) != Heard::lost; ++k) {
    for (std::size_t i = 0; i < 6; ++i) command.position[i] = Config{}.home[i] + (k > 20 ? 0.05 : 0);
    pair.driver->send(command);
  }
  CHECK(heard == Heard::lost);
  CHECK(pair.driver->fault() == ClockFault::stopped);
  pair.controller->stop();
  CAPTURE(pair.controller->snapshot().ended);
  CHECK(pair.controller->snapshot().ended.find("of J1") != std::string::npos);
}

TEST_CASE("A robot that is the clock: what is refused before anything moves, with the cause") {
  {
    Config config;
    config.faults.fewer_joints = true;
    RsiPair pair(config);
    CHECK(refused([&] { pair.driver->connect(); }).find("refused: another number of joints") == 0);
  }
  {
    RsiPair pair({}, {.period = 0.012, .ipoc_per_cycle = 12});
    CHECK(refused([&] { pair.driver->connect(); }).find("refused: the controller's numbers grow by 12") == 0);
  }
  {
    RsiPair pair({}, {.period = 0.012, .ipoc_per_cycle = 1});
    CHECK(refused([&] { pair.driver->connect(); }).find("refused: datagrams come every 1") == 0);
  }
  {
    Config config;
    config.faults.mute = true;
    RsiPair pair(config, {}, {}, {.first = Timeout(200)});
    const auto begin = Clock::now();
    const std::string why = refused([&] { pair.driver->connect(); });
    CHECK(why.find("lost: no datagram from the controller (at 127.0.0.1:") == 0);
    CHECK(Clock::now() - begin < std::chrono::milliseconds(400));
    StreamPair stream(config);
    CHECK(refused([&] { stream.driver->connect(); }).find("does not say its capability") !=
          std::string::npos);
  }
  rsi::Options elsewhere;
  elsewhere.bind = "192.0.2.1";
  CHECK(refused([&] { Rsi protocol(elsewhere); }).find("lost: cannot wait at 192.0.2.1:59152") == 0);
  CHECK(refused([] { Rsi protocol(options(Correction::absolute, 0)); }).find("refused: ") == 0);
}

TEST_CASE("A robot that is the clock: a silent one is waited for no longer than one and a half periods") {
  Config config;
  config.faults.silent_at = 0.3;
  RsiPair pair(config);
  pair.driver->connect();
  skinctl::State<6> state;
  Clock::duration longest{};
  int silent = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto begin = Clock::now();
    const Heard heard = pair.driver->wait(state);
    longest = std::max(longest, Clock::now() - begin);
    if (heard == Heard::lost) break;
    silent += heard == Heard::silent;
    skinctl::PositionCommand<6> hold;
    hold.position = pair.driver->told();
    CHECK(pair.driver->send(hold));
  }
  CHECK(pair.driver->fault() == ClockFault::silent);
  CHECK(silent > 20);
  CHECK(longest < std::chrono::milliseconds(16));  // 6 ms and the machine
}

TEST_CASE("RSI: corrections beyond the declared limit are not sent") {
  RsiPair pair({}, {}, options(Correction::absolute, 5));
  pair.driver->connect();
  CHECK(swing(*pair.driver, 2, 0.3, 2) == Heard::lost);
  CHECK(pair.driver->fault() == ClockFault::limit);
  CHECK(std::abs(pair.controller->snapshot().told[0]) < 0.0873);
}

TEST_CASE("RSI: datagrams of strangers do not count once the controller is known") {
  RsiPair pair;
  pair.driver->connect();
  auto stranger = UdpSocket::to("127.0.0.1", pair.driver->protocol().socket().port());
  std::array<char, 1024> text{};
  const auto size = print(rsi::Rob{.ipoc = 99}, text);
  std::jthread sender([&](std::stop_token end) {
    while (!end.stop_requested()) {
      static_cast<void>(stranger.send({reinterpret_cast<const std::uint8_t*>(text.data()), size}));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  CHECK(swing(*pair.driver, 0.5, 0.1, 3) == Heard::state);
  CHECK(pair.driver->counts().nonsense == 0);
  CHECK(pair.driver->counts().overtaken == 0);
}

TEST_CASE(
    "RSI: with HOLDON=0 a missing answer of an absolute correction throws the arm to its start, and it "
    "trips") {
  Config config;
  config.faults.from = 1.2;
  config.faults.lose_answers = 0.2;
  RsiPair pair(config, {.hold_on = false});
  pair.driver->connect();
  CHECK(swing(*pair.driver, 5, 0.5, 1) == Heard::lost);
  CHECK(pair.controller->snapshot().ended.find("speed of A1") == 0);
}

TEST_SUITE_END();
