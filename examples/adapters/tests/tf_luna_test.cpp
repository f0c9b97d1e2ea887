// TF-Luna: frames among damage, a sensor at a pseudo terminal.
//
// Promise: a TF-Luna's frames are found again behind any damage; blinded, it measures nothing
// Tried: frames packed by another program, cut anywhere; 20 000 streams with bytes lost, added and changed:
// every byte is accounted for, a wrong frame only where a sum of eight bits is right by chance; noise alone

#include "examples/adapters/skin/tf_luna.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "examples/adapters/socket.hpp"
#include "examples/adapters/tests/simulated_pads.hpp"
#include "tests/support/by_day.hpp"

using namespace adapters::skin;
using namespace std::chrono_literals;
using simulated_pads::Terminal;
using skinctl::Nanoseconds;
using skinctl::testing::rounds, skinctl::testing::seeded;
using Bytes = std::vector<std::uint8_t>;
using Frames = std::vector<TfLunaFrame>;

namespace {

/// 60 cm, strength 1234, 25.5 C, and one whose data are heads: both by Python's `struct` and `sum`.
const Bytes documented = {0x59, 0x59, 0x3c, 0x00, 0xd2, 0x04, 0xcc, 0x08, 0x98},
            heads = {0x59, 0x59, 0x59, 0x59, 0x59, 0x59, 0x59, 0x59, 0xc8};

/// The simulated sensor, byte by byte.
Bytes bytes_of(const TfLunaFrame& f) {
  Bytes out = {0x59, 0x59};
  unsigned sum = 0xb2;
  for (const unsigned number : {f.centimetres, f.strength, f.eighths})
    for (const unsigned byte : {number % 256, number / 256}) {
      out.push_back(static_cast<std::uint8_t>(byte));
      sum += byte;
    }
  out.push_back(static_cast<std::uint8_t>(sum % 256));
  return out;
}
void add(Bytes& stream, const Bytes& more) {
  stream.insert(stream.end(), more.begin(), more.end());
}
Frames read(skinctl::testing::Random& random, const Bytes& stream, TfLunaParser& parser) {
  Frames out;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t n = std::min<std::size_t>(1 + random() % 30, stream.size() - at);
    parser.take(std::span(stream).subspan(at, n), [&](const TfLunaFrame& f) { out.push_back(f); });
    at += n;
  }
  return out;
}
TfLunaFrame at_distance(unsigned centimetres, unsigned strength = 900) {
  return {static_cast<std::uint16_t>(centimetres), static_cast<std::uint16_t>(strength), (256 + 30) * 8};
}

}  // namespace

TEST_CASE("TF-Luna: what another program packed is read; near from 1 m to 0.2 m, weak is far") {
  auto random = seeded(1);
  TfLunaParser parser;
  Bytes stream = documented;
  add(stream, heads), add(stream, documented);
  const Frames got = read(random, stream, parser);
  REQUIRE(got.size() == 3);
  CHECK(parser.counts().dropped == 0);
  CHECK(got[0] == TfLunaFrame{60, 1234, 0x8cc});
  CHECK(got[1] == TfLunaFrame{0x5959, 0x5959, 0x5959});
  const auto x = got[0].readings();
  CHECK(x[0] == doctest::Approx(0.5));
  CHECK(x[1] == doctest::Approx(0.6));
  CHECK(x[2] == 1234);
  CHECK(x[3] == 25.5f);
  CHECK(at_distance(100).readings()[0] == 0);
  CHECK(at_distance(800).readings()[0] == 0);
  CHECK(at_distance(20).readings()[0] == 1);
  CHECK(at_distance(0).readings()[0] == 1);
  CHECK(at_distance(30, 99).readings()[0] == 0);  // too weak to be a distance
  CHECK(at_distance(30, 100).readings()[0] == doctest::Approx(0.875));
  CHECK_FALSE(at_distance(30, 65535).measured());
  // Whatever a frame says, its readings are within the ranges of the kind.
  for (unsigned n = 0; n < 65536; n += 13) {
    const auto all =
        TfLunaFrame{std::uint16_t(n), std::uint16_t(n < 65535 ? n : 0), std::uint16_t(n)}.readings();
    for (std::size_t r = 0; r < all.size(); ++r) {
      REQUIRE(double(all[r]) >= TfLuna::readings[r].min);
      REQUIRE(double(all[r]) <= TfLuna::readings[r].max + 1e-4);
    }
  }
}

