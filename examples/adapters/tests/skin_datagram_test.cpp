// Skin datagrams from friends, strangers and enemies, through real sockets.
//
// Promise: what others send to the skin's port changes nothing; with a key only the sender's datagrams
// count, once and in order
// Tried: strays of twelve kinds; each bit of a datagram, each length, replays, swaps, old questions, 20
// 000 random attacks. Recordings, heard or not, give a restarted receiver nothing; it hears a running
// sender within 10 ms, polled each millisecond; a datagram that comes 120 ms late is refused. Also:
// `examples/compliant_ur5/tests/main_job_test.cpp`
//
// Promise: it does not matter when in a cycle a skin's datagrams come: clocks that drift carry them past the polls
// Tried: 40 datagrams that wait for 7 ms to be read, 40 that are read at once, 40 that wait: no leap of the clock,
// stamps within 3 ms; by the time of the poll there was one, and a tenth of a second without samples. A
// robot whose states are 6 ms late from some time on: none (one, against the robot's clock)

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/sender.hpp"
#include "examples/adapters/socket.hpp"
#include "skinctl/core/contract.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/sensor_kinds.hpp"

using namespace adapters;
using namespace std::chrono_literals;
using skinctl::Nanoseconds;
namespace ip = boost::asio::ip;

namespace {

/// The first datagram gives the offset of the sender's clock.
const skinctl::ClockOffset::Settings at_once{.gather = 0ns};

using Bytes = std::vector<std::uint8_t>;

/// A datagram of version 1 whose cells have the ids `first` and so on.
Bytes plain(std::uint32_t sequence, std::uint32_t first, std::size_t count = 1,
            Nanoseconds sent = Nanoseconds(1'000'000'000)) {
  constexpr std::size_t sample = 44;
  Bytes out(skin::header_size + count * sample);
  const auto put = [&](std::size_t at, auto value) { std::memcpy(&out[at], &value, sizeof value); };
  std::memcpy(out.data(), "SKIN", 4);
  put(4, std::uint16_t(1));
  put(6, static_cast<std::uint16_t>(count));
  put(8, sequence);
  put(12, std::int64_t(sent.count()));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = skin::header_size + k * sample;
    put(at, static_cast<std::uint32_t>(first + k));
    put(at + 4, std::int64_t(sent.count()) - 4'000'000);
    put(at + 12, 0.5f);
  }
  return out;
}

/// Sends to a receiver from a socket of its own.
class Sender {
 public:
  explicit Sender(const skin::ReceiverCore& receiver, const std::string& to = "127.0.0.1")
      : to_(ip::make_address(to), receiver.port()), socket_(io_, to_.protocol()) {}
  void send(const Bytes& bytes) { socket_.send_to(boost::asio::buffer(bytes), to_); }
  /// What the receiver has sent here; false: nothing more.
  bool receive(Bytes& bytes) {
    boost::system::error_code error;
    socket_.non_blocking(true);
    bytes.resize(2000);
    bytes.resize(socket_.receive(boost::asio::buffer(bytes), 0, error));
    return !error;
  }

 private:
  boost::asio::io_context io_;
  ip::udp::endpoint to_;
  ip::udp::socket socket_;
};

std::vector<std::uint32_t> ids(std::span<const skinctl::CellSample> samples) {
  std::vector<std::uint32_t> out;
  for (const auto& s : samples) out.push_back(s.cell);
  return out;
}

/// The same of version 3, sealed where there is a key.
Bytes version_3(std::uint32_t sequence, std::uint32_t first, std::size_t count = 1, Nanoseconds sent = 1s,
                const skin::Question& question = {}, const skin::Key* key = nullptr) {
  std::vector<skinctl::CellSample> samples(count);
  for (std::size_t k = 0; k < count; ++k)
    samples[k] = {.time = sent - 4ms, .cell = static_cast<std::uint32_t>(first + k), .force = {0.5f}};
  std::array<std::uint8_t, skin::largest> room{};
  std::size_t size = skin::write(room, sequence, sent, std::span(std::as_const(samples)),
                                 key != nullptr ? &question : nullptr);
  if (key != nullptr) size = key->seal(skin::Sealed::samples, room, size);
  return {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size)};
}

#if SKINCTL_HAS_SODIUM
skin::Key key_of(std::uint8_t first) {
  std::array<std::uint8_t, skin::Key::size> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(first + i);
  return skin::Key(bytes);
}
/// Version 2: a session in place of an answer.
Bytes of_session(std::uint8_t session, std::uint32_t sequence, std::uint32_t first, const skin::Key& key) {
  Bytes out = plain(sequence, first);
  out[4] = 2;
  out.insert(out.begin() + skin::header_size, skin::question_size, 0);
  out[skin::header_size] = session;
  const std::size_t size = out.size();
  out.resize(size + skin::tag_size);
  CHECK(key.seal(skin::Sealed::version_2, out, size) == out.size());
  return out;
}

