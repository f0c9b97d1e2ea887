// The Allegro hand's frames and datagrams, byte by byte as the makers' guides and drivers have them.
//
// Promise: what an Allegro hand and its driver say to each other is what the maker's tables say; any
// bytes are survived
// Tried: V4, V5, V5 Sense, both sides, over a socket pair, slcan on a pseudo-terminal, UDP, and SocketCAN
// in User-Mode Linux; 200 000 frames, 50 000 datagrams, 300 000 characters. Also:
// `examples/simulated_allegro/tests`

#include <doctest/doctest.h>

#include <random>
#include <string_view>
#include <vector>

#include "examples/adapters/allegro/datagrams.hpp"
#include "examples/adapters/allegro/frames.hpp"
#include "examples/adapters/allegro/position_set.hpp"
#include "examples/adapters/can/link.hpp"

using namespace adapters::allegro;
using adapters::can::SlcanCodec;
using namespace std::chrono_literals;

namespace {

Frame raw(std::uint16_t id, std::initializer_list<int> bytes) {
  Frame f;
  f.id = id;
  for (const int b : bytes) f.data[f.size++] = static_cast<std::uint8_t>(b);
  return f;
}
template <class T>
T as(const Frame& f, Generation g = Generation::v4, unsigned hand = 0, TactileFrames t = TactileFrames::two) {
  const Message m = decode(f, g, hand, t);
  REQUIRE(std::holds_alternative<T>(m));
  return std::get<T>(m);
}
bool unknown(const Frame& f, Generation g = Generation::v5_sense, unsigned hand = 0) {
  return std::holds_alternative<Unknown>(decode(f, g, hand));
}

std::vector<std::uint8_t> header(std::uint8_t type, std::uint16_t length) {
  std::vector<std::uint8_t> b = {
      0x56, 0x35, 0x42, 0x32, 0x01, type, std::uint8_t(length & 0xff), std::uint8_t(length >> 8), 0x2a, 0,
      0,    0,    0x10, 0x27, 0,    0};
  return b;
}

/// What a line of characters is to the slcan codec.
std::vector<Frame> typed(SlcanCodec& codec, std::string_view text) {
  std::vector<Frame> out;
  for (const char c : text)
    if (const auto f = codec.take(c)) out.push_back(*f);
  return out;
}

}  // namespace

TEST_CASE("Allegro frames to the hand: ids are message << 2 | hand, numbers little-endian") {
  CHECK(servo(true) == raw(0x100, {}));
  CHECK(servo(false, 3) == raw(0x107, {}));
  CHECK(period(3, 0, 0) == raw(0x204, {3, 0, 0, 0, 0, 0}));
  CHECK(period(0x1234, 0, 0, 2) == raw(0x206, {0x34, 0x12, 0, 0, 0, 0}));
  CHECK(torque(0, {1, -1, 675, -32768}) == raw(0x180, {1, 0, 0xff, 0xff, 0xa3, 0x02, 0, 0x80}));
  CHECK(torque(3, {0, 0, 0, 0}, 1) == raw(0x18d, {0, 0, 0, 0, 0, 0, 0, 0}));
  Frame info = raw(0x200, {});
  info.remote = true;
  CHECK(request(message::info) == info);
  CHECK(request(message::serial, 1).id == 0x221);
}

TEST_CASE("Allegro frames from the hand") {
  const Info info = as<Info>(raw(0x200, {0x01, 0x04, 0x02, 0x03, 1, 41, 0x07}));
  CHECK(info.hardware == 0x0401);
  CHECK(info.firmware == 0x0302);
  CHECK(info.side == Side::left);
  CHECK(int(info.temperature) == 41);
  CHECK(info.status == (status::servo_on | status::over_temperature | status::communication_fault));
  CHECK(as<Info>(raw(0x200, {0, 0, 0, 0, 0, 0, 0})).side == Side::right);

  const Serial serial = as<Serial>(raw(0x220, {'5', 'T', 'A', 'L', '0', '0', '1', 7}), Generation::v5);
  CHECK(std::string_view(serial.text.data(), 8) == "5TAL001?");
  CHECK(serial.side() == Side::left);
  const Serial other = as<Serial>(raw(0x220, {'5', 'T', 'B', 'R', '0', '0', '1', '7'}), Generation::v5);
  CHECK(other.side() == Side::right);

  for (unsigned f = 0; f < 4; ++f) {
    const auto p = as<Positions>(
        raw(std::uint16_t((0x20 + f) << 2 | 2), {1, 0, 0xff, 0xff, 0, 0x80, 0xff, 0x7f}), Generation::v4, 2);
    CHECK(p.finger == f);
    CHECK(p.count == std::array<std::int16_t, 4>{1, -1, -32768, 32767});
  }
  CHECK(as<Orientation>(raw(0x0c0, {1, 0, 2, 0, 0xff, 0xff})).angle ==
        std::array<std::uint16_t, 3>{1, 2, 0xffff});
  const auto t = as<Temperature>(raw(0x0e8, {45, 0, 0, 0}));
  CHECK(int(t.finger) == 2);
  CHECK(t.celsius == 45);
  CHECK(as<Temperature>(raw(0x0e0, {0xff, 0xff, 0xff, 0xff})).celsius == -1);
}

