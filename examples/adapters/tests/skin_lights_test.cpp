// Lights of a skin's cells, told over the wire.
//
// Promise: a cell's light is on when whoever the skin answers to says so, and what others send lights nothing
// Tried: bytes that another program made, open and sealed; each bit, each length, 20 000 random datagrams; an
// old picture, a picture without a seal, an answer from another port; a lost command, a lost answer

#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/sender.hpp"
#include "skinctl/core/contract.hpp"

using namespace adapters;
using namespace std::chrono_literals;
using skinctl::Nanoseconds;
namespace ip = boost::asio::ip;

namespace {

using Bytes = std::vector<std::uint8_t>;
const std::vector<std::uint32_t> three = {14, 5, 7};
constexpr std::uint64_t number = 0x0102030405060708;
/// Cells 5, 7 and 14, by `struct.pack("<HHQI", sealed, 10, number, 5)` and two bytes of bits.
const Bytes open_picture = {0x53, 0x4b, 0x49, 0x4c, 0x00, 0x00, 0x0a, 0x00, 0x08, 0x07, 0x06,
                            0x05, 0x04, 0x03, 0x02, 0x01, 0x05, 0x00, 0x00, 0x00, 0x05, 0x02};
const Bytes open_answer = {0x53, 0x4b, 0x49, 0x41, 0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01};

Bytes written(const skin::Picture& picture, bool sealed = false) {
  Bytes room(skin::largest);
  room.resize(skin::write_picture(room, picture, sealed));
  return room;
}
void damaged(const Bytes& good, const skin::Key* key) {
  skin::Picture out;
  REQUIRE(skin::parse_picture(good, key, out));
  for (std::size_t size = 0; size < good.size(); ++size)
    REQUIRE_FALSE(skin::parse_picture(std::span(good).first(size), key, out));
  Bytes longer = good;
  longer.push_back(0);
  REQUIRE_FALSE(skin::parse_picture(longer, key, out));
  if (key == nullptr) return;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << (bit % 8)));
    REQUIRE_FALSE(skin::parse_picture(bad, key, out));
  }
}

/// A receiver and a sender of a skin without touches, cycle by cycle.
struct Wire {
  skin::Receiver receiver;
  skin::Sender sender;
  Nanoseconds now = 1s;
  explicit Wire(skin::ReceiverConfig config = {})
      : receiver(config), sender("127.0.0.1", receiver.port(), config.key) {}
  /// `answers`: the skin switches its lights.
  void cycle(bool answers = true) {
    now += 4ms;
    sender.send(std::span<const skinctl::CellSample>(), now);
    if (sender.wanted() != nullptr) {
      last = *sender.wanted();
      if (answers) sender.lights_shown();
    }
    receiver.poll(now);
  }
  void cycles(int count, bool answers = true) {
    for (int k = 0; k < count; ++k) cycle(answers);
  }
  skin::Picture last;
};

void switches(Wire& w) {
  w.cycles(5);
  CHECK(w.receiver.shown());
  w.receiver.show(three);
  CHECK_FALSE(w.receiver.shown());
  w.cycles(3, false);  // the skin takes its time: nobody says that it is done
  CHECK_FALSE(w.receiver.shown());
  w.cycles(8);
  CHECK(w.receiver.shown());
  for (std::uint32_t id = 0; id < 40; ++id) CHECK(w.last.on(id) == (id == 5 || id == 7 || id == 14));
  w.receiver.show({});
  w.cycles(3);
  CHECK(w.receiver.shown());
  for (std::uint32_t id = 0; id < 40; ++id) CHECK_FALSE(w.last.on(id));
  CHECK(w.receiver.statistics().stray() == 0);
}

}  // namespace

TEST_CASE("skin lights: bytes that another program made") {
  CHECK(written(skin::Picture::of(three, number)) == open_picture);
  skin::Picture p;
  REQUIRE(skin::parse_picture(open_picture, nullptr, p));
  CHECK(p.number == number);
  for (std::uint32_t id = 0; id < 30; ++id) CHECK(p.on(id) == (id == 5 || id == 7 || id == 14));
  CHECK(p.on(0xffffffffu) == false);
  const auto answer = skin::shown_datagram(number);
  CHECK(Bytes(answer.begin(), answer.end()) == open_answer);
  CHECK(skin::parse_shown(open_answer, nullptr) == number);
  damaged(open_picture, nullptr);

  CHECK(written(skin::Picture::of({}, 1)).size() == skin::Picture::header);
  const std::vector<std::uint32_t> far = {0, 8191}, too_far = {0, 8192};
  CHECK(written(skin::Picture::of(far, 1)).size() == skin::Picture::header + 1024);
  CHECK_THROWS_WITH_AS(static_cast<void>(skin::Picture::of(too_far, 1)),
                       doctest::Contains("distance of the ids"), skinctl::ConfigurationError);
}