/// A skin that holds a key, datagram by datagram.
class Skin : public Sender {
 public:
  Skin(const skin::Receiver& receiver, const skin::Key& key) : Sender(receiver), key_(key) {}
  /// Whether a question has come; then it is the newest.
  bool asked() {
    Bytes bytes;
    bool any = false;
    while (receive(bytes)) any = skin::parse_question(bytes, key_, question) || any;
    return any;
  }
  [[nodiscard]] Bytes sealed(std::uint32_t sequence, std::uint32_t first, Nanoseconds sent = 1s) const {
    return version_3(sequence, first, 1, sent, question, &key_);
  }
  skin::Question question{};

 private:
  skin::Key key_;
};

/// A network between a sender and a receiver, which can be another one after a while: it loses a share of
/// what passes, either way, and keeps a recording.
class Network {
 public:
  explicit Network(double loss = 0)
      : loss_(loss), near_(io_, {ip::address_v4::loopback(), 0}), far_(io_, ip::udp::v4()) {
    near_.non_blocking(true), far_.non_blocking(true);
  }
  [[nodiscard]] std::uint16_t port() const { return near_.local_endpoint().port(); }
  void leads_to(std::uint16_t port) { to_ = {ip::address_v4::loopback(), port}; }
  void pass() {
    for (Bytes bytes(2000); const auto n = receive(near_, bytes, sender_);) {
      recording.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
      if (!lost()) far_.send_to(boost::asio::buffer(bytes.data(), n), to_);
    }
  }
  void pass_back() {
    ip::udp::endpoint ignored;
    for (Bytes bytes(2000); const auto n = receive(far_, bytes, ignored);)
      if (!lost()) near_.send_to(boost::asio::buffer(bytes.data(), n), sender_);
  }
  std::vector<Bytes> recording;

 private:
  static std::size_t receive(ip::udp::socket& socket, Bytes& bytes, ip::udp::endpoint& from) {
    boost::system::error_code error;
    const std::size_t n = socket.receive_from(boost::asio::buffer(bytes), from, 0, error);
    return error ? 0 : n;
  }
  bool lost() { return random_.index(1000) < int(1000 * loss_); }

  double loss_;
  oracle::Random random_{7};
  boost::asio::io_context io_;
  ip::udp::socket near_, far_;
  ip::udp::endpoint to_, sender_;
};
#endif

}  // namespace

TEST_CASE("skin receiver: strays are counted and dropped; the sender's samples all come through") {
  skin::Receiver receiver({.clock = at_once, .real_time = false});
  Sender sender(receiver), stranger(receiver);
  Nanoseconds now = 5s;
  const Bytes press = plain(1'000'000, 77);
  Bytes other_version = plain(1, 1), cut = plain(1, 1, 3), sealed_by_nobody(88);
  other_version[4] = 4;
  cut.resize(cut.size() - 1);
  std::memcpy(sealed_by_nobody.data(), plain(1, 1).data(), skin::header_size);
  sealed_by_nobody[4] = 2;
  const std::vector<Bytes> strays = {Bytes(27, 'x'), Bytes(1473), Bytes(2000, 7),  Bytes{}, press,
                                     other_version,  cut,         sealed_by_nobody};
  for (std::uint32_t k = 1; k <= 500; ++k) {
    stranger.send(k > 1 ? strays[k % strays.size()] : Bytes(3));
    sender.send(plain(k, k));
    if (k % 3 == 0) stranger.send(press);
    now += 4ms;
    const auto heard = receiver.poll(now);
    REQUIRE(ids(heard) == std::vector<std::uint32_t>{k});
    REQUIRE(receiver.silent_for(now) == 0ns);
  }
  const auto& s = receiver.statistics();
  CHECK(s.datagrams == 500);
  CHECK(s.lost == 0);
  CHECK(s.strangers == 63 + 166);
  CHECK(s.stray() == 500 + 166);
}

TEST_CASE("skin receiver: how long a datagram waited to be read changes neither its stamps nor the clock") {
  skin::Receiver receiver({});
  Sender sender(receiver);
  const auto clock = [] { return std::chrono::steady_clock::now().time_since_epoch(); };
  const Nanoseconds ahead = 1h;  // by which the sender's clock is ahead of the robot's
  std::uint32_t k = 0;
  Nanoseconds worst{};
  const auto send_and_read = [&](Nanoseconds after) {
    const Nanoseconds sent = clock();
    ++k;
    sender.send(plain(k, k, 1, sent + ahead));
    std::this_thread::sleep_for(after);
    for (const auto& s : receiver.poll(clock()))
      worst = std::max(worst, std::chrono::abs(s.time - (sent - 4ms)));
  };
  // A tenth of a second and more in which each waits for 7 ms; then some that are read at once.
  for (int n = 0; n < 40; ++n) send_and_read(7ms);
  for (int n = 0; n < 40; ++n) send_and_read(0ms);
  for (int n = 0; n < 40; ++n) send_and_read(7ms);
  CHECK(receiver.statistics().leaps == 0);
  CHECK(receiver.statistics().samples > 60);
  CHECK(worst < 3ms);
}

