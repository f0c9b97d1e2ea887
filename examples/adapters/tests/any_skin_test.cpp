// AnySkin: packets among damage, a pad at a pseudo terminal, and forces from its fields.
//
// Promise: an AnySkin's packets are found again behind any damage, and no other frames are
// Tried: 20 000 streams with bytes lost or added at one place, cut anywhere: every whole packet behind a
// whole end is read, and none that the pad did not write; where half of the numbers hold line ends, of 10 000
// seams fewer than 200 are taken; 20 000 streams with bytes changed, lost and added everywhere: every byte is
// accounted for, every number likely

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <thread>
#include <vector>

#include "examples/adapters/skin/front_end.hpp"
#include "examples/adapters/tests/simulated_pads.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/told_skin.hpp"
#include "tests/support/by_day.hpp"

using namespace adapters::skin;
using namespace std::chrono_literals;
using simulated_pads::MagneticPad;
using simulated_pads::Terminal;
using skinctl::Nanoseconds;
using skinctl::testing::rounds, skinctl::testing::seeded;
using Bytes = std::vector<std::uint8_t>;
using Packets = std::vector<AnySkinPacket>;

namespace {

std::size_t below(skinctl::testing::Random& random, std::size_t n) {
  return static_cast<std::size_t>(random() % n);
}
/// A packet whose numbers hold "\r\n" wherever a likely number can.
AnySkinPacket with_line_ends(skinctl::testing::Random& random, MagneticPad& pad) {
  AnySkinPacket packet = pad.read({0, 0, 0});
  for (float& x : packet) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::size_t at = below(random, 4);  // bytes 0 and 1, 1 and 2, or none
    if (at < 2) x = std::bit_cast<float>((bits & ~(0xffffu << (8 * at))) | 0x0a0du << (8 * at));
  }
  return packet;
}
void add(Bytes& stream, const AnySkinPacket& packet) {
  const auto bytes = any_skin_bytes(packet);
  stream.insert(stream.end(), bytes.begin(), bytes.end());
}
/// The packets that are found in a stream that comes in pieces.
Packets read(skinctl::testing::Random& random, const Bytes& stream, AnySkinParser& parser) {
  Packets out;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t n = std::min(1 + below(random, 200), stream.size() - at);
    parser.take(std::span(stream).subspan(at, n), [&](const AnySkinPacket& p) { out.push_back(p); });
    at += n;
  }
  return out;
}

/// Whether `all` has the packets of `some`, in their order.
bool in_order(const Packets& some, const Packets& all) {
  std::size_t k = 0;
  for (const auto& p : all) k += k < some.size() && some[k] == p ? 1u : 0u;
  return k == some.size();
}

}  // namespace

TEST_CASE(
    "AnySkin: packets are read in pieces of any size, from any byte of a line on, with line ends as data") {
  auto random = seeded(1);
  MagneticPad pad(1);
  std::size_t ends = 0;
  for (std::size_t late = 0; late < AnySkinParser::size; ++late) {
    Bytes stream;
    Packets sent;
    for (int k = 0; k < 20; ++k) sent.push_back(with_line_ends(random, pad)), add(stream, sent.back());
    for (std::size_t k = 0; k + 1 < stream.size(); ++k)
      ends += stream[k] == '\r' && stream[k + 1] == '\n' ? 1u : 0u;
    stream.erase(stream.begin(), stream.begin() + std::ptrdiff_t(late));
    // From the middle of an end on, the first whole packet has no end before it.
    const std::size_t lost = late == 0 ? 0 : late == AnySkinParser::size - 1 ? 2 : 1;
    sent.erase(sent.begin(), sent.begin() + std::ptrdiff_t(lost));
    AnySkinParser parser;
    CHECK(read(random, stream, parser) == sent);
    CHECK(parser.counts().packets == sent.size());
    CHECK(parser.counts().dropped == lost * AnySkinParser::size - late);
    CHECK(parser.counts().breaks == (late > 0 ? 1u : 0u));
  }
  CHECK(ends > 82 * 20 * 5);  // several beside the packet's own
}

