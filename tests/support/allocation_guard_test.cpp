#include "skinctl/testing/allocation_guard.hpp"

#include <doctest/doctest.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "skinctl/core/real_time.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Compilers may remove an allocation that nobody sees.
void* volatile seen = nullptr;
void release(void* memory) {
  seen = memory;
  std::free(memory);
}

// What `allocate` returns is released; returns the calls that reached the allocator.
template <class Allocate>
std::uint64_t calls(Allocate allocate) {
  const AllocationGuard guard;
  release(allocate());
  return guard.count();
}

}  // namespace

TEST_CASE("AllocationGuard: counts every way to allocate, and the release" *
          doctest::skip(!allocations_are_counted())) {
  CHECK(calls([] { return std::malloc(32); }) == 2);
  CHECK(calls([] { return std::calloc(4, 8); }) == 2);
  CHECK(calls([] { return std::realloc(nullptr, 32); }) == 2);
  CHECK(calls([] { return std::aligned_alloc(64, 128); }) == 2);
  CHECK(calls([] {
          void* memory = nullptr;
          return posix_memalign(&memory, 64, 128) == 0 ? memory : nullptr;
        }) == 2);
  const AllocationGuard guard;
  {
    const auto one = std::make_unique<int>(1);
    seen = one.get();
    const std::vector<double> many(100, 1.0);
    seen = const_cast<double*>(many.data());
  }
  const auto count = guard.count();
  CHECK(count == 4);
}

TEST_CASE("AllocationGuard: aligned memory is aligned, a bad alignment is refused") {
  for (std::size_t alignment : {std::size_t(16), std::size_t(64), std::size_t(4096)}) {
    void* memory = nullptr;
    REQUIRE(posix_memalign(&memory, alignment, 100) == 0);
    CHECK(reinterpret_cast<std::uintptr_t>(memory) % alignment == 0);
    std::free(memory);
  }
  if (allocations_are_counted()) {  // a sanitizer stops the program here instead
    void* memory = nullptr;
    CHECK(posix_memalign(&memory, 24, 100) == EINVAL);
    CHECK(memory == nullptr);
  }
}

TEST_CASE("AllocationGuard: counts nothing where nothing allocates") {
  const AllocationGuard guard;
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += i;
  const auto count = guard.count();
  CHECK(count == 0);
  CHECK(sum == 499500);
}

TEST_CASE("AllocationGuard: another thread's allocations are not ours" *
          doctest::skip(!allocations_are_counted())) {
  std::uint64_t theirs = 0;
  std::uint64_t ours = 1;
  std::thread thread([&theirs] { theirs = calls([] { return std::malloc(32); }); });
  {
    const AllocationGuard guard;
    thread.join();
    ours = guard.count();
  }
  CHECK(theirs == 2);
  CHECK(ours <= 1);  // join may release the thread's own state
}

TEST_CASE("RealTimeScope: an allocation inside of it is caught" * doctest::skip(!allocations_are_counted())) {
  const auto before = unexpected_real_time_allocations();
  {
    const ExpectedRealTimeAllocations expected;
    {
      const RealTimeScope loop;
      release(std::malloc(32));
      const NonRealTimeScope allowed;
      release(std::malloc(32));
    }
    const auto caught = expected.count();
    CHECK(unexpected_real_time_allocations() == before + 2);
    CHECK(caught == 2);
  }
  CHECK(unexpected_real_time_allocations() == before);
}
