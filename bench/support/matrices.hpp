// Systems of equations from a pool, for the solvers' benchmarks.
#pragma once

#include <string>
#include <vector>

#include "bench/support/bench.hpp"
#include "tests/support/robot_table.hpp"

namespace skinctl::bench {

/// `square x = b`, elements within +-1, and `definite x = b` with `square square' + 1`.
template <std::size_t N, class T>
struct LinearSystem {
  T square[N * N], definite[N * N], b[N];
};

/// `solve(system, x)` on 64 systems in turn; the matrix is no constant and the solution is kept.
template <std::size_t N, class T, class F>
void matrix_row(const std::string& name, F solve) {
  benchmark::RegisterBenchmark(name.c_str(), [solve](benchmark::State& state) {
    oracle::Random random(1);
    std::vector<LinearSystem<N, T>> systems(64);
    for (auto& s : systems) {
      for (T& x : s.square) x = static_cast<T>(random.uniform(-1, 1));
      for (T& x : s.b) x = static_cast<T>(random.uniform(-1, 1));
      for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j < N; ++j) {
          T sum(i == j ? 1 : 0);
          for (std::size_t k = 0; k < N; ++k) sum += s.square[i * N + k] * s.square[j * N + k];
          s.definite[i * N + j] = sum;
        }
    }
    std::size_t k = 0;
    const CountAllocations counted(state);
    for (auto _ : state) {
      T x[N];
      solve(systems[k++ % 64], x);
      benchmark::DoNotOptimize(x);
    }
  });
}

}  // namespace skinctl::bench
