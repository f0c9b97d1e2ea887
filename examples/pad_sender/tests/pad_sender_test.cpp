// The sender for microcontrollers: what it writes is read as what it measured, here and on a Cortex-M.
//
// Promise: a home-made pad's datagrams say what it measured, whichever machine wrote them
// Tried: 200 periods of 64 cells with two pressures and a temperature, dead and saturated ones among them:
// every reading, count and unrest, on this machine and on an emulated Cortex-M3, byte for byte the same

#include "examples/pad_sender/pad_sender.h"

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "examples/adapters/skin/datagram.hpp"
#include "examples/adapters/skin/serial_datagrams.hpp"
#include "skinctl/sensing/unrest.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/by_day.hpp"

namespace {

using namespace adapters::skin;
using skinctl::Nanoseconds;
using skinctl::testing::rounds;

/// The pad of pad.c, as its receiver states it.
struct HomeMade {
  static constexpr std::string_view name = "home-made";
  static constexpr std::array readings{skinctl::Reading{"left"}, skinctl::Reading{"right"},
                                       skinctl::Reading{"temperature", -40, 120}};
  static constexpr std::array channels{
      skinctl::Channel{"left", skinctl::ChannelUse::contact, 0b001, 1, {0, 0, -1}, {-0.005, 0, 0}},
      skinctl::Channel{"right", skinctl::ChannelUse::contact, 0b010, 1, {0, 0, -1}, {0.005, 0, 0}},
      skinctl::Channel{"temperature", skinctl::ChannelUse::told, 0b100}};
};
constexpr std::size_t cells = 64;
constexpr float full = 4095;

std::string output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  std::string out;
  std::array<char, 65536> chunk{};
  while (const std::size_t n = std::fread(chunk.data(), 1, chunk.size(), pipe)) out.append(chunk.data(), n);
  CHECK(WEXITSTATUS(::pclose(pipe)) == 0);
  return out;
}
/// The bytes of a line `d ...` of what the pad prints.
std::vector<std::uint8_t> bytes_of(const std::string& line) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = 2; k + 1 < line.size() && line[k] > ' '; k += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(line.substr(k, 2), nullptr, 16)));
  return bytes;
}
float value(std::size_t channel, unsigned count) {
  const float x = std::min(static_cast<float>(count), full);
  return channel == 2 ? -40 + 160 * (x / full) : x / full;
}
void check_pad(const std::string& printed) {
  const skinctl::Unrest<HomeMade> unrest(1.0 / full);
  std::array<skinctl::Unrest<HomeMade>::Memory, cells> memory;
  std::array<skinctl::SensorSample<HomeMade>, cells> newest{};
  std::array<int, cells> silent{};
  std::istringstream lines(printed);
  std::uint32_t sequence = 0;
  std::size_t datagrams = 0, samples = 0, measurements = 0, heartbeats = 0;
  Nanoseconds last{};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(2));
    if (line[0] == 'm') {
      std::size_t cell = 0;
      words >> cell;
      REQUIRE(cell < cells);
      for (std::size_t c = 0; c < 3; ++c) {
        unsigned count = 0;
        words >> count;
        newest[cell].readings[c] = value(c, count);
      }
      unrest.measure(memory[cell], newest[cell]);
      ++silent[cell], ++measurements;
      continue;
    }
    REQUIRE(line[0] == 'd');
    const auto bytes = bytes_of(line);
    Datagram datagram;
    REQUIRE(parse(bytes, datagram));
    CHECK(datagram.is<HomeMade>());
    CHECK_FALSE(datagram.sealed);
    CHECK(datagram.sequence == sequence++);
    CHECK(datagram.sent >= last);
    last = datagram.sent;
    ++datagrams;
    heartbeats += datagram.count() == 0 ? 1u : 0u;
    for (std::size_t k = 0; k < datagram.count(); ++k, ++samples) {
      const auto s = datagram.sample<HomeMade>(k);
      REQUIRE(s.cell >= 500);
      REQUIRE(s.cell < 500 + cells);
      auto& expected = newest[s.cell - 500];
      unrest.tell(memory[s.cell - 500], expected);
      CHECK(s.time == datagram.sent - Nanoseconds(1000));
      CHECK(s.measured == expected.measured);
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(std::abs(s.readings[c] - expected.readings[c]) <=
              2e-7f * std::max(1.0f, std::abs(s.readings[c])));
      // The receiver's steps are floats, whose rounding shows in the last digit; 0 and `unsaid` are exact.
      CHECK(std::abs(int(s.unrest) - int(expected.unrest)) <= 1 + int(expected.unrest) / 2000);
      CHECK((s.unrest == 0) == (expected.unrest == 0));
      CHECK((s.unrest == skinctl::unsaid) == (expected.unrest == skinctl::unsaid));
      if (s.cell == 505) CHECK((s.unrest == 0 || s.unrest == skinctl::unsaid));
      CHECK(plausible(s, datagram, std::chrono::milliseconds(100)));
      silent[s.cell - 500] = 0;
    }
    CHECK(*std::max_element(silent.begin(), silent.end()) <= 25);
  }
  CHECK(measurements == 200 * cells);
  CHECK(datagrams > 200);  // the first period's cells do not fit into one
  MESSAGE(measurements, " measurements, ", datagrams, " datagrams with ", samples, " samples, ", heartbeats,
          " heartbeats");
  CHECK(samples > measurements / 10);
  CHECK(samples < measurements);
  CHECK(heartbeats > 10);
}

}  // namespace

