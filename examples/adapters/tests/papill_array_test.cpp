// PapillArray: packets among damage, and a controller at a pseudo terminal.
//
// Promise: a PapillArray's packets are found again behind any damage
// Tried: 20 000 streams with bytes changed, lost and added, marks among the data: every packet that was not
// hit is read, and of those that were the sum lets few through; packets of random bytes with a right sum

#include "examples/adapters/skin/papill_array.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <thread>
#include <vector>

#include "examples/adapters/tests/simulated_pads.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/by_day.hpp"

using namespace adapters::skin;
using namespace std::chrono_literals;
using skinctl::testing::rounds, skinctl::testing::seeded;
using Bytes = std::vector<std::uint8_t>;

namespace {

std::size_t below(skinctl::testing::Random& random, std::size_t n) {
  return static_cast<std::size_t>(random() % n);
}
/// Two sensors of nine pillars; `marks`: numbers whose bytes are those of the marks.
PapillArrayPacket packet(skinctl::testing::Random& random, std::uint32_t number, bool marks = false) {
  PapillArrayPacket p;
  p.number = number, p.microseconds = 1'000'000 + 2000 * std::uint64_t(number), p.sensors = 2;
  const auto fill = [&](auto& numbers) {
    for (float& x : numbers) {
      x = static_cast<float>(below(random, 2000)) / 256 - 4;
      if (marks && below(random, 4) == 0)
        x = std::bit_cast<float>(below(random, 2) == 0 ? 0x88776655u : 0xddccbbaau);
    }
  };
  for (std::size_t s = 0; s < p.sensors; ++s) {
    p.sensor[s].pillars = 9;
    for (std::size_t k = 0; k < 9; ++k) fill(p.sensor[s].pillar[k]);
    p.sensor[s].has_whole = true;
    fill(p.sensor[s].whole);
  }
  return p;
}
bool equal(const PapillArrayPacket& a, const PapillArrayPacket& b) {
  return papill_array_bytes(a) == papill_array_bytes(b);
}

}  // namespace

TEST_CASE("PapillArray: a packet by hand is read number by number") {
  // One sensor of one pillar, offsets of one byte, no block 4, and a block 7 that nobody knows.
  Bytes bytes{1,    1,    0, 10, 3, 0, 22, 7, 0, 54, 7, 0, 0, 0, 0x40,
              0x42, 0x0f, 0, 0,  0, 0, 0,  1, 0, 3,  1, 0, 3, 2, 0};
  for (const float x : {0.5f, -0.25f, 2.0f, 0.125f, 0.0f, -1.0f})
    for (int b = 0; b < 4; ++b)
      bytes.push_back(static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(x) >> (8 * b)));
  REQUIRE(bytes.size() == 54);
  bytes.push_back(0xff);
  unsigned sum = 0;
  for (const auto b : bytes) sum += b;
  bytes.push_back(static_cast<std::uint8_t>(sum)), bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  PapillArrayPacket p;
  REQUIRE(parse_papill_array(bytes, p));
  CHECK(p.number == 7);
  CHECK(p.microseconds == 1'000'000);
  REQUIRE(p.sensors == 1);
  REQUIRE(p.sensor[0].pillars == 1);
  CHECK(p.sensor[0].pillar[0] == PapillArrayPacket::Pillar{0.5f, -0.25f, 2, 0.125f, 0, -1});
  CHECK_FALSE(p.sensor[0].has_whole);
  for (std::size_t n = 0; n < bytes.size(); ++n)
    CHECK_FALSE(parse_papill_array(std::span(bytes).first(n), p));
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    auto wrong = bytes;
    ++wrong[k];
    CHECK_FALSE(parse_papill_array(wrong, p));
  }
}

