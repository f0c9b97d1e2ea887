// The main of every test program: doctest's, and a failure when something allocated inside a real-time scope.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cinttypes>
#include <cstdio>

#include "skinctl/testing/allocation_guard.hpp"

int main(int argc, char** argv) {
  const int failed = doctest::Context(argc, argv).run();
  const auto allocations = skinctl::testing::unexpected_real_time_allocations();
  if (allocations == 0) return failed;
  std::fprintf(stderr, "skinctl: %" PRIu64 " calls to the allocator inside real-time scopes\n", allocations);
  return 1;
}
