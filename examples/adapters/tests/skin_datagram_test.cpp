// Skin datagrams from friends, strangers and enemies, through real sockets.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/socket.hpp"
#include "skinctl/core/contract.hpp"
#include "tests/support/robot_table.hpp"

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
  Bytes out(skin::header_size + count * skin::sample_size);
  const auto put = [&](std::size_t at, auto value) { std::memcpy(&out[at], &value, sizeof value); };
  std::memcpy(out.data(), "SKIN", 4);
  put(4, std::uint16_t(1));
  put(6, static_cast<std::uint16_t>(count));
  put(8, sequence);
  put(12, std::int64_t(sent.count()));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = skin::header_size + k * skin::sample_size;
    put(at, static_cast<std::uint32_t>(first + k));
    put(at + 4, std::int64_t(sent.count()) - 4'000'000);
    put(at + 12, 0.5f);
  }
  return out;
}

/// Sends to a receiver from a socket of its own.
class Sender {
 public:
  explicit Sender(const skin::Receiver& receiver, const std::string& to = "127.0.0.1")
      : to_(ip::make_address(to), receiver.port()), socket_(io_, to_.protocol()) {}
  void send(const Bytes& bytes) { socket_.send_to(boost::asio::buffer(bytes), to_); }

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

#if SKINCTL_HAS_SODIUM
skin::Key key_of(std::uint8_t first) {
  std::array<std::uint8_t, skin::Key::size> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(first + i);
  return skin::Key(bytes);
}
Bytes sealed(std::uint64_t session, std::uint32_t sequence, std::uint32_t first, const skin::Key& key,
             std::size_t count = 1) {
  Bytes out = plain(sequence, first, count);
  const std::size_t size = out.size();
  out.resize(size + skin::session_size + skin::tag_size);
  REQUIRE(skin::seal(out, size, session, key) == out.size());
  return out;
}
#endif

}  // namespace

