#include "skinctl/hardware/scheduling.hpp"

#include <doctest/doctest.h>

#include <thread>

TEST_CASE("scheduling: whatever the system grants, the report says it") {
  const auto got = skinctl::request_real_time(1000);
  CHECK(got.report.find(got.real_time ? "granted" : "no real-time") != std::string::npos);
  CHECK(got.report.find(got.memory_locked ? "memory locked" : "memory not locked") != std::string::npos);
#if defined(__linux__)
  if (got.real_time) {
    int policy = -1;
    std::thread([&] { policy = sched_getscheduler(0); }).join();
    CHECK(policy == SCHED_OTHER);  // a writer of files does not displace the loop
  }
  if (got.memory_locked) munlockall();
  sched_param normal{};
  sched_setscheduler(0, SCHED_OTHER, &normal);
#endif
}