TEST_CASE(
    "skin receiver: a robot's clock that is known as late as its states come is no leap of the sender's") {
  skin::Receiver receiver({});
  Sender sender(receiver);
  for (std::uint32_t k = 1; k <= 120; ++k) {
    const Nanoseconds real = std::chrono::steady_clock::now().time_since_epoch();
    sender.send(plain(k, k, 1, real + 1h));
    std::this_thread::sleep_for(2ms);
    // For a third of the time all states are 6 ms late: the robot's clock seems to stand behind.
    static_cast<void>(receiver.poll(real + 2ms + 1min - (k > 80 ? 6ms : 0ms)));
  }
  CHECK(receiver.statistics().leaps == 0);
}

TEST_CASE("skin receiver: version 3 beside version 1; another kind of cells is refused and counted") {
  skin::Receiver receiver({.clock = at_once, .real_time = false});
  Sender sender(receiver);
  sender.send(plain(1, 1));
  CHECK(ids(receiver.poll(5s)) == std::vector<std::uint32_t>{1});
  sender.send(version_3(2, 2, 29));
  const auto heard = receiver.poll(5s);
  REQUIRE(heard.size() == 29);
  CHECK(heard[28].cell == 30);
  CHECK(heard[28].measured == skinctl::unsaid);
  skinctl::CellSample old{.time = 1s, .cell = 40, .measured = 0, .unrest = 0};  // a reading that is repeated
  std::array<std::uint8_t, skin::largest> copy{};
  const std::size_t copied = skin::write(copy, 3, 1s, std::span(&std::as_const(old), 1));
  sender.send(Bytes(copy.begin(), copy.begin() + std::ptrdiff_t(copied)));
  CHECK(receiver.poll(5s).empty());
  CHECK(receiver.statistics().repeated == 1);
  Bytes other = version_3(4, 3), flag = other, none = other;
  other[24] = static_cast<std::uint8_t>(other[24] + 1);  // another fingerprint
  flag[20] = 2;                                          // of a version to come
  none[22] = 0;                                          // without readings
  for (const Bytes& bytes : {other, flag, none}) sender.send(bytes);
  CHECK(receiver.poll(5s).empty());
  CHECK(receiver.statistics().other_kind == 1);
  CHECK(receiver.statistics().nonsense == 2);
  CHECK(skin::refusals(receiver.statistics()) ==
        "2 no skin datagrams; 1 of another kind of cells; 1 samples of old readings that somebody repeats");

  // Cells of any kind fit.
  using skinctl::testing::Uskin;
  std::vector<skinctl::SensorSample<Uskin>> taxels(60);
  for (std::size_t k = 0; k < taxels.size(); ++k)
    taxels[k] = {
        .time = 1s, .cell = std::uint32_t(k), .readings = {1, -2, float(k), 20}, .measured = 3, .unrest = 4};
  std::array<std::uint8_t, skin::largest> room{};
  const std::size_t size = skin::write<Uskin>(room, 7, 1s, taxels);
  skin::Datagram d;
  REQUIRE(skin::parse(std::span(room).first(size), d));
  CHECK_FALSE(d.is<skinctl::Hexagon>());
  REQUIRE(d.is<Uskin>());
  CHECK(d.count() == skin::max_samples(4));
  const auto back = d.sample<Uskin>(d.count() - 1);
  CHECK(back.cell == d.count() - 1);
  CHECK(back.readings == taxels[d.count() - 1].readings);
  CHECK(back.measured == 3);
  CHECK(back.unrest == 4);
  // A receiver of that kind takes them, and what is out of its ranges it does not.
  skin::ReceiverOf<Uskin> of_taxels({.noise = 0.7, .clock = at_once, .real_time = false});
  Sender to_taxels(of_taxels);
  to_taxels.send(Bytes(room.begin(), room.begin() + std::ptrdiff_t(size)));
  to_taxels.send(version_3(8, 1));
  const auto felt = of_taxels.poll(5s);
  REQUIRE(felt.size() == 21);  // z above 20 N is none
  CHECK(felt[20].readings == taxels[20].readings);
  CHECK(of_taxels.statistics().bad_samples == d.count() - 21);
  CHECK(of_taxels.statistics().other_kind == 1);
  skin::ReceiverOf<Uskin> another({.clock = at_once, .real_time = false});
  skin::Sender typed("127.0.0.1", another.port());
  CHECK(typed.send<Uskin>(std::span(std::as_const(taxels)).first(20), 1s) == 1);
  CHECK(another.poll(5s).size() == 20);
}