TEST_CASE("skin lights: whatever arrives, a picture has no light beyond its row") {
  std::mt19937_64 rng(1);
  int taken = 0;
  for (int k = 0; k < 20000; ++k) {
    Bytes bytes = open_picture;
    for (int n = 0; n < 4; ++n) bytes[4 + rng() % (bytes.size() - 4)] = static_cast<std::uint8_t>(rng());
    if (rng() % 4 == 0) bytes.resize(rng() % 1200);
    skin::Picture p;
    if (!skin::parse_picture(bytes, nullptr, p)) {
      REQUIRE(p.number == 0);
      continue;
    }
    ++taken;
    REQUIRE(p.count <= skin::Picture::most);
    REQUIRE(std::uint64_t(p.first) + p.count <= 0x100000000u);
    bool beyond = false;
    for (std::size_t i = p.count; i < 8 * p.bits.size(); ++i)
      beyond = beyond || (p.bits[i / 8] >> (i % 8) & 1u) != 0;
    REQUIRE_FALSE(beyond);
  }
  CHECK(taken > 100);
}

TEST_CASE("skin lights: a skin switches them and says so; a lost command or answer comes again") {
  Wire w;
  switches(w);

  // Someone else than the sender says that it is done.
  w.receiver.show(three);
  boost::asio::io_context io;
  ip::udp::socket enemy(io, ip::udp::v4());
  const auto said = skin::shown_datagram(w.last.number + 1'000'000'000);
  enemy.send_to(boost::asio::buffer(said), {ip::address_v4::loopback(), w.receiver.port()});
  w.cycles(1, false);
  CHECK_FALSE(w.receiver.shown());
  CHECK(w.receiver.statistics().nonsense == 1);
  w.cycles(8);
  CHECK(w.receiver.shown());

  // A picture that is older than the newest one changes nothing.
  const skin::Picture newest = w.last;
  w.receiver.poll(w.now);
  skin::Picture old = skin::Picture::of(three, newest.number - 1);
  boost::asio::io_context other;
  ip::udp::socket here(other, ip::udp::endpoint(ip::address_v4::loopback(), 0));
  skin::Sender sender("127.0.0.1", here.local_endpoint().port());
  sender.send(std::span<const skinctl::CellSample>(), 1s);
  ip::udp::endpoint from;
  Bytes got(2000);
  here.receive_from(boost::asio::buffer(got), from);
  here.send_to(boost::asio::buffer(written(newest)), from);
  sender.send(std::span<const skinctl::CellSample>(), 2s);
  REQUIRE(sender.wanted() != nullptr);
  here.send_to(boost::asio::buffer(written(old)), from);
  sender.send(std::span<const skinctl::CellSample>(), 3s);
  CHECK(sender.wanted()->number == newest.number);
  CHECK(sender.foreign() == 1);
  sender.lights_shown();
  CHECK(sender.wanted() == nullptr);
  here.send_to(boost::asio::buffer(written(newest)), from);  // its answer was lost
  sender.send(std::span<const skinctl::CellSample>(), 4s);
  CHECK(sender.wanted() != nullptr);
}

#if SKINCTL_HAS_SODIUM
TEST_CASE("skin lights, sealed: only who holds the key lights any") {
  // Python, as in PROTOCOL.md, with key 3.
  const Bytes sealed = {0x53, 0x4b, 0x49, 0x4c, 0x01, 0x00, 0x0a, 0x00, 0x08, 0x07, 0x06, 0x05, 0x04,
                        0x03, 0x02, 0x01, 0x05, 0x00, 0x00, 0x00, 0x05, 0x02, 0x4e, 0x35, 0x1b, 0x2e,
                        0x65, 0x30, 0x83, 0xea, 0xc6, 0xd8, 0x8e, 0xa2, 0x9b, 0xf4, 0x02, 0xe6};
  const Bytes answer = {0x53, 0x4b, 0x49, 0x41, 0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01, 0x9a, 0x6d,
                        0xf3, 0xfa, 0x6a, 0xbd, 0x8d, 0x76, 0xa5, 0x6d, 0x95, 0x61, 0x61, 0x68, 0xc5, 0x17};
  std::array<std::uint8_t, skin::Key::size> secret{};
  for (std::size_t i = 0; i < secret.size(); ++i) secret[i] = static_cast<std::uint8_t>(i);
  const skin::Key key(secret);
  damaged(sealed, &key);
  skin::Picture p;
  CHECK_FALSE(skin::parse_picture(open_picture, &key, p));
  CHECK_FALSE(skin::parse_picture(sealed, nullptr, p));
  CHECK(skin::parse_shown(answer, &key) == number);
  CHECK_FALSE(skin::parse_shown(open_answer, &key));
  CHECK_FALSE(skin::parse_shown(answer, nullptr));
  for (std::size_t bit = 0; bit < 8 * answer.size(); ++bit) {
    Bytes bad = answer;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << (bit % 8)));
    REQUIRE_FALSE(skin::parse_shown(bad, &key));
  }
  skin::ReceiverConfig config;
  config.key = key;
  Wire w(config);
  w.cycles(30);
  switches(w);
}
#endif
