// SPDX-License-Identifier: BSD-3-Clause
// AllocationGuard: counts the allocations of the calling thread, in release builds too, because it replaces
// malloc.
#pragma once

#include <cstdint>

namespace skinctl::testing {

/// Whether allocations are counted: not under AddressSanitizer, which replaces malloc itself.
[[nodiscard]] bool allocations_are_counted() noexcept;

/// Allocations of the calling thread since it started: malloc and its callers (new, Eigen, std).
[[nodiscard]] std::uint64_t allocations_of_thread() noexcept;

/// Allocations of any thread inside a `RealTimeScope`. `main` fails the test program if some are covered by
/// no `ExpectedRealTimeAllocations`.
[[nodiscard]] std::uint64_t allocations_in_real_time() noexcept;

/// `AllocationGuard guard; step(); CHECK(guard.count() == 0);` Take the count before the check: a failing
/// check allocates.
class AllocationGuard {
 public:
  AllocationGuard() noexcept : start_(allocations_of_thread()) {}
  [[nodiscard]] std::uint64_t count() const noexcept { return allocations_of_thread() - start_; }

 private:
  std::uint64_t start_;
};

/// For the tests of the guard itself: allocations inside this object's life do not fail the program.
class ExpectedRealTimeAllocations {
 public:
  ExpectedRealTimeAllocations() noexcept : start_(allocations_in_real_time()) {}
  ~ExpectedRealTimeAllocations();
  ExpectedRealTimeAllocations(const ExpectedRealTimeAllocations&) = delete;
  ExpectedRealTimeAllocations& operator=(const ExpectedRealTimeAllocations&) = delete;
  [[nodiscard]] std::uint64_t count() const noexcept { return allocations_in_real_time() - start_; }

 private:
  std::uint64_t start_;
};

/// Allocations inside real-time scopes that no `ExpectedRealTimeAllocations` covers.
[[nodiscard]] std::uint64_t unexpected_real_time_allocations() noexcept;

}  // namespace skinctl::testing
