// Promise: a place has one holder, and nobody waits for ever
// Tried: 100 000 cycles of four robots and three places

#include "skinctl/semantics/resources.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Shared = Resources<3, 4>;
using Asked = std::array<PlaceRequest, 4>;
const Shared shared(10s);
}  // namespace

TEST_CASE("Resources: the one that has waited longest gets a place, when its holder has left and is away") {
  auto m = shared.start();
  Asked a{};
  const auto at = [&](Nanoseconds now) {
    const auto out = shared.step(m, now, a);
    m = out.memory;
    return out.grants;
  };
  a[2].wants = 1;
  CHECK(at(1s)[2].granted);
  a[3].wants = 1;
  CHECK_FALSE(at(2s)[3].granted);
  a[0].wants = 1;
  CHECK_FALSE(at(3s)[0].granted);
  a[2] = {.wants = 255, .leaves = 2, .away = 0};  // done, but still there
  CHECK(at(4s)[2].holds == 2);
  a[2].away = 2;
  const auto next = at(5s);
  CHECK(next[2].holds == 0);
  CHECK(next[3].granted);
  CHECK_FALSE(next[0].granted);
  CHECK(next[1].granted);  // wants nothing
  CHECK_FALSE(at(14s)[3].overdue);
  CHECK(at(15s)[3].overdue);
}

TEST_CASE("Resources: a robot that fails releases what it is away from, and keeps where it stands") {
  auto m = shared.start();
  Asked a{};
  a[0].wants = 0;
  m = shared.step(m, 1s, a).memory;
  a[0].wants = 2;
  m = shared.step(m, 2s, a).memory;
  CHECK(shared.step(m, 2s, a).grants[0].holds == 5);
  a[0] = {.wants = 2, .leaves = 0, .step_failed = true, .away = ~std::uint32_t(4)};
  const auto out = shared.step(m, 3s, a);
  CHECK(out.grants[0].holds == 4);
}

TEST_CASE("Resources: against the order nothing is granted") {
  auto m = shared.start();
  Asked a{};
  a[0].wants = 1;
  m = shared.step(m, 1s, a).memory;
  a[0].wants = 0;
  auto out = shared.step(m, 2s, a);
  CHECK((out.grants[0].refused && !out.grants[0].granted));
  a[0].wants = 77;
  CHECK(shared.step(m, 2s, a).grants[0].refused);
  CHECK_THROWS_AS(Shared(0ns), ConfigurationError);
}

TEST_CASE("Resources: 100 000 cycles of four robots: never two in a place, never all of them stuck") {
  auto random = seeded(10);
  auto m = shared.start();
  struct Job {
    int first = -1, second = -1, phase = 0, left = 0;
  };
  std::array<Job, 4> jobs;
  std::array<int, 4> done{};
  Nanoseconds now{};
  for (int i = 0; i < 100000; ++i) {
    now += 10ms;
    Asked a{};
    for (std::size_t r = 0; r < 4; ++r) {
      auto& j = jobs[r];
      if (j.phase == 0) {
        j.first = static_cast<int>(random() % 3);
        j.second = j.first < 2 && random() % 2 == 0 ? j.first + 1 : -1;
        j.phase = 1;
      }
      a[r].wants = j.phase == 1                    ? static_cast<std::uint8_t>(j.first)
                   : j.phase == 2 && j.second >= 0 ? static_cast<std::uint8_t>(j.second)
                                                   : std::uint8_t(255);
      a[r].away = 0;
      if (j.phase == 3 && --j.left <= 0) {
        a[r].leaves = a[r].away = ~std::uint32_t(0);
        j.phase = 0;
        ++done[r];
      }
    }
    const auto out = shared.step(m, now, a);
    m = out.memory;
    std::uint32_t held = 0;
    for (std::size_t r = 0; r < 4; ++r) {
      CHECK((held & out.grants[r].holds) == 0);
      held |= out.grants[r].holds;
      auto& j = jobs[r];
      if (j.phase == 1 && out.grants[r].granted && a[r].wants != 255)
        j.phase = 2;
      else if (j.phase == 2 && out.grants[r].granted) {
        j.phase = 3;
        j.left = static_cast<int>(random() % 20);
      }
    }
  }
  for (const int n : done) CHECK(n > 1000);
}
