#include "skinctl/testing/allocation_guard.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

#include "skinctl/core/real_time.hpp"

#if defined(__SANITIZE_ADDRESS__)
#define SKINCTL_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SKINCTL_COUNTS_ALLOCATIONS 0
#endif
#endif
#if !defined(SKINCTL_COUNTS_ALLOCATIONS)
#if defined(__GLIBC__)
#define SKINCTL_COUNTS_ALLOCATIONS 1
#else
#define SKINCTL_COUNTS_ALLOCATIONS 0
#endif
#endif

namespace skinctl::testing {
namespace {

constinit thread_local std::uint64_t of_thread = 0;
constinit std::atomic<std::uint64_t> in_marks{0};
constinit std::atomic<std::uint64_t> expected{0};

}  // namespace

bool allocations_are_counted() noexcept {
  return SKINCTL_COUNTS_ALLOCATIONS != 0;
}
std::uint64_t allocations_of_thread() noexcept {
  return of_thread;
}
std::uint64_t allocations_in_real_time() noexcept {
  return in_marks.load(std::memory_order_relaxed);
}
std::uint64_t unexpected_real_time_allocations() noexcept {
  return in_marks.load(std::memory_order_relaxed) - expected.load(std::memory_order_relaxed);
}
ExpectedRealTimeAllocations::~ExpectedRealTimeAllocations() {
  expected.fetch_add(count(), std::memory_order_relaxed);
}

#if SKINCTL_COUNTS_ALLOCATIONS
namespace {
void note_allocation() noexcept {
  ++of_thread;
  if (in_real_time()) in_marks.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace
#endif

}  // namespace skinctl::testing

#if SKINCTL_COUNTS_ALLOCATIONS
// The program's own malloc comes before the C library's for every library in the process; glibc keeps the
// real ones under these names.
extern "C" {
void* __libc_malloc(std::size_t) noexcept;
void* __libc_calloc(std::size_t, std::size_t) noexcept;
void* __libc_realloc(void*, std::size_t) noexcept;
void* __libc_memalign(std::size_t, std::size_t) noexcept;
void __libc_free(void*) noexcept;

#define SKINCTL_INTERPOSED [[gnu::visibility("default")]]

SKINCTL_INTERPOSED void* malloc(std::size_t size) noexcept {
  skinctl::testing::note_allocation();
  return __libc_malloc(size);
}
SKINCTL_INTERPOSED void* calloc(std::size_t count, std::size_t size) noexcept {
  skinctl::testing::note_allocation();
  return __libc_calloc(count, size);
}
SKINCTL_INTERPOSED void* realloc(void* old, std::size_t size) noexcept {
  skinctl::testing::note_allocation();
  return __libc_realloc(old, size);
}
SKINCTL_INTERPOSED void* memalign(std::size_t alignment, std::size_t size) noexcept {
  skinctl::testing::note_allocation();
  return __libc_memalign(alignment, size);
}
SKINCTL_INTERPOSED void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  skinctl::testing::note_allocation();
  return __libc_memalign(alignment, size);
}
SKINCTL_INTERPOSED int posix_memalign(void** result, std::size_t alignment, std::size_t size) noexcept {
  skinctl::testing::note_allocation();
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) return EINVAL;
  void* memory = __libc_memalign(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *result = memory;
  return 0;
}
// Giving memory back is a call to the allocator as well: it may lock.
SKINCTL_INTERPOSED void free(void* memory) noexcept {
  if (memory != nullptr) skinctl::testing::note_allocation();
  __libc_free(memory);
}
}
#endif
