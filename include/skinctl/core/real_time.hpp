// SPDX-License-Identifier: BSD-3-Clause
// The real-time mark: scopes that belong to the control loop, so that tests can forbid system calls inside
// them.
#pragma once

#include "skinctl/core/config.hpp"

/// Marks of real-time code. Outside of the inline namespace: all instruction sets share one mark.
namespace skinctl::real_time {

#if defined(__unix__) || defined(__APPLE__) || defined(_WIN32)
#define SKINCTL_PER_THREAD thread_local
#else
// Bare metal: one thread, and thread-local storage would need a start-up of its own.
#define SKINCTL_PER_THREAD
#endif

/// Number of marks around the calling thread. Only the scopes below write it. Volatile, because compilers
/// know that `malloc` does not read it and would remove the mark around an allocation.
inline constinit SKINCTL_PER_THREAD volatile unsigned depth = 0;

#undef SKINCTL_PER_THREAD

}  // namespace skinctl::real_time

SKINCTL_BEGIN_NAMESPACE

/// Whether the calling thread is inside a real-time scope.
[[nodiscard]] SKINCTL_INLINE bool in_real_time() noexcept {
  return real_time::depth != 0;
}

/// Marks the enclosing block as real-time, for the calling thread:
///
///     const RealTimeScope loop;
///     command = cycle.step(memory, input, dt);
///
/// From here to the end of the block nothing may allocate, lock, throw or call the system. The mark itself
/// checks nothing and costs one increment and one decrement of a thread's counter. A check reads
/// `in_real_time()`: skinctl's tests interpose `malloc` and fail when it is called inside a mark; a program
/// may do the same in its allocator, its logger or its locks. Scopes nest; other threads are not affected.
class [[nodiscard]] RealTimeScope {
 public:
  SKINCTL_INLINE RealTimeScope() noexcept { real_time::depth = real_time::depth + 1; }
  SKINCTL_INLINE ~RealTimeScope() { real_time::depth = real_time::depth - 1; }
  RealTimeScope(const RealTimeScope&) = delete;
  RealTimeScope& operator=(const RealTimeScope&) = delete;
};

/// Suspends the calling thread's real-time scopes for the enclosing block, for slow operations done on
/// purpose: reporting an error before the robot stops, opening a file between two runs.
class [[nodiscard]] NonRealTimeScope {
 public:
  SKINCTL_INLINE NonRealTimeScope() noexcept : saved_(real_time::depth) { real_time::depth = 0; }
  SKINCTL_INLINE ~NonRealTimeScope() { real_time::depth = saved_; }
  NonRealTimeScope(const NonRealTimeScope&) = delete;
  NonRealTimeScope& operator=(const NonRealTimeScope&) = delete;

 private:
  unsigned saved_;
};

SKINCTL_END_NAMESPACE