TEST_CASE("Allegro V5 Sense: tactile readings of both layouts, currents") {
  const Generation g = Generation::v5_sense;
  const auto t = as<Tactile>(raw(0x154, {0, 1, 2, 3, 4, 5, 254, 255}), g);
  CHECK(int(t.first) == 8);
  CHECK(int(t.count) == 8);
  CHECK(t.reading == std::array<std::uint16_t, 8>{0, 4, 8, 12, 16, 20, 1016, 0});
  CHECK(unknown(raw(0x158, {0, 0, 0, 0, 0, 0, 0, 0}), g));
  const auto old =
      as<Tactile>(raw(0x15c, {0x01, 0x02, 0, 5, 0x80, 0, 0x7f, 0xff}), g, 0, TactileFrames::four);
  CHECK(int(old.first) == 12);
  CHECK(int(old.count) == 4);
  CHECK(old.reading == std::array<std::uint16_t, 8>{0x102, 5, 0, 0x7fff, 0, 0, 0, 0});
  const auto c = as<Currents>(raw(0x00c, {127, 0x81, 0, 1, 0, 0, 0, 0x80}), g);
  CHECK(int(c.first) == 8);
  CHECK(c.milliampere[0] == doctest::Approx(240));
  CHECK(c.milliampere[1] == doctest::Approx(-240));
  CHECK(c.milliampere[3] == doctest::Approx(240.0 / 127));
  CHECK(c.milliampere[7] == doctest::Approx(-240.0 * 128 / 127));
  for (const int id : {0x150, 0x154, 0x000}) {  // no other generation has them
    CHECK(unknown(raw(static_cast<std::uint16_t>(id), {0, 0, 0, 0, 0, 0, 0, 0}), Generation::v4));
    CHECK(unknown(raw(static_cast<std::uint16_t>(id), {0, 0, 0, 0, 0, 0, 0, 0}), Generation::v5));
  }
}

TEST_CASE("Allegro frames that say nothing: other hands, requests, short ones, every id and size") {
  CHECK(unknown(raw(0x081, {0, 0, 0, 0, 0, 0, 0, 0})));  // hand 1
  CHECK(unknown(request(message::info)));
  for (const int m : {0x80, 0x88, 0x20, 0x30, 0x38, 0x54, 0x00}) {
    Frame f;
    f.id = static_cast<std::uint16_t>(m << 2);
    CHECK(unknown(f));
    f.size = 3;
    CHECK(unknown(f));
    f.size = 200;  // more than there is room for
    CHECK(unknown(f));
  }
  std::mt19937 rng(1);
  std::size_t known = 0;
  for (int k = 0; k < 200000; ++k) {
    Frame f;
    f.id = static_cast<std::uint16_t>(rng() % 0x900);
    f.remote = rng() % 8 == 0;
    f.size = static_cast<std::uint8_t>(rng() % 8 == 0 ? rng() : 8);
    for (auto& b : f.data) b = static_cast<std::uint8_t>(rng());
    const Message m = decode(f, static_cast<Generation>(k % 3), rng() % 4, static_cast<TactileFrames>(k % 2));
    if (const auto* p = std::get_if<Positions>(&m)) known += p->finger < 4;
    if (const auto* t = std::get_if<Tactile>(&m)) CHECK(t->first + t->count <= 16);
    if (const auto* c = std::get_if<Currents>(&m)) CHECK(c->first + 8 <= 16);
  }
  CHECK(known > 10);
}

TEST_CASE("Allegro gears: a V4 has none, a V5 Sense has, a V5 as it is chosen") {
  using std::nullopt;
  CHECK(gears(Generation::v4, nullopt) == Gears::plain);
  CHECK(gears(Generation::v5_sense, nullopt) == Gears::geared);
  CHECK(gears(Generation::v5, nullopt) == Gears::unknown);
  for (const auto g : {Generation::v5, Generation::v5_sense}) {
    CHECK(gears(g, true) == Gears::geared);
    CHECK(gears(g, false) == Gears::plain);
  }
}