TEST_CASE("skin receiver: many datagrams at once, in bounded polls") {
  skin::Receiver receiver({.max_samples = 1000, .max_datagrams = 100, .clock = at_once, .real_time = false});
  Sender sender(receiver);
  std::uint32_t next = 0;
  for (std::uint32_t k = 1; k <= 90; ++k) sender.send(plain(k, 33 * (k - 1), 33));
  for (std::size_t expected : {990u, 990u, 990u, 0u}) {
    const auto heard = receiver.poll(5s);
    REQUIRE(heard.size() == expected);
    for (const auto& sample : heard) REQUIRE(sample.cell == next++);
  }
  // Heartbeats: none has a sample, and a flood of them does not keep the loop.
  for (std::uint32_t k = 91; k <= 290; ++k) sender.send(plain(k, 0, 0));
  CHECK(receiver.poll(5s).empty());
  CHECK(receiver.statistics().datagrams == 190);
  CHECK(receiver.poll(5s).empty());
  CHECK(receiver.statistics().datagrams == 290);
  CHECK(receiver.statistics().lost == 0);
  CHECK(receiver.buffer() >= 100'000);
}

TEST_CASE("skin receiver: it listens where it is told, and to whom") {
  skin::Receiver second({.address = "127.0.0.2", .clock = at_once, .real_time = false});
  skin::Receiver any({.address = "0.0.0.0", .clock = at_once, .real_time = false});
  skin::Receiver other({.sender = "127.0.0.9"}),
      known({.sender = "127.0.0.1", .clock = at_once, .real_time = false});
  const auto hears = [](skin::Receiver& receiver, const std::string& to) {
    Sender(receiver, to).send(plain(1, 1));
    return receiver.poll(5s).size();
  };
  CHECK(hears(second, "127.0.0.1") == 0);
  CHECK(hears(second, "127.0.0.2") == 1);
  CHECK(hears(any, "127.0.0.3") == 1);
  CHECK(hears(other, "127.0.0.1") == 0);
  CHECK(other.statistics().strangers == 1);
  CHECK(hears(known, "127.0.0.1") == 1);
  CHECK_THROWS_WITH_AS(skin::Receiver({.address = "198.51.100.7"}), doctest::Contains("198.51.100.7"),
                       ConnectionError);
  CHECK_THROWS_WITH_AS(skin::Receiver({.address = "here"}), doctest::Contains("here"), ConnectionError);
  CHECK_THROWS_WITH_AS(skin::Receiver({.sender = "::1"}), doctest::Contains("same family"),
                       skinctl::ConfigurationError);
  CHECK_THROWS_AS(skin::Receiver({.max_samples = 32}), skinctl::ConfigurationError);
  CHECK_THROWS_AS(skin::Receiver({.max_datagrams = 0}), skinctl::ConfigurationError);
}

TEST_CASE(
    "skin receiver: cells that stand still are named, at rest too; quiet ones and those that say nothing are "
    "not") {
  skin::Receiver receiver({.noise = 0.7, .max_cells = 4, .clock = at_once, .real_time = false}),
      undeclared({.clock = at_once, .real_time = false});
  Sender sender(receiver), other(undeclared);
  std::uint32_t number = 0;
  // A keep-alive of 25 measurements each.
  const auto say = [&](std::vector<std::pair<std::uint32_t, std::uint16_t>> cells, float force = 0.01f) {
    std::vector<skinctl::CellSample> samples;
    for (const auto& [cell, unrest] : cells)
      samples.push_back({.time = 1s, .cell = cell, .force = {force}, .measured = 25, .unrest = unrest});
    std::array<std::uint8_t, skin::largest> room{};
    const std::size_t size = skin::write(room, ++number, 1s, std::span(std::as_const(samples)));
    const Bytes bytes(room.begin(), room.begin() + std::ptrdiff_t(size));
    sender.send(bytes), other.send(bytes);
    CHECK(receiver.poll(5s).size() == samples.size());
    CHECK(undeclared.poll(5s).size() == samples.size());
  };
  say({{7, 290}, {5, skinctl::unsaid}});
  CHECK(receiver.frozen().empty());
  say({{7, 0}, {3, 0}, {5, skinctl::unsaid}});
  CHECK(receiver.statistics().frozen == 2);
  CHECK(receiver.frozen() == "2 cells stand still, without the noise of a sensor: frozen or dead (3, 7)");
  say({{7, 300}});
  CHECK(receiver.statistics().frozen == 1);
  say({{8, 0}}, 0);  // rests below its range
  say({{9, 0}});     // one too many to be watched
  CHECK(receiver.statistics().frozen == 1);
  CHECK(receiver.frozen().starts_with("1 cell stands still"));
  CHECK(undeclared.frozen().empty());
}

#if SKINCTL_HAS_SODIUM
TEST_CASE("sealed datagram: the documented example, whose tags another program made") {
  // Python: secret = bytes(range(32)); key k of crypto_kdf is hashlib.blake2b(key=secret, digest_size=32,
  // salt=struct.pack("<QQ", k, 0), person=b"skinctl3" + bytes(8)); a tag is hashlib.blake2b(datagram,
  // key=key, digest_size=16).
  const Bytes tag = {0xb3, 0x54, 0xe0, 0x5d, 0x2e, 0xb6, 0x8f, 0x8e,
                     0xc8, 0xb0, 0xf1, 0x18, 0x5d, 0xb0, 0x78, 0x15};
  const Bytes bytes = {0x53, 0x4b, 0x49, 0x4e, 0x03, 0x00, 0x01, 0x00, 0x2a, 0x00, 0x00, 0x00, 0x00, 0xca,
                       0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x08, 0x00, 0x9c, 0x2b, 0x09, 0x1e,
                       0xa1, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7, 0xa8, 0x07, 0x00, 0x00, 0x00, 0x00, 0xc1,
                       0x5d, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x19, 0x00, 0xfb, 0x00, 0x00, 0x00, 0x00, 0x3e,
                       0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00,
                       0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1d, 0x41, 0x00, 0x00, 0xf4, 0x41};
  const skin::Question question{0xa1, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7, 0xa8};
  const skin::Key key = key_of(0);
  const skinctl::CellSample sample{.time = 996ms,
                                   .cell = 7,
                                   .force = {0.125f, 0.25f, 0.125f},
                                   .proximity = 0.5f,
                                   .acceleration = {0, 0, 9.8125f},
                                   .temperature = 30.5f,
                                   .measured = 25,
                                   .unrest = 251};
  std::array<std::uint8_t, skin::largest> room{};
  REQUIRE(skin::write(room, 42, 1s, std::span(&sample, 1), &question) == 84);
  CHECK(Bytes(room.begin(), room.begin() + 84) == bytes);
  REQUIRE(key.seal(skin::Sealed::samples, room, 84) == 100);
  CHECK(Bytes(room.begin() + 84, room.begin() + 100) == tag);
  const auto whole = std::span(room).first(100);
  CHECK(key.made(skin::Sealed::samples, whole));
  CHECK_FALSE(key.made(skin::Sealed::question, whole));
  CHECK_FALSE(key.made(skin::Sealed::version_2, whole));
  skin::Datagram d;
  REQUIRE(skin::parse(whole, d));
  CHECK(d.sealed);
  CHECK(d.question == question);
  CHECK(d.sequence == 42);
  REQUIRE(d.is<skinctl::Hexagon>());
  REQUIRE(d.count() == 1);
  const auto back = d.sample<skinctl::Hexagon>(0);
  CHECK(back.cell == 7);
  CHECK(back.time == 996ms);
  CHECK(back.temperature == 30.5f);
  CHECK(back.measured == 25);
  CHECK(back.unrest == 251);

  const skin::QuestionBytes asked{0x53, 0x4b, 0x49, 0x51, 0xa1, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6,
                                  0xa7, 0xa8, 0x6f, 0x45, 0xe5, 0x59, 0xe3, 0xa9, 0x1d, 0x2b,
                                  0x5e, 0x24, 0x81, 0xb3, 0xa5, 0xe6, 0x04, 0x99};
  CHECK(skin::question_datagram(question, key) == asked);
  skin::Question heard{};
  CHECK(skin::parse_question(asked, key, heard));
  CHECK(heard == question);
  for (std::size_t bit = 0; bit < 8 * asked.size(); ++bit) {
    auto bad = asked;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << (bit % 8)));
    REQUIRE_FALSE(skin::parse_question(bad, key, heard));
  }
  CHECK_FALSE(skin::parse_question(asked, key_of(1), heard));
  CHECK_FALSE(skin::parse_question(std::span(asked).first(27), key, heard));
  CHECK(version_3(1, 1, 40, 1s, question, &key).size() == 28 + 8 + 29 * 48 + 16);  // full
  CHECK(version_3(1, 1, 40).size() == 28 + 29 * 48);
}