TEST_CASE("pad_sender: the fingerprint is the receiver's") {
  const skin_reading readings[] = {{"left", 0, 1}, {"right", 0, 1}, {"temperature", -40, 120}};
  CHECK(skin_pad_fingerprint("home-made", readings, 3) == skinctl::KindTable<HomeMade>::fingerprint());
}

TEST_CASE("pad_sender: datagrams say what was measured, on this machine and on a Cortex-M3") {
  const std::string here = output_of(PAD_HERE);
  check_pad(here);
#ifdef PAD_ON_CORTEX_M
  std::string there =
      output_of(PAD_EMULATOR " -M mps2-an385 -nographic -semihosting -kernel " PAD_ON_CORTEX_M);
  std::erase(there, '\r');
  CHECK(there.size() == here.size());
  CHECK((there == here));
#else
  MESSAGE("SKIPPED on a Cortex-M: no compiler or emulator for it");
#endif
}

TEST_CASE("pad_sender: on a serial line its datagrams are found again behind damage") {
  std::vector<std::vector<std::uint8_t>> sent;
  std::istringstream lines(output_of(PAD_HERE));
  for (std::string line; std::getline(lines, line);)
    if (line[0] == 'd') sent.push_back(bytes_of(line));
  REQUIRE(sent.size() > 200);
  auto random = skinctl::testing::seeded(1);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::size_t hit = 0, kept = 0, others = 0;
  for (int run = 0; run < rounds(500); ++run) {
    SerialDatagrams found;
    std::vector<const std::vector<std::uint8_t>*> whole;
    std::vector<std::vector<std::uint8_t>> got;
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      auto wire = sent[i];
      if (run > 0 && i > 0 && below(8) == 0) {
        const std::size_t at = below(wire.size()), kind = below(3);
        if (kind == 0)
          wire.erase(wire.begin() + std::ptrdiff_t(at),
                     wire.begin() + std::ptrdiff_t(at + 1 + below(wire.size() - at)));
        if (kind == 1) wire.insert(wire.begin() + std::ptrdiff_t(at), static_cast<std::uint8_t>(random()));
        if (kind == 2)
          wire[below(std::min<std::size_t>(wire.size(), 8))] ^= static_cast<std::uint8_t>(1 + below(255));
      }
      wire == sent[i] ? whole.push_back(&sent[i]) : void(++hit);
      bytes += wire.size();
      for (std::size_t at = 0; at < wire.size();) {
        const std::size_t n = std::min(1 + below(100), wire.size() - at);
        found.take(std::span(wire).subspan(at, n),
                   [&](auto datagram) { got.emplace_back(datagram.begin(), datagram.end()); });
        at += n;
      }
    }
    std::size_t next = 0, taken = 0;
    for (const auto& g : got) {
      taken += g.size();
      const auto at =
          std::find_if(whole.begin() + std::ptrdiff_t(next), whole.end(), [&](auto* w) { return *w == g; });
      at == whole.end() ? void(++others) : void(next = static_cast<std::size_t>(at - whole.begin()) + 1);
      kept += at == whole.end() ? 0u : 1u;
    }
    REQUIRE(found.counts().dropped + taken <= bytes);
    REQUIRE(bytes - found.counts().dropped - taken < largest);
    REQUIRE(next <= whole.size());
    if (run == 0) REQUIRE(got == sent);
  }
  const std::size_t written = rounds(500u) * sent.size();
  MESSAGE(written, " datagrams, ", hit, " of them hit: ", kept, " whole ones found, ", others, " others");
  CHECK(kept + hit <= written);
  CHECK(kept > (written - hit) * 99 / 100);  // the last ones may be held back behind a damaged length
}
