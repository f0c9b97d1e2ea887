#include "skinctl/core/status.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>
#include <type_traits>

using namespace skinctl;

static_assert(std::is_trivially_copyable_v<Status> && sizeof(Status) == 8);
static_assert(!Status().any() && Status(Reason::stopping).any());
static_assert((Status(Reason::blocked) | Reason::opposed).has(Reason::blocked));
static_assert(!(Status(Reason::blocked) | Reason::opposed).has(Reason::singular));
static_assert((Status(Reason::blocked) | Reason::blocked) == Status(Reason::blocked));
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

TEST_CASE("Status: every reason has a text of its own, and an unknown one is no crash") {
  std::set<std::string> texts;
  for (unsigned r = 0; r < static_cast<unsigned>(Reason::count); ++r)
    texts.insert(describe(static_cast<Reason>(r)));
  CHECK(texts.size() == static_cast<unsigned>(Reason::count));
  CHECK(texts.count("unknown") == 0);
  CHECK(describe(static_cast<Reason>(255)) == std::string("unknown"));
}

TEST_CASE("Status: for_each goes through the set in the order of the reasons, once each") {
  std::string seen;
  (Status(Reason::opposed) | Reason::state_stale | Reason::opposed).for_each([&](Reason r) {
    seen += std::string(describe(r)) + ";";
  });
  CHECK(seen == std::string(describe(Reason::state_stale)) + ";" + describe(Reason::opposed) + ";");
}
