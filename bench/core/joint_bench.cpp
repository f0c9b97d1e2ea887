// What a joint quantity costs: nothing over a bare Eigen vector or a plain array.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "bench/support/bench.hpp"
#include "skinctl/core/eigen.hpp"

using namespace skinctl;

namespace {

constexpr std::size_t count = 1024;

/// `evaluate(i, j)` of two changing places in a pool of `count`.
template <class F>
void row(const std::string& name, F evaluate) {
  benchmark::RegisterBenchmark(name.c_str(), [evaluate](benchmark::State& state) {
    std::size_t i = 0;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      auto result = evaluate(i % count, (i + 7) % count);
      ++i;
      benchmark::DoNotOptimize(result);
    }
  });
}

/// The sum that every tracking law ends with: a feed-forward less a gain times an error.
template <std::size_t N>
void rows() {
  using Eigen_N = Eigen::Matrix<double, int(N), 1>;
  struct Plain {
    double x[N];
  };
  static std::vector<JointTorque<N>> typed(count);
  static std::vector<Eigen_N, Eigen::aligned_allocator<Eigen_N>> eigen(count);
  static std::vector<Plain> plain(count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < N; ++k)
      typed[i][k] = plain[i].x[k] = eigen[i](static_cast<Eigen::Index>(k)) =
          double((i * 31 + k * 17) % 101) - 50.0;

  const std::string scene = "core/feedback/" + std::to_string(N) + "-joints/";
  row(scene + "skinctl/double", [](std::size_t i, std::size_t j) { return typed[i] - 0.25 * typed[j]; });
  row(scene + "eigen/double",
      [](std::size_t i, std::size_t j) { return Eigen_N(eigen[i] - 0.25 * eigen[j]); });
  row(scene + "floor/double", [](std::size_t i, std::size_t j) {
    Plain c;
    for (std::size_t k = 0; k < N; ++k) c.x[k] = plain[i].x[k] - 0.25 * plain[j].x[k];
    return c;
  });

  static std::vector<JointPosition<N>> q(count);
  static std::vector<JointVelocity<N>> dq(count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < N; ++k) q[i][k] = dq[i][k] = typed[i][k];
  const std::string step = "core/integrate/" + std::to_string(N) + "-joints/";
  row(step + "skinctl/double", [](std::size_t i, std::size_t j) { return integrate(q[i], dq[j], 0.002); });
  row(step + "eigen/double",
      [](std::size_t i, std::size_t j) { return Eigen_N(eigen[i] + 0.002 * eigen[j]); });
  row(step + "floor/double", [](std::size_t i, std::size_t j) {
    Plain c;
    for (std::size_t k = 0; k < N; ++k) c.x[k] = plain[i].x[k] + 0.002 * plain[j].x[k];
    return c;
  });
}

const bool registered = (rows<6>(), rows<16>(), rows<22>(), true);

}  // namespace