TEST_CASE("skin receiver with a key: only what the key made, as an answer, once, and in order") {
  const skin::Key key = key_of(1);
  skin::Receiver receiver({.key = key, .clock = at_once, .real_time = false});
  Skin sender(receiver, key), other(receiver, key_of(2));
  Sender enemy(receiver);
  const auto heard = [&](Nanoseconds now = 5s) { return ids(receiver.poll(now)); };
  const std::vector<std::uint32_t> none;
  const auto one = [](std::uint32_t id) { return std::vector<std::uint32_t>{id}; };
  const auto& s = receiver.statistics();

  enemy.send(plain(1, 66)), enemy.send(version_3(1, 66));  // no seal
  other.send(other.sealed(1, 66));                         // another key
  enemy.send(of_session(9, 1, 66, key));                   // cannot answer
  CHECK(heard() == none);
  CHECK(s.unsealed == 2);
  CHECK(s.forged == 1);
  CHECK(s.version_2 == 1);
  CHECK_FALSE(other.asked());  // who does not hold the key is asked nothing
  // The first one answers nothing; it is asked at once.
  sender.send(sender.sealed(0, 1));
  CHECK(heard() == none);
  CHECK(s.deaf == 1);
  CHECK(s.stray() == 4);
  CHECK_FALSE(receiver.heard());
  REQUIRE(sender.asked());

  const Bytes first = sender.sealed(1, 1), second = sender.sealed(2, 2), fourth = sender.sealed(4, 4);
  sender.send(first);
  CHECK(heard() == one(1));
  // Every bit counts, and so does the length.
  const std::uint64_t before = s.stray() + s.unasked + s.deaf;
  for (std::size_t bit = 0; bit < 8 * second.size(); ++bit) {
    Bytes bad = second;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << (bit % 8)));
    enemy.send(bad);
    REQUIRE(heard() == none);
  }
  for (std::size_t n = 0; n < second.size(); ++n) {
    enemy.send(Bytes(second.begin(), second.begin() + static_cast<std::ptrdiff_t>(n)));
    REQUIRE(heard() == none);
  }
  CHECK(s.stray() + s.unasked + s.deaf - before == 9 * second.size());
  CHECK(s.lost == 0);

  sender.send(second);
  enemy.send(second);  // replayed at once
  CHECK(heard() == one(2));
  sender.send(fourth);
  sender.send(sender.sealed(3, 3));  // reordered by the network
  CHECK(heard() == one(4));
  CHECK(s.late == 2);
  CHECK(s.lost == 1);

  // 20 ms later another question has been asked; the one before holds for 100 ms.
  sender.send(sender.sealed(5, 5));
  CHECK(heard(5020ms) == one(5));
  REQUIRE(sender.asked());
  const Bytes held_back = sender.sealed(6, 6);
  sender.send(sender.sealed(7, 7));
  CHECK(heard(5040ms) == one(7));
  enemy.send(held_back);
  CHECK(heard(5060ms) == none);
  CHECK(s.late == 3);
  // Silence opens no door: neither to a replay nor to a stranger.
  enemy.send(first), enemy.send(second), enemy.send(fourth), enemy.send(plain(9, 66));
  enemy.send(sender.sealed(9, 66));
  CHECK(heard(50s) == none);
  CHECK(receiver.silent_for(50s) > 44s);
  // The sender may have another port, and goes on; started anew its numbers begin anew with the next
  // question.
  Skin moved(receiver, key);
  REQUIRE(sender.asked());
  moved.question = sender.question;
  moved.send(moved.sealed(8, 8));
  CHECK(heard(50s) == one(8));
  CHECK(heard(50020ms) == none);
  REQUIRE(moved.asked());
  moved.send(moved.sealed(0, 9));
  CHECK(heard(50020ms) == one(9));
  CHECK(s.restarts == 1);
  enemy.send(moved.sealed(0, 66));
  CHECK(heard(50020ms) == none);

  // One without a key does not take what it cannot check.
  skin::Receiver open({.clock = at_once, .real_time = false});
  Sender(open).send(moved.sealed(12, 7));
  CHECK(open.poll(60s).empty());
  CHECK(open.statistics().sealed == 1);
  // The causes, for a person.
  const std::string words = skin::refusals(s);
  CAPTURE(words);
  for (const char* cause : {"3 without a seal", "with a wrong tag", "of version 2", "no answer to a question",
                            "had heard no question yet", "repeated or overtaken"})
    CHECK(words.find(cause) != std::string::npos);
  CHECK(skin::refusals(open.statistics()) == "1 sealed, though no key is given here");
  CHECK(skin::refusals({}).empty());
}

