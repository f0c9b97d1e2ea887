// Registers one row of the benchmark table: a function of a state, named
// area/job/scene/implementation/scalar.
#pragma once

#include <string>

#include "bench/support/bench.hpp"
#include "bench/support/states.hpp"

namespace skinctl::bench {

/// `evaluate(state)` returns or writes its result; whatever it returns is kept from being optimised away.
template <std::size_t N, class T = double, class F>
void row(const std::string& name, F evaluate) {
  benchmark::RegisterBenchmark(name.c_str(), [evaluate](benchmark::State& state) mutable {
    States<N, T> states;
    const CountAllocations counted(state);
    for (auto _ : state) {
      auto result = evaluate(states.next());
      benchmark::DoNotOptimize(result);
    }
  });
}

/// A result in a plain array, as the floors and the peers write it.
template <std::size_t K>
struct Numbers {
  double data[K];
};

template <class T>
inline const char* scalar_name = "double";
template <>
inline const char* scalar_name<float> = "float";

}  // namespace skinctl::bench