TEST_CASE("PapillArray: damaged streams: what was not hit is read, and little else is") {
  auto random = seeded(1);
  std::size_t written = 0, hit = 0, foreign = 0, kept = 0;
  std::vector<PapillArrayPacket> sent;
  std::vector<Bytes> wire;
  for (std::uint32_t k = 0; k < 200; ++k)
    sent.push_back(packet(random, k, k % 2 == 0)), wire.push_back(papill_array_bytes(sent.back()));
  PapillArrayParser parser;
  for (int k = 0; k < rounds(20'000); ++k) {
    Bytes stream;
    std::vector<const PapillArrayPacket*> whole;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t n = below(random, sent.size());
      Bytes bytes = wire[n];
      ++written;
      if (below(random, 3) == 0) {
        const std::size_t at = below(random, bytes.size()), kind = below(random, 4);
        if (kind == 0) bytes[at] ^= static_cast<std::uint8_t>(1u << below(random, 8));
        if (kind == 1)
          bytes.erase(bytes.begin() + std::ptrdiff_t(at),
                      bytes.begin() + std::ptrdiff_t(at + 1 + below(random, bytes.size() - at)));
        if (kind == 2) bytes.insert(bytes.begin() + std::ptrdiff_t(at), static_cast<std::uint8_t>(random()));
        if (kind == 3) bytes[at] = static_cast<std::uint8_t>(random());
      }
      if (bytes == wire[n]) {
        whole.push_back(&sent[n]);
      } else {
        ++hit;
      }
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
    const auto before = parser.counts();
    std::size_t found = 0;
    for (const std::uint8_t b : stream) {
      if (!parser.take(b)) continue;
      if (found < whole.size() && equal(parser.packet(), *whole[found])) {
        ++found;
      } else {
        ++foreign;
      }
    }
    CAPTURE(k);
    REQUIRE(found == whole.size());
    kept += found;
    REQUIRE(parser.counts().packets >= before.packets + found);
  }
  MESSAGE(written, " packets, ", hit, " of them hit: ", kept, " whole ones read, ", foreign, " others");
  CHECK(kept + hit == written);
  CHECK(foreign < std::max<std::size_t>(hit / 2000, 3));
}

TEST_CASE("PapillArray: blocks that contradict themselves are refused, whatever their sum") {
  auto random = seeded(2);
  PapillArrayPacket p;
  std::size_t read = 0;
  const Bytes good = papill_array_bytes(packet(random, 1));
  for (int k = 0; k < rounds(20'000); ++k) {
    Bytes bytes(good.begin() + 4, good.end() - 6);
    for (std::size_t hits = 1 + below(random, 6); hits > 0; --hits)
      bytes[below(random, k % 2 == 0 ? 40 : bytes.size())] = static_cast<std::uint8_t>(random());
    if (k % 5 == 0) bytes.resize(1 + below(random, bytes.size()));
    unsigned sum = 0;
    for (const auto b : bytes) sum += b;
    bytes.push_back(static_cast<std::uint8_t>(sum)), bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
    if (!parse_papill_array(bytes, p)) continue;
    ++read;
    REQUIRE(p.sensors <= 4);
    for (std::size_t s = 0; s < p.sensors; ++s) REQUIRE(p.sensor[s].pillars <= 100);
  }
  MESSAGE(read, " of ", rounds(20'000), " with a right sum made sense");
  CHECK(read < rounds(16'000u));
  CHECK(read > rounds(200u));
}

TEST_CASE("PapillArray: starts without end, ends without start, and nothing at all do not stall it") {
  PapillArrayParser parser;
  auto random = seeded(3);
  const auto good = papill_array_bytes(packet(random, 5));
  for (const Bytes& junk :
       {Bytes{0x55, 0x66, 0x77, 0x88}, Bytes{0xaa, 0xbb, 0xcc, 0xdd}, Bytes{0x55}, Bytes{0}}) {
    std::size_t n = 0;
    for (; n < rounds(1'000'000u); ++n) REQUIRE_FALSE(parser.take(junk[n % junk.size()]));
    bool found = false;
    for (const auto b : good) found = parser.take(b);
    CHECK(found);
  }
  CHECK(parser.counts().packets == 4);
  CHECK(parser.counts().dropped == 4 * rounds(1'000'000u));
}

TEST_CASE("PapillArray: a controller at a pseudo terminal is asked for its rate, and heard") {
  simulated_pads::Terminal terminal;
  CHECK_THROWS_WITH_AS(PapillArrayLine(terminal.name, 333), doctest::Contains("rate = 333"),
                       skinctl::ConfigurationError);
  PapillArrayLine line(terminal.name, 1000, true);
  std::array<char, 16> asked{};
  CHECK(::read(terminal.fd.get(), asked.data(), asked.size()) == 8);
  CHECK(std::string(asked.data()) == "f1000\nz\n");
  auto random = seeded(4);
  std::vector<PapillArrayPacket> sent;
  for (std::uint32_t k = 0; k < 50; ++k) sent.push_back(packet(random, k));
  const std::jthread controller([&] {
    for (const auto& p : sent) terminal.write(papill_array_bytes(p)), std::this_thread::sleep_for(1ms);
  });
  PapillArraySamples samples;
  for (std::size_t k = 0; k < sent.size(); ++k) {
    const PapillArrayPacket* p = line.next(std::chrono::steady_clock::now() + 5s);
    REQUIRE(p != nullptr);
    CHECK(equal(*p, sent[k]));
    const auto some = samples.of(*p, 5ms);
    REQUIRE(some.size() == 18);
    CHECK(some[17].cell == papill_array_cell(1, 8));
    CHECK(some[17].readings == sent[k].sensor[1].pillar[8]);
    CHECK(some[17].measured == 1);
    CHECK(skinctl::check(some[17]) == skinctl::Status{});
  }
  CHECK(line.next(std::chrono::steady_clock::now() + 5ms) == nullptr);
  CHECK_FALSE(line.closed());
  terminal.fd.close();
  CHECK(line.next(std::chrono::steady_clock::now() + 5s) == nullptr);
  CHECK(line.closed());
}

TEST_CASE("PapillArray, AnySkin: a line that is flooded with nonsense is left at the deadline") {
  simulated_pads::Terminal pillars, chips;
  PapillArrayLine line(pillars.name, 500);
  AnySkinLine pad(chips.name);
  std::atomic<bool> ended = false;
  const Bytes nonsense(4096, 'x');
  std::vector<std::jthread> floods;
  for (const auto* terminal : {&pillars, &chips}) {
    REQUIRE(::fcntl(terminal->fd.get(), F_SETFL, O_RDWR | O_NONBLOCK) == 0);
    floods.emplace_back([&, fd = terminal->fd.get()] {
      while (!ended) static_cast<void>(!::write(fd, nonsense.data(), nonsense.size()));
    });
  }
  for (int k = 0; k < 50; ++k) {  // for ever, if the deadline counted only where nothing has come
    CHECK(line.next(std::chrono::steady_clock::now() + 2ms) == nullptr);
    CHECK(pad.poll(std::chrono::steady_clock::now() + 2ms, [] { return 1s; }).empty());
  }
  ended = true;
  CHECK(line.counts().dropped > 4096);
  CHECK(pad.counts().dropped > 4096);
  CHECK_FALSE(line.closed());
  CHECK_FALSE(pad.closed());
}