TEST_CASE("skin receiver: version 2 is read on where one asks for it, until the first answer") {
  const skin::Key key = key_of(1);
  skin::Receiver receiver({.key = key, .version_2 = true, .clock = at_once, .real_time = false});
  Skin sender(receiver, key);
  const auto taken = [&](const Bytes& bytes) {
    sender.send(bytes);
    return receiver.poll(5s).size();
  };
  CHECK(taken(of_session(5, 1, 1, key)) == 1);
  CHECK(taken(of_session(5, 1, 1, key)) == 0);
  CHECK(taken(of_session(5, 3, 1, key)) == 1);
  CHECK(taken(of_session(4, 9, 1, key)) == 0);
  CHECK(taken(of_session(6, 1, 1, key)) == 1);
  CHECK(receiver.statistics().lost == 1);
  CHECK(taken(sender.sealed(1, 1)) == 0);
  REQUIRE(sender.asked());
  CHECK(taken(sender.sealed(2, 1)) == 1);
  CHECK(taken(of_session(7, 1, 1, key)) == 0);
  CHECK(receiver.statistics().version_2 == 1);
}

TEST_CASE(
    "skin receiver with a key: whatever an enemy does with what he hears, samples are genuine, once, in "
    "order") {
  const skin::Key key = key_of(3);
  oracle::Random random(11);
  skin::Receiver receiver({.key = key, .clock = at_once, .real_time = false});
  Skin sender(receiver, key);
  Sender enemy(receiver);
  std::vector<Bytes> overheard;
  std::uint32_t id = 1, last = 0, sequence = 0;
  std::size_t genuine = 0, heard = 0;
  Nanoseconds now = 5s;
  const auto hear = [&] {
    for (const auto& sample : receiver.poll(now)) {
      REQUIRE(sample.cell > last);  // ids rise with every genuine datagram
      REQUIRE(sample.cell < id);
      last = sample.cell;
      ++heard;
    }
  };
  sender.send(sender.sealed(++sequence, id++)), hear();  // can answer nothing yet
  for (int k = 0; k < 20000; ++k) {
    const auto what = random.index(6);
    if (what == 0 || overheard.empty()) {
      sender.asked();
      overheard.push_back(sender.sealed(++sequence, id++));
      sender.send(overheard.back());
      ++genuine;
    } else {
      Bytes bytes = overheard[static_cast<std::size_t>(random.index(static_cast<int>(overheard.size())))];
      if (what == 1) {  // mutated
        for (int m = 1 + random.index(4); m > 0; --m)
          bytes[static_cast<std::size_t>(random.index(static_cast<int>(bytes.size())))] =
              static_cast<std::uint8_t>(random.bits());
      } else if (what == 2) {  // of two datagrams
        const Bytes& another =
            overheard[static_cast<std::size_t>(random.index(static_cast<int>(overheard.size())))];
        const auto at = random.index(static_cast<int>(bytes.size()));
        std::copy(another.begin() + at, another.end(), bytes.begin() + at);
      } else if (what == 3) {
        bytes.resize(static_cast<std::size_t>(random.index(1473)));
      }  // else as it was
      enemy.send(bytes);
    }
    if (random.index(8) == 0) now += 1ms, hear();
  }
  hear();
  CHECK(heard == genuine);
}

