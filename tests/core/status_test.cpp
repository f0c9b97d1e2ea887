#include "skinctl/core/status.hpp"

#include <doctest/doctest.h>

#include <type_traits>
#include <vector>

using namespace skinctl;

static_assert(std::is_trivially_copyable_v<Status> && sizeof(Status) == 8);
static_assert(!Status().any() && Status(Reason::stopping).any());
static_assert((Status(Reason::blocked) | Reason::opposed).has(Reason::blocked));
static_assert(!(Status(Reason::blocked) | Reason::opposed).has(Reason::singular));
static_assert((Status(Reason::blocked) | Reason::blocked) == Status(Reason::blocked));
static_assert((Status(Reason::blocked) | Reason::stopping).without(Reason::stopping) ==
              Status(Reason::blocked));
static_assert(Status(Reason::blocked).without(Reason::stopping) == Status(Reason::blocked));
static_assert(Status::from_bits((Status(Reason::blocked) | Reason::stopping).bits()) ==
              (Status(Reason::stopping) | Reason::blocked));

TEST_CASE("Status: reads every bit pattern as reasons that exist") {
  for (std::uint64_t bits : {std::uint64_t(0), std::uint64_t(1), ~std::uint64_t(0), std::uint64_t(1) << 63,
                             std::uint64_t(0x123456789abcdef0)}) {
    int count = 0;
    Status again;
    Status::from_bits(bits).for_each([&](Reason r) {
      CHECK(r < Reason::count);
      again |= r;
      ++count;
    });
    CHECK(again == Status::from_bits(bits));
    CHECK(count <= static_cast<int>(Reason::count));
  }
}

TEST_CASE("Status: for_each goes through the set in the order of the reasons, once each") {
  std::vector<Reason> seen;
  (Status(Reason::opposed) | Reason::state_stale | Reason::opposed).for_each([&](Reason r) {
    seen.push_back(r);
  });
  CHECK((seen == std::vector{Reason::state_stale, Reason::opposed}));
}