TEST_CASE("skin receiver: strays are counted and dropped; the sender's samples all come through") {
  skin::Receiver receiver({.clock = at_once});
  Sender sender(receiver), stranger(receiver);
  Nanoseconds now = 5s;
  const Bytes press = plain(1'000'000, 77);
  Bytes other_version = plain(1, 1), cut = plain(1, 1, 3), sealed_by_nobody(88);
  other_version[4] = 3;
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

TEST_CASE("skin receiver: many datagrams at once, in bounded polls") {
  skin::Receiver receiver({.max_samples = 1000, .max_datagrams = 100, .clock = at_once});
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
  skin::Receiver second({.address = "127.0.0.2", .clock = at_once});
  skin::Receiver any({.address = "0.0.0.0", .clock = at_once});
  skin::Receiver other({.sender = "127.0.0.9"}), known({.sender = "127.0.0.1", .clock = at_once});
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

#if SKINCTL_HAS_SODIUM
TEST_CASE("sealed datagram: the documented example, whose tag another program made") {
  // Python: hashlib.blake2b(datagram without tag, key=bytes(range(32)), digest_size=16)
  const Bytes tag = {0x6c, 0x25, 0x33, 0x73, 0x4d, 0xd2, 0x44, 0x2f,
                     0x51, 0xbe, 0xa9, 0x1f, 0xa8, 0x03, 0xba, 0x00};
  Bytes bytes = {0x53, 0x4b, 0x49, 0x4e, 0x01, 0x00, 0x01, 0x00, 0x2a, 0x00, 0x00, 0x00, 0x00,
                 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0xc1,
                 0x5d, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80,
                 0x3e, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x00,
                 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1d, 0x41, 0x00, 0x00, 0xf4, 0x41};
  bytes.resize(88);
  const skin::Key key = key_of(0);
  REQUIRE(skin::seal(bytes, 64, 5, key) == 88);
  CHECK(Bytes(bytes.end() - 16, bytes.end()) == tag);
  CHECK(key.made(bytes));
  skin::Datagram d;
  REQUIRE(skin::parse(bytes, d));
  CHECK(d.sealed);
  CHECK(d.session == 5);
  CHECK(d.sequence == 42);
  REQUIRE(d.count() == 1);
  CHECK(d.sample(0).cell == 7);
  CHECK(d.sample(0).temperature == 30.5f);
  // What cannot be sealed: too full, no room, no datagram, sealed already.
  Bytes full = plain(1, 1, 33);
  const std::size_t size = full.size();
  full.resize(size + 24);
  CHECK(skin::seal(full, size, 5, key) == 0);
  CHECK(skin::seal(full, full.size(), 5, key) == 0);
  CHECK(skin::seal(bytes, 88, 5, key) == 0);
  Bytes junk(100);
  CHECK(skin::seal(junk, 64, 5, key) == 0);
  CHECK(sealed(1, 1, 1, key, 32).size() <= skin::largest);
}

TEST_CASE("skin receiver with a key: only what the key made, once, and in order") {
  const skin::Key key = key_of(1);
  skin::Receiver receiver({.key = key, .clock = at_once});
  Sender sender(receiver), enemy(receiver);
  const auto heard = [&](Nanoseconds now = 5s) { return ids(receiver.poll(now)); };
  const std::vector<std::uint32_t> none;
  const auto one = [](std::uint32_t id) { return std::vector<std::uint32_t>{id}; };

  enemy.send(plain(1, 66));                 // no seal
  enemy.send(sealed(9, 1, 66, key_of(2)));  // another key
  CHECK(heard() == none);
  CHECK_FALSE(receiver.heard());
  CHECK(receiver.statistics().forged == 2);

  const Bytes first = sealed(10, 1, 1, key), second = sealed(10, 2, 2, key), fourth = sealed(10, 4, 4, key);
  sender.send(first);
  CHECK(heard() == one(1));
  CHECK(receiver.session() == 10);
  // Every bit counts, and so does the length.
  std::uint64_t forged = receiver.statistics().forged, nonsense = receiver.statistics().nonsense;
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
  forged = receiver.statistics().forged - forged, nonsense = receiver.statistics().nonsense - nonsense;
  CHECK(forged + nonsense == 9 * second.size());
  CHECK(receiver.statistics().lost == 0);

  sender.send(second);
  enemy.send(second);  // replayed at once
  CHECK(heard() == one(2));
  sender.send(fourth);
  sender.send(sealed(10, 3, 3, key));  // reordered by the network
  CHECK(heard() == one(4));
  CHECK(receiver.statistics().late == 2);
  CHECK(receiver.statistics().lost == 1);

  // Silence opens no door: neither to a replay nor to a stranger.
  enemy.send(first), enemy.send(second), enemy.send(fourth), enemy.send(plain(9, 66));
  CHECK(heard(50s) == none);
  CHECK(receiver.silent_for(50s) == 45s);
  // The sender may have another port, and goes on; started anew it has a greater session, and takes over.
  Sender moved(receiver), again(receiver);
  moved.send(sealed(10, 5, 5, key));
  CHECK(heard(50s) == one(5));
  again.send(sealed(11, 1, 6, key));
  CHECK(heard(50s) == one(6));
  enemy.send(sealed(10, 6, 66, key));  // a recording of the old session
  CHECK(heard(50s) == none);
  CHECK(receiver.statistics().replayed == 1);
  CHECK(receiver.session() == 11);

  // A receiver that remembers its last session does not take it again.
  skin::Receiver next({.key = key, .after_session = receiver.session(), .clock = at_once});
  Sender to_next(next);
  to_next.send(sealed(11, 1, 6, key));
  CHECK(next.poll(60s).empty());
  CHECK(next.statistics().replayed == 1);
  to_next.send(sealed(12, 1, 7, key));
  CHECK(ids(next.poll(60s)) == one(7));
  // One without a key does not take what it cannot check.
  skin::Receiver open({.clock = at_once});
  Sender(open).send(sealed(12, 1, 7, key));
  CHECK(open.poll(60s).empty());
  CHECK(open.statistics().nonsense == 1);
}

TEST_CASE("skin receiver with a key: sequence numbers of a session do not begin anew") {
  const skin::Key key = key_of(1);
  skin::Receiver receiver({.key = key, .clock = at_once});
  Sender sender(receiver);
  sender.send(sealed(1, 4294967295u, 1, key));
  CHECK(receiver.poll(5s).size() == 1);
  sender.send(sealed(1, 0, 2, key));
  CHECK(receiver.poll(5s).empty());
  sender.send(sealed(2, 0, 2, key));
  CHECK(receiver.poll(5s).size() == 1);
}

TEST_CASE(
    "skin receiver with a key: whatever an enemy does with what he hears, samples are genuine, once, in "
    "order") {
  const skin::Key key = key_of(3);
  oracle::Random random(11);
  skin::Receiver receiver({.key = key, .clock = at_once});
  Sender sender(receiver), enemy(receiver);
  std::vector<Bytes> overheard;
  std::uint32_t id = 1, last = 0;
  std::uint64_t session = 1;
  std::uint32_t sequence = 0;
  std::size_t genuine = 0, heard = 0;
  for (int k = 0; k < 20000; ++k) {
    if (random.index(1000) == 0) ++session, sequence = 0;
    const auto what = random.index(6);
    if (what == 0 || overheard.empty()) {
      overheard.push_back(sealed(session, ++sequence, id++, key));
      sender.send(overheard.back());
      ++genuine;
    } else {
      Bytes bytes = overheard[static_cast<std::size_t>(random.index(static_cast<int>(overheard.size())))];
      if (what == 1) {  // mutated
        for (int m = 1 + random.index(4); m > 0; --m)
          bytes[static_cast<std::size_t>(random.index(static_cast<int>(bytes.size())))] =
              static_cast<std::uint8_t>(random.bits());
      } else if (what == 2) {  // of two datagrams
        const Bytes& other =
            overheard[static_cast<std::size_t>(random.index(static_cast<int>(overheard.size())))];
        const auto at = random.index(static_cast<int>(bytes.size()));
        std::copy(other.begin() + at, other.end(), bytes.begin() + at);
      } else if (what == 3) {
        bytes.resize(static_cast<std::size_t>(random.index(1473)));
      }  // else as it was
      enemy.send(bytes);
    }
    if (random.index(8) == 0) {
      for (const auto& sample : receiver.poll(5s)) {
        REQUIRE(sample.cell > last);  // ids rise with every genuine datagram
        REQUIRE(sample.cell < id);
        last = sample.cell;
        ++heard;
      }
    }
  }
  heard += receiver.poll(5s).size();
  CHECK(heard == genuine);
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
  CHECK(skin::Key::read(path).tag(text) == key_of(0).tag(text));
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
  CHECK_THROWS_WITH_AS(skin::Key(bytes), doctest::Contains("libsodium-dev"), skinctl::ConfigurationError);
}
#endif
