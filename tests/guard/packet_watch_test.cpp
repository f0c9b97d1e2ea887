#include "skinctl/guard/packet_watch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <deque>
#include <random>

using namespace skinctl;

static_assert(std::is_trivially_copyable_v<PacketMemory>);

TEST_CASE("PacketWatch: refuses what cannot work") {
  CHECK_THROWS_AS(PacketWatch(64), ConfigurationError);
}

TEST_CASE("PacketWatch: says so while more than the allowed number of the last 64 is missing") {
  // The oracle keeps the last 64 packets, one by one.
  std::mt19937 rng(1);
  for (const unsigned most : {0u, 4u, 63u}) {
    const PacketWatch watch(most);
    PacketMemory m;
    std::deque<bool> missing(64, false);
    std::uint32_t number = 0xffffff00u;  // wraps on the way
    std::uint64_t lost = 0;
    static_cast<void>(watch.step(m, number));
    int seen = 0;
    for (int k = 0; k < 20000; ++k) {
      const auto gap = static_cast<std::uint32_t>(rng() % 10 == 0 ? rng() % (rng() % 50 == 0 ? 200 : 4) : 0);
      for (std::uint32_t g = 0; g < gap; ++g) missing.push_back(true), missing.pop_front();
      missing.push_back(false), missing.pop_front();
      number += gap + 1;
      lost += gap;
      const auto count = static_cast<unsigned>(std::count(missing.begin(), missing.end(), true));
      const bool says = watch.step(m, number).has(Reason::packets_lost);
      REQUIRE(says == (count > most));
      seen += says;
    }
    CHECK(m.lost == lost);
    CHECK((most == 63 || seen > 0));
  }
}

TEST_CASE("PacketWatch: copies and latecomers change nothing") {
  const PacketWatch watch(0);
  PacketMemory m;
  for (const std::uint32_t number : {10u, 11u, 11u, 9u, 12u, 0x80000000u + 13u})
    CHECK_FALSE(watch.step(m, number).any());
  CHECK(m.lost == 0);
  CHECK(m.last == 12);
  CHECK(watch.step(m, 14).has(Reason::packets_lost));
}