TEST_CASE("sealed skin: recordings give a restarted receiver nothing, whether they were heard or not") {
  const skin::Key key = key_of(4);
  Network network;
  skin::Sender sender("127.0.0.1", network.port(), key);
  std::uint64_t heard = 0;
  Nanoseconds now = 5s;
  {
    skin::Receiver receiver({.key = key, .clock = at_once, .real_time = false});
    network.leads_to(receiver.port());
    for (int k = 0; k < 1250; ++k, now += 4ms) {
      sender.send(std::span<const skinctl::CellSample>(), now);
      network.pass(), receiver.poll(now), network.pass_back();
    }
    heard = receiver.statistics().datagrams;
    CHECK(heard >= 1249);
    CHECK(receiver.statistics().late == 0);
  }
  for (int k = 0; k < 1250; ++k, now += 4ms) {  // while nobody listens
    sender.send(std::span<const skinctl::CellSample>(), now);
    network.pass();
  }
  REQUIRE(network.recording.size() == 2500);
  skin::Receiver restarted({.key = key, .clock = at_once, .real_time = false});
  Sender enemy(restarted);
  for (const Bytes& bytes : network.recording) {
    enemy.send(bytes);
    now += 4ms;
    CHECK(restarted.poll(now).empty());
  }
  CHECK(restarted.statistics().datagrams == 0);
  CHECK(restarted.statistics().unasked + restarted.statistics().deaf == 2500);
  MESSAGE(skin::refusals(restarted.statistics()));
}