TEST_CASE("TF-Luna: behind damage frames are found again, and every byte is accounted for") {
  auto random = seeded(2);
  std::size_t lost = 0, wrong = 0, frames = 0;
  for (int k = 0; k < rounds(20'000); ++k) {
    Bytes stream;
    Frames sent;
    for (int i = 0; i < 12; ++i) {
      sent.push_back(at_distance(unsigned(random() % 800), unsigned(100 + random() % 5000)));
      add(stream, bytes_of(sent.back()));
    }
    const std::size_t at = random() % (stream.size() / 2), n = 1 + random() % 12;  // within the first six
    const auto from = stream.begin() + std::ptrdiff_t(at);
    if (k % 3 == 0)
      stream.erase(from, from + std::ptrdiff_t(n));
    else if (k % 3 == 1)
      stream.insert(from, n, std::uint8_t(random()));
    else
      *from = static_cast<std::uint8_t>(*from ^ (1 + random() % 255));
    TfLunaParser parser;
    const Frames got = read(random, stream, parser);
    REQUIRE(parser.counts().frames == got.size());
    const std::size_t rest = stream.size() - 9 * got.size() - parser.counts().dropped;
    REQUIRE(rest < TfLunaParser::size);
    for (std::size_t i = 9; i < 12; ++i)  // two frames behind the damage
      lost += std::find(got.begin(), got.end(), sent[i]) == got.end();
    for (const auto& f : got) wrong += std::find(sent.begin(), sent.end(), f) == sent.end();
    frames += got.size();
  }
  MESSAGE(lost << " of " << rounds(60'000) << " frames lost behind the damage, " << wrong << " of " << frames
               << " wrong");
  CHECK(lost < rounds(60u));
  CHECK(wrong < rounds(400u));

  Bytes noise(1 << 16);
  for (auto& b : noise) b = static_cast<std::uint8_t>(random());
  TfLunaParser parser;
  CHECK(read(random, noise, parser).size() < 5);
}

TEST_CASE("TF-Luna: a sensor at a serial line, 100 times a second; blinded it is silent; unplugged it ends") {
  auto terminal = std::make_unique<Terminal>();
  TfLunaLine line(terminal->name, 7);
  Nanoseconds t = 5s;
  const auto now = [&] { return t; };
  const auto soon = [] { return std::chrono::steady_clock::now() + 500ms; };
  CHECK(line.poll(std::chrono::steady_clock::now() + 5ms, now).empty());
  Bytes three;
  for (const unsigned cm : {90u, 80u, 70u}) add(three, bytes_of(at_distance(cm)));
  terminal->write(three);
  std::vector<TfLunaLine::Sample> got;
  while (got.size() < 3) {
    const auto some = line.poll(soon(), now);
    REQUIRE(!some.empty());
    got.insert(got.end(), some.begin(), some.end());
  }
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(got[k].cell == 7);
    CHECK(got[k].measured == 1);
    CHECK(got[k].readings[1] == doctest::Approx(0.9 - 0.1 * double(k)));
    CHECK(got[k].time <= t);
    if (k > 0) CHECK(got[k].time >= got[k - 1].time);
  }
  t += 1s;
  terminal->write(bytes_of(at_distance(40, 65535)));
  CHECK(line.poll(std::chrono::steady_clock::now() + 50ms, now).empty());
  CHECK(line.blinded() == 1);
  CHECK_FALSE(line.closed());
  terminal.reset();
  CHECK(line.poll(soon(), now).empty());
  CHECK(line.closed());
  CHECK_THROWS_AS(TfLunaLine("/nowhere"), adapters::ConnectionError);
}
