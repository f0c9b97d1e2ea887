#include "skinctl/core/real_time.hpp"

#include <doctest/doctest.h>

#include <thread>
#include <type_traits>

using namespace skinctl;

static_assert(!std::is_copy_constructible_v<RealTimeScope>);
static_assert(!std::is_copy_constructible_v<NonRealTimeScope>);

TEST_CASE("RealTimeScope: marks its block, nests, and ends with it") {
  CHECK_FALSE(in_real_time());
  {
    const RealTimeScope outer;
    CHECK(in_real_time());
    {
      const RealTimeScope inner;
      CHECK(in_real_time());
    }
    CHECK(in_real_time());
  }
  CHECK_FALSE(in_real_time());
}

TEST_CASE("RealTimeScope: ends when an exception leaves the block") {
  try {
    const RealTimeScope scope;
    const NonRealTimeScope reporting;  // throwing allocates
    throw 1;
  } catch (int) {
  }
  CHECK_FALSE(in_real_time());
}

TEST_CASE("RealTimeScope: marks its own thread only") {
  bool other = true;
  bool own = false;
  std::thread thread;
  {
    const RealTimeScope scope;
    own = in_real_time();
    const NonRealTimeScope starting;
    thread = std::thread([&other] { other = in_real_time(); });
    thread.join();
  }
  CHECK(own);
  CHECK_FALSE(other);
}

TEST_CASE("NonRealTimeScope: lifts every mark and puts all of them back") {
  const RealTimeScope one;
  const RealTimeScope two;
  bool inside = true;
  {
    const NonRealTimeScope lifted;
    inside = in_real_time();
  }
  const bool after = in_real_time();
  const NonRealTimeScope checking;
  CHECK_FALSE(inside);
  CHECK(after);
}