TEST_CASE(
    "sealed skin: a restarted receiver hears a running sender within 10 ms; a restarted sender is heard") {
  const skin::Key key = key_of(5);
  // Milliseconds until the first datagram is taken, of 200 restarts at any instant; sorted.
  const auto restarts = [&](bool of_receiver, double loss, Nanoseconds cycle) {
    Network network(loss);
    auto sender = std::make_unique<skin::Sender>("127.0.0.1", network.port(), key);
    auto receiver = std::make_unique<skin::Receiver>(
        skin::ReceiverConfig{.key = key, .clock = at_once, .real_time = false});
    network.leads_to(receiver->port());
    Nanoseconds now = 5s, from = now;
    std::vector<double> out;
    std::uint64_t before = 0;
    oracle::Random random(3);
    Nanoseconds runs = 150ms;
    for (; out.size() < 200; now += 1ms) {
      if (now % 4ms == 0ns) sender->send(std::span<const skinctl::CellSample>(), now), network.pass();
      if (now % cycle == 0ns) receiver->poll(now), network.pass_back();
      if (before != ~0ull && receiver->statistics().datagrams > before) {
        out.push_back(skinctl::milliseconds(now - from));
        before = ~0ull;
      }
      if (before != ~0ull || now - from < runs) continue;
      if (of_receiver) {
        receiver.reset();
        receiver = std::make_unique<skin::Receiver>(
            skin::ReceiverConfig{.key = key, .clock = at_once, .real_time = false});
        network.leads_to(receiver->port());
      } else {
        sender = std::make_unique<skin::Sender>("127.0.0.1", network.port(), key);
      }
      before = receiver->statistics().datagrams;
      from = now;
      runs = 150ms + random.index(40) * 1ms;
    }
    std::sort(out.begin(), out.end());
    MESSAGE(std::string(of_receiver ? "receiver" : "sender"), " restarted, ", 100 * loss,
            " % lost, polled each ", skinctl::milliseconds(cycle), " ms: heard after ", out[100],
            " ms, 95 % within ", out[190], " ms, all within ", out.back(), " ms");
    return out;
  };
  CHECK(restarts(true, 0, 1ms).back() <= 10);
  CHECK(restarts(true, 0, 8ms).back() <= 20);
  const auto lossy = restarts(true, 0.2, 1ms);
  CHECK(lossy[100] <= 10);
  CHECK(lossy.back() <= 50);
  CHECK(restarts(false, 0, 1ms).back() <= 30);
  CHECK(restarts(false, 0.2, 1ms)[190] <= 60);
}

TEST_CASE("sealed skin: age is told by the receiver's clock") {
  const skin::Key key = key_of(6);
  for (const auto& [late, all] : {std::pair{20ms, true}, {60ms, true}, {120ms, false}, {500ms, false}}) {
    skin::Receiver receiver({.key = key, .clock = at_once, .real_time = false});
    Skin sender(receiver, key);
    std::vector<std::pair<Nanoseconds, Bytes>> under_way;
    std::uint32_t number = 0;
    for (Nanoseconds now = 5s; now < 7s; now += 4ms) {
      sender.asked();
      under_way.emplace_back(now + late, sender.sealed(++number, 1, now));
      for (auto& [at, bytes] : under_way)
        if (at == now) sender.send(bytes);
      receiver.poll(now);
    }
    const auto& s = receiver.statistics();
    MESSAGE("late by ", skinctl::milliseconds(late), " ms: ", s.datagrams, " taken");
    CHECK((all ? s.datagrams > 400 : s.datagrams == 0));
    CHECK(s.unasked + s.deaf > 0);
  }
}

TEST_CASE("key file: 64 hexadecimal digits that only the owner reads") {
  const auto path = std::filesystem::temp_directory_path() / "skinctl_key_test";
  const auto write = [&](const std::string& text, ::mode_t mode = 0600) {
    std::ofstream(path) << text;
    REQUIRE(::chmod(path.c_str(), mode) == 0);
  };
  std::string digits;
  for (int i = 0; i < 32; ++i) digits += {"0123456789abcdef"[i / 16], "0123456789ABCDEF"[i % 16]};
  write(digits + "\n");
  const Bytes text = {1, 2, 3};
  CHECK(skin::Key::read(path).tag(skin::Sealed::samples, text) == key_of(0).tag(skin::Sealed::samples, text));
  for (const std::string& wrong : {std::string(), digits.substr(1), digits + "0", "g" + digits.substr(1)}) {
    write(wrong);
    CHECK_THROWS_WITH_AS(static_cast<void>(skin::Key::read(path)), doctest::Contains("64 hexadecimal digits"),
                         skinctl::ConfigurationError);
  }
  write(digits, 0644);
  CHECK_THROWS_WITH_AS(static_cast<void>(skin::Key::read(path)), doctest::Contains("others may read"),
                       skinctl::ConfigurationError);
  std::filesystem::remove(path);
  CHECK_THROWS_AS(static_cast<void>(skin::Key::read(path)), skinctl::ConfigurationError);
}
#else
TEST_CASE("key: refused without libsodium, by the name of its package") {
  const std::array<std::uint8_t, skin::Key::size> bytes{};
  CHECK_THROWS_WITH_AS(skin::Key{bytes}, doctest::Contains("libsodium-dev"), skinctl::ConfigurationError);
}
#endif