TEST_CASE("Allegro numbers: encoder steps, PWM and its caps, currents, gears, what is no number") {
  CHECK(encoder_step(Generation::v4) * 65536 == doctest::Approx(5.8171825967));  // 333.3 degrees
  CHECK(encoder_step(Generation::v5) * 180 / 3.14159265358979 == doctest::Approx(0.088));
  const auto v4 = TorqueScale::of(Generation::v4, 0.7, Gears::plain);
  skinctl::JointTorque<16> tau;
  tau[0] = 0.07;
  tau[1] = -0.0700001;
  tau[2] = 1e9;
  tau[3] = -std::numeric_limits<double>::infinity();
  tau[4] = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 5; i < 16; ++i) tau[i] = 100;
  CHECK(v4.encode(tau) == std::array<std::int16_t, 16>{120, -120, 450, -285, 0, 675, 450, 285, 375, 675, 450,
                                                       285, 525, 405, 270, 270});
  CHECK(v4.limit()[1] == doctest::Approx(675 * 0.7 / 1200));
  const auto v5 = TorqueScale::of(Generation::v5, 0.7, Gears::geared),
             plain_v5 = TorqueScale::of(Generation::v5, 0.7, Gears::plain),
             unknown_v5 = TorqueScale::of(Generation::v5, 0.7, Gears::unknown);
  tau = skinctl::JointTorque<16>::constant(0.1);
  for (std::size_t i = 0; i < 16; ++i) {
    CHECK(plain_v5.encode(tau)[i] == 143);
    const bool gear = i == 1 || i == 5 || i == 9;
    CHECK(v5.encode(tau)[i] == (gear ? 71 : 143));
    CHECK(unknown_v5.encode(tau)[i] == (gear ? 71 : 143));
    CHECK(unknown_v5.encode(skinctl::JointTorque<16>::constant(9))[i] == (gear ? 120 : 240));
    CHECK(unknown_v5.limit()[i] == doctest::Approx(240.0 / 1430));  // of the type that gives less
    CHECK(v5.encode(skinctl::JointTorque<16>::constant(-9))[i] == -240);
  }
}

TEST_CASE("Allegro datagrams: header, joints with the thumb first on the wire") {
  const auto hello = plain(DatagramType::hello, 0x2a, 10000);
  auto expected = header(0x10, 0);
  CHECK(std::equal(hello.begin(), hello.end(), expected.begin(), expected.end()));

  std::array<std::int16_t, 16> value{};
  for (std::size_t i = 0; i < 16; ++i) value[i] = static_cast<std::int16_t>(-240 + 16 * int(i));
  const auto sent = torques(value, 0x2a, 10000);
  expected = header(0x03, 32);
  CHECK(std::equal(expected.begin(), expected.end(), sent.begin()));
  CHECK(int(sent[16]) == 0xd0);  // joint 12, the thumb's first: -48
  CHECK(int(sent[17]) == 0xff);
  CHECK(int(sent[24]) == 0x10);  // joint 0: -240
  CHECK(int(sent[25]) == 0xff);

  auto bytes = header(0x02, 164);
  bytes.resize(16 + 164);
  bytes[16] = 7;
  bytes[16 + 4] = 0xfe;  // thumb's first position: -2
  bytes[16 + 5] = 0xff;
  bytes[16 + 4 + 8] = 5;       // joint 0
  bytes[16 + 36 + 8] = 9;      // its current
  bytes[16 + 68 + 30] = 0x34;  // cell 15
  bytes[16 + 68 + 31] = 0x12;
  bytes[16 + 100 + 16] = 0xff;  // velocity of joint 0
  const auto d = parse(bytes);
  REQUIRE(d);
  CHECK(d->sequence == 42);
  CHECK(d->milliseconds == 10000);
  const auto t = telemetry(*d);
  REQUIRE(t);
  CHECK(t->sample == 7);
  CHECK(t->position[12] == -2);
  CHECK(t->position[0] == 5);
  CHECK(t->current[0] == 9);
  CHECK(t->tactile[15] == 0x1234);
  CHECK(t->velocity[0] == 255);

  auto fault = header(0x37, 8);
  for (const int b : {1, 0, 0, 0x80, 2, 0, 0, 0}) fault.push_back(static_cast<std::uint8_t>(b));
  CHECK(fault_mask(*parse(fault))->motors == 0x80000001u);
  CHECK(fault_mask(*parse(fault))->sensors == 2);
  auto error = header(0x50, 2);
  error.push_back(16);
  error.push_back(0x20);
  CHECK(int(motor_error(*parse(error))->joint) == 16);
  CHECK_FALSE(telemetry(*parse(error)));
}

