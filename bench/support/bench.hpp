// What every benchmark of the loop reports besides its time.
#pragma once

#include <benchmark/benchmark.h>

#include "skinctl/testing/allocation_guard.hpp"

namespace skinctl::bench {

/// Counts the calls to the allocator of the measured loop and reports them as `allocs`, a call:
///
///     const CountAllocations counted(state);
///     for (auto _ : state) benchmark::DoNotOptimize(inverse_dynamics(...));
///
/// Whatever follows the loop in the same block counts as well; `state.SetItemsProcessed` alone makes two
/// calls.
class CountAllocations {
 public:
  explicit CountAllocations(benchmark::State& state) : state_(state) {}
  ~CountAllocations() {
    const auto count = guard_.count();
    state_.counters["allocs"] =
        benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
  }
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;

 private:
  benchmark::State& state_;
  testing::AllocationGuard guard_;
};

/// What `make()` returns, called where GCC does not see it: it takes a function that always calls a cold one
/// (a constructor, `start`) for cold as a whole, and would compile the measured loop beside that call for
/// size.
template <class F>
auto prepared(const F& make) {
  decltype(make()) (*volatile call)(const F&) = [](const F& f) { return f(); };
  return call(make);
}

}  // namespace skinctl::bench