TEST_CASE("AnySkin: bytes lost or added at one place of a stream cost the packets they hit, and give none") {
  auto random = seeded(2);
  MagneticPad pad(2);
  constexpr std::size_t packets = 8, size = AnySkinParser::size;
  std::size_t seams = 0, also_lost = 0;
  for (int k = 0; k < rounds(20'000); ++k) {
    const bool line_ends = k % 2 == 0;
    Bytes stream;
    Packets sent;
    for (std::size_t i = 0; i < packets; ++i)
      sent.push_back(line_ends ? with_line_ends(random, pad) : pad.read({0, 0, 0})), add(stream, sent.back());
    // Packets that are lost as a whole leave no trace, and nobody can tell the seam of two halves.
    std::size_t n = 1 + below(random, 300);
    if (n % size == 0) ++n;
    const std::size_t at = below(random, stream.size() - n + 1), first = at / size;
    std::size_t last = 0, next = 0;  // hit: `first` to `last` - 1; `next` begins what is whole
    if (k % 3 == 0) {
      last = at % size == 0 ? first : first + 1;
      next = at;
      Bytes noise(n);
      for (auto& b : noise) b = static_cast<std::uint8_t>(random());
      stream.insert(stream.begin() + std::ptrdiff_t(at), noise.begin(), noise.end());
    } else {
      last = (at + n - 1) / size + 1;
      next = at + n;
      stream.erase(stream.begin() + std::ptrdiff_t(at), stream.begin() + std::ptrdiff_t(at + n));
    }
    const Packets written = sent;
    sent.erase(sent.begin() + std::ptrdiff_t(first), sent.begin() + std::ptrdiff_t(last));
    AnySkinParser parser;
    Packets got = read(random, stream, parser);
    CAPTURE(k);
    CAPTURE(at);
    CAPTURE(n);
    if (line_ends)  // half a packet before the end of another, behind "\r\n" that was data
      seams += std::erase_if(
          got, [&](const auto& p) { return std::find(written.begin(), written.end(), p) == written.end(); });
    REQUIRE(in_order(got, written));
    const bool end_hit = next % size == 0 || next % size == size - 1;  // that before the first whole packet
    if (end_hit && !in_order(sent, got)) {
      sent.erase(sent.begin() + std::ptrdiff_t(first));
      ++also_lost;
    }
    REQUIRE(in_order(sent, got));
  }
  MESSAGE("whole packets lost with the end before them: ", also_lost,
          "; seams taken among line ends: ", seams);
  CHECK(seams <
        rounds(200u));  // of 10 000 streams in which every second number holds a line end; of others none
}

TEST_CASE("AnySkin: streams full of damage: every byte is accounted for, every number is likely") {
  auto random = seeded(3);
  MagneticPad pad(3);
  std::size_t whole = 0, got = 0;
  for (int k = 0; k < rounds(20'000); ++k) {
    Bytes stream;
    for (int i = 0; i < 6; ++i) add(stream, with_line_ends(random, pad));
    for (std::size_t hits = below(random, 12); hits > 0; --hits) {
      const std::size_t at = below(random, stream.size());
      const std::size_t kind = below(random, 4);
      if (kind == 0) stream[at] ^= static_cast<std::uint8_t>(1u << below(random, 8));
      if (kind == 1) stream[at] = static_cast<std::uint8_t>(random());
      if (kind == 2) stream.erase(stream.begin() + std::ptrdiff_t(at));
      if (kind == 3) stream.insert(stream.begin() + std::ptrdiff_t(at), static_cast<std::uint8_t>(random()));
    }
    AnySkinParser parser;
    for (const AnySkinPacket& p : read(random, stream, parser))
      for (std::size_t i = 0; i < p.size(); ++i) {
        REQUIRE((p[i] == 0 || std::abs(p[i]) >= 0.01f));
        REQUIRE((i % 4 == 0 ? p[i] >= -50 && p[i] <= 150 : std::abs(p[i]) <= 2e5f));
      }
    const auto& c = parser.counts();
    const std::size_t left = stream.size() - c.packets * AnySkinParser::size - c.dropped;
    REQUIRE(left < AnySkinParser::size);
    REQUIRE(c.breaks <= c.dropped);
    whole += 6, got += c.packets;
  }
  MESSAGE("of ", whole, " packets with up to 11 wounds in six, ", got, " were taken");
  CHECK(got > whole / 10);
}

TEST_CASE("AnySkin: a pad at a pseudo terminal is heard packet by packet, and its end too") {
  Terminal terminal;
  AnySkinLine line(terminal.name, 7);
  MagneticPad pad(4);
  Packets sent;
  Bytes stream{1, '\r', '\n'};  // the line was opened within a packet
  for (int k = 0; k < 200; ++k) sent.push_back(pad.read({0, 0, 0})), add(stream, sent.back());
  const std::jthread device([&] {
    auto random = seeded(4);
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t n = std::min(1 + below(random, 300), stream.size() - at);
      terminal.write(std::span(stream).subspan(at, n));
      at += n;
      if (random() % 4 == 0) std::this_thread::sleep_for(1ms);
    }
  });
  std::vector<AnySkinLine::Sample> heard;
  while (heard.size() < sent.size()) {
    const auto samples = line.poll(std::chrono::steady_clock::now() + 5s, [] {
      return Nanoseconds(std::chrono::steady_clock::now().time_since_epoch());
    });
    REQUIRE_FALSE(samples.empty());
    heard.insert(heard.end(), samples.begin(), samples.end());
  }
  REQUIRE(heard.size() == sent.size());
  for (std::size_t k = 0; k < heard.size(); ++k) {
    CHECK(heard[k].readings == sent[k]);
    CHECK(heard[k].cell == 7);
    CHECK(heard[k].measured == 1);
    CHECK((k == 0 ? heard[k].unrest == skinctl::unsaid
                  : heard[k].unrest > 0 && heard[k].unrest < skinctl::unsaid));
    CHECK(skinctl::check(heard[k]) == skinctl::Status{});
    if (k > 0) CHECK(heard[k].time > heard[k - 1].time);
  }
  CHECK(line.counts().dropped == 3);
  CHECK(line.poll(std::chrono::steady_clock::now() + 5ms, [] { return 1ns; }).empty());
  CHECK_FALSE(line.closed());
  terminal.fd.close();
  CHECK(line.poll(std::chrono::steady_clock::now() + 5s, [] { return 1ns; }).empty());
  CHECK(line.closed());
  CHECK_THROWS_WITH_AS(AnySkinLine("/dev/null"), "serial line '/dev/null': it is none",
                       adapters::ConnectionError);
  CHECK_THROWS_WITH_AS(AnySkinLine("/nowhere"), doctest::Contains("No such file"), adapters::ConnectionError);
  CHECK_THROWS_WITH_AS(AnySkinLine(terminal.name, 0, 57600), doctest::Contains("no speed of 57600"),
                       adapters::ConnectionError);
}

TEST_CASE("AnySkin: a front end finds forces in the fields, and a new rest takes a drift off") {
  MagneticPad pad(5);
  FrontEnd<AnySkin> front;
  const auto sample = [&](const std::array<double, 3>& force, double warmth = 0) {
    return skinctl::SensorSample<AnySkin>{.time = 5ms, .cell = 0, .readings = pad.read(force, warmth)};
  };
  CHECK_THROWS_WITH_AS(static_cast<void>(front.at_rest({})), doctest::Contains("samples at rest"),
                       skinctl::ConfigurationError);
  for (int k = 0; k < 50; ++k) front.rest(sample({0, 0, 0}));
  CHECK_THROWS_WITH_AS(static_cast<void>(front.find()), doctest::Contains("samples under known forces"),
                       skinctl::ConfigurationError);
  skinctl::testing::Seeded random(5);
  for (int k = 0; k < 300; ++k) {
    const double f = random.between(0, 10);
    const std::array<double, 3> force{f, random.between(-0.5, 0.5) * f, random.between(-0.5, 0.5) * f};
    front.press(sample(force), force);
  }
  CHECK_THROWS_AS(static_cast<void>(front.find(2)), skinctl::ConfigurationError);
  const auto found = front.find();
  MESSAGE("300 presses of up to 10 N: errors ", found.error[0], ", ", found.error[1], ", ", found.error[2],
          " N");
  for (const double e : found.error) CHECK(e < 0.25);
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    const std::array<double, 3> force{random.between(0, 8), random.between(-3, 3), random.between(-3, 3)};
    const auto y = found.calibration.amounts(sample(force).readings.data());
    for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(double(y[c]) - force[c]));
  }
  MESSAGE("300 others: off by at most ", worst, " N");
  CHECK(worst < 0.6);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t chip = 0; chip < AnySkin::chips; ++chip) CHECK(found.calibration.A[c][4 * chip] == 0);

  // 15 K later what it read at rest is 1.5 % less.
  FrontEnd<AnySkin> later;
  for (int k = 0; k < 50; ++k) later.rest(sample({0, 0, 0}, 15));
  const auto again = later.at_rest(found.calibration);
  CHECK(again.A == found.calibration.A);
  const auto y = again.amounts(sample({4, 1, -1}, 15).readings.data());
  CHECK(double(y[0]) == doctest::Approx(4).epsilon(0.05));
  CHECK(double(y[1]) == doctest::Approx(1).epsilon(0.1));
  CHECK(double(y[2]) == doctest::Approx(-1).epsilon(0.1));

  // On the arm: the pad is a cell of its skin, and what it tells is not lost.
  using namespace skinctl;
  using OnePad = Skin<ur5::Model, double, Patch<2, 1, AnySkin>>;
  const auto X_LC = Transform<Link<2>, Cell>::translation_xyz(0.1, 0, 0.2);
  const ToldSkin skin(calibrated(OnePad(Patch<2, 1, AnySkin>({{0, X_LC}}), {}), {found.calibration}));
  auto memory = skin.start(0ns);
  KindInput<AnySkin> sensed;
  const State<6> state;
  const auto push = [&](const SensorSample<AnySkin>& s) {
    sensed.taxels = std::span(&s, 1);
    OnePad::Wrenches mean;
    CHECK(skin.receive(memory, std::span<const CellSample>(), sensed, state, 0ns, 10ms, 1, &mean) ==
          Status{});
    return skin.wrenches(memory);
  };
  const auto w = push(sample({6, 2, -1}));
  CHECK(w.data[0][2] == doctest::Approx(-6).epsilon(0.05));
  CHECK(w.data[0][0] == doctest::Approx(2).epsilon(0.1));
  CHECK(w.data[0][1] == doctest::Approx(-1).epsilon(0.1));
  CHECK(double(skin.told(memory, 0, 3)) == doctest::Approx(24));
  CHECK(double(skin.told(memory, 0, 7)) == doctest::Approx(24.4));
}
