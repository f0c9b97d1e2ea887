// Promise: what files and streams cost the loop is a copy: no allocation, no lock, no wait; what finds no
// room is counted
// Tried: records of random sizes, two threads with a reader that sleeps; 0 data races under
// ThreadSanitizer (by hand: this file with `-fsanitize=thread`, 459 470 assertions). Also:
// `recording/mcap_recorder_test.cpp`

#include "skinctl/recording/cycle_ring.hpp"

#include <doctest/doctest.h>

#include <deque>
#include <random>
#include <thread>

#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;

namespace {

/// A record that says which one it is, how long, and whether it is whole.
void fill(std::span<unsigned char> room, std::uint32_t number) {
  std::memcpy(room.data(), &number, sizeof number);
  for (std::size_t i = 4; i < room.size(); ++i) room[i] = static_cast<unsigned char>(number + i);
}
std::uint32_t checked(std::span<const unsigned char> bytes) {
  std::uint32_t number = 0;
  REQUIRE(bytes.size() >= 4);
  std::memcpy(&number, bytes.data(), sizeof number);
  bool same = true;
  for (std::size_t i = 4; i < bytes.size(); ++i)
    same = same && bytes[i] == static_cast<unsigned char>(number + i);
  REQUIRE(same);
  return number;
}

}  // namespace

TEST_CASE(
    "CycleRing: records of random sizes come out whole and in order; full, they are dropped and counted") {
  CycleRing ring(4096);
  std::mt19937 random(1);
  std::deque<std::pair<std::uint32_t, std::size_t>> inside;
  std::uint32_t number = 0;
  std::uint64_t dropped = 0;
  const testing::AllocationGuard guard;
  std::uint64_t allocated = 0;
  for (int k = 0; k < 50'000; ++k) {
    const std::size_t most = 4 + random() % (k % 100 == 0 ? 2040 : 300), used = 4 + random() % (most - 3);
    const auto before = guard.count();
    const auto room = ring.claim(most);
    if (!room.empty()) {
      REQUIRE(room.size() == most);
      REQUIRE(reinterpret_cast<std::uintptr_t>(room.data()) % 8 == 0);
      fill(room.first(used), number);
      ring.publish(used);
    }
    allocated += guard.count() - before;
    if (room.empty()) {
      ++dropped;
    } else {
      inside.emplace_back(number, used);
    }
    ++number;
    if (random() % 8 == 0) {
      const auto n = ring.consume([&](auto bytes) {
        REQUIRE(!inside.empty());
        CHECK(checked(bytes) == inside.front().first);
        CHECK(bytes.size() == inside.front().second);
        inside.pop_front();
      });
      CHECK(inside.empty());
      CHECK((n > 0 || ring.dropped() == dropped));
    }
    REQUIRE(ring.dropped() == dropped);
  }
  CHECK(dropped > 100);
  CHECK(allocated == 0);
}

TEST_CASE("CycleRing: a record above half of the ring never fits, one of half does") {
  CycleRing ring(4096);
  CHECK(ring.claim(2041).empty());
  CHECK(ring.dropped() == 1);
  for (int k = 0; k < 10; ++k) {
    const auto room = ring.claim(2040);
    REQUIRE(room.size() == 2040);
    ring.publish(2040);
    CHECK(ring.consume([](auto bytes) { CHECK(bytes.size() == 2040); }) == 1);
  }
  CHECK(ring.claim(std::numeric_limits<std::size_t>::max()).empty());
  for (const std::size_t bytes : {0u, 4095u, 5000u, 2048u})
    CHECK_THROWS_AS(CycleRing{bytes}, ConfigurationError);
}

// Clean under ThreadSanitizer: see tests/README.md for how it was run.
TEST_CASE("CycleRing: two threads, a reader that sleeps: every record is whole, in order, or counted") {
  CycleRing ring(1 << 16);
  const std::uint32_t records = testing::sanitized ? 20'000 : 300'000;
  std::uint64_t claimed = 0;
  std::thread producer([&] {
    std::mt19937 random(2);
    for (std::uint32_t k = 1; k <= records; ++k) {
      const auto room = ring.claim(4 + random() % 500);
      if (!room.empty()) {
        fill(room, k);
        ring.publish(room.size());
        ++claimed;
      }
      if (k % 64 == 0) std::this_thread::yield();
    }
  });
  std::uint64_t seen = 0, gaps = 0;
  std::uint32_t last = 0;
  const auto take = [&](std::span<const unsigned char> bytes) {
    const auto number = checked(bytes);
    REQUIRE(number > last);
    gaps += number - last - 1;
    last = number;
    ++seen;
  };
  while (last < records && seen + ring.dropped() < records) {
    ring.consume(take);
    if (seen % 1000 == 999) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  producer.join();
  ring.consume(take);
  CHECK(seen == claimed);
  CHECK(seen + ring.dropped() == records);
  CHECK(gaps + (records - last) == ring.dropped());
}