TEST_CASE("Allegro datagrams that are cut, of another version or garbled") {
  auto bytes = header(0x02, 164);
  bytes.resize(16 + 164);
  for (std::size_t n = 0; n < bytes.size(); ++n) CHECK_FALSE(parse({bytes.data(), n}));
  CHECK(parse(bytes));
  for (std::size_t i = 0; i < 5; ++i) {  // magic, version
    auto wrong = bytes;
    wrong[i] ^= 1;
    CHECK_FALSE(parse(wrong));
  }
  auto shorter = bytes;
  shorter[6] = 163;
  REQUIRE(parse(shorter));
  CHECK_FALSE(telemetry(*parse(shorter)));
  std::mt19937 rng(2);
  for (int k = 0; k < 50000; ++k) {
    auto wrong = bytes;
    wrong.resize(rng() % (wrong.size() + 40));
    for (int n = 0; n < 3 && !wrong.empty(); ++n)
      wrong[rng() % wrong.size()] = static_cast<std::uint8_t>(rng());
    const auto d = parse(wrong);
    if (!d) continue;
    CHECK(d->payload.data() + d->payload.size() <= wrong.data() + wrong.size());
    static_cast<void>(telemetry(*d)), static_cast<void>(fault_mask(*d)), static_cast<void>(motor_error(*d));
    static_cast<void>(hello_answer(*d)), static_cast<void>(serial_answer(*d));
  }
}

TEST_CASE("slcan: the characters of frames, there and back, and lines that are none") {
  std::array<char, 32> text{};
  const auto line = [&](const Frame& f) { return std::string(text.data(), SlcanCodec::write(f, text)); };
  CHECK(line(raw(0x180, {1, 0xab})) == "t180201AB\r");
  CHECK(line(request(message::info)) == "r2000\r");
  SlcanCodec codec;
  const auto got = typed(codec, "\a\rt180201ab\rr2000\rt07F0\rz\rV1013\rt10021122BEEF\r");
  REQUIRE(got.size() == 4);
  CHECK(got[0] == raw(0x180, {1, 0xab}));
  CHECK(got[1] == request(message::info));
  CHECK(got[2] == raw(0x07f, {}));
  CHECK(got[3] == raw(0x100, {0x11, 0x22}));  // with a time stamp of the adapter
  CHECK(codec.nonsense() == 0);
  for (const char* wrong :
       {"t\r", "t18\r", "t180\r", "t1809000000000000000000\r", "t18021\r", "t1802xx00\r", "t18020000000\r",
        "tfff0\r", "rg000\r", "t18080000000000000000000000000000000000000000000000\r"})
    CHECK(typed(codec, wrong).empty());
  CHECK(codec.nonsense() == 10);
  CHECK(typed(codec, "t1000\r").size() == 1);  // the next whole line is read again
  std::mt19937 rng(3);
  for (int k = 0; k < 300000; ++k) {
    constexpr std::string_view often = "tr0123456789abcdefABCDEF\r\r\r";
    const char c = rng() % 16 == 0 ? static_cast<char>(rng()) : often[rng() % often.size()];
    if (const auto f = codec.take(c)) CHECK((f->size <= 8 && f->id <= 0x7ff));
  }
}

TEST_CASE("Sets of positions: order does not matter, losses begin anew, no set mixes instants") {
  PositionSet set(3ms);
  using A = PositionSet::Added;
  // The number of a sample is in every position.
  const auto add = [&](unsigned finger, int sample, std::chrono::nanoseconds at) {
    const auto n = static_cast<std::int16_t>(sample);
    return set.add({static_cast<std::uint8_t>(finger), {n, n, n, n}}, at);
  };
  CHECK(add(2, 1, 0us) == A::part);
  CHECK(add(0, 1, 100us) == A::part);
  CHECK(add(0, 1, 150us) == A::duplicate);
  CHECK(add(3, 1, 200us) == A::part);
  CHECK(add(1, 1, 300us) == A::complete);
  CHECK(set.stamp() == 0us);
  CHECK(add(1, 1, 350us) == A::duplicate);
  CHECK(set.incomplete() == 0);
  std::mt19937 rng(4);
  std::uint64_t complete = 0, mixed = 0;
  for (int sample = 2; sample < 20000; ++sample) {
    std::array<unsigned, 4> order = {0, 1, 2, 3};
    if (rng() % 5 == 0) std::swap(order[rng() % 4], order[rng() % 4]);
    for (std::size_t k = 0; k < 4; ++k) {
      if (rng() % 10 == 0) continue;
      const auto at = sample * 3ms + k * 100us;
      for (unsigned twice = rng() % 20 == 0 ? 2 : 1; twice > 0; --twice) {
        if (add(order[k], sample, at) != A::complete) continue;
        ++complete;
        for (const auto n : set.count()) mixed += n != static_cast<std::int16_t>(sample);
        CHECK(set.stamp() >= sample * 3ms);
      }
    }
  }
  CHECK(mixed == 0);
  CHECK(complete > 12000);  // 0.9^4 of them
  CHECK(complete < 14000);
  CHECK(set.incomplete() + complete > 19900);
}
