// One more term in a running total whose terms come one after the other, and totals of an array; beside
// Eigen's plain sum.
#include <Eigen/Core>

#include "bench/support/bench.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/math/exact_sum.hpp"

using namespace skinctl;

namespace {

constexpr std::size_t count = 1024;

template <class T>
std::vector<T> terms() {
  oracle::Random random(1);
  std::vector<T> x(count);
  for (T& v : x) v = static_cast<T>(random.uniform(-1, 1));
  return x;
}
template <class T, class F>
void row(const std::string& name, F total) {
  benchmark::RegisterBenchmark((name + "/" + bench::scalar_name<T>).c_str(),
                               [total](benchmark::State& state) {
                                 const auto x = terms<T>();
                                 const bench::CountAllocations counted(state);
                                 for (auto _ : state) {
                                   T result = total(x.data());
                                   benchmark::DoNotOptimize(result);
                                 }
                               });
}
template <class T, class Policy>
T one_by_one(const T* x) {
  math::Sum<T, Policy> sum;
  for (std::size_t i = 0; i < count; ++i) sum += x[i];
  return sum.value();
}
/// Four totals on lanes, as an array that is there at once is added up.
template <class T, class Policy>
T on_lanes(const T* x) {
  using L = Lane<T>;
  math::Sum<L, Policy> sums[4];
  for (std::size_t i = 0; i < count; i += 4 * L::lanes)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += L::load(x + i + k * L::lanes);
  math::Sum<T, Policy> total;
  for (const auto& sum : sums)
    for (std::size_t w = 0; w < L::lanes; ++w) total += sum.value()[w], total += sum.rest()[w];
  return total.value();
}

template <class T>
void rows() {
  row<T>("math/sum/1024/eigen",
         [](const T* x) { return Eigen::Map<const Eigen::Matrix<T, int(count), 1>>(x).sum(); });
  row<T>("math/sum/1024/compensated_lanes", on_lanes<T, math::Compensated>);
  row<T>("math/sum/1024/double_word_lanes", on_lanes<T, math::DoubleWord>);
  row<T>("math/sum/1024-one-by-one/plain", [](const T* x) {
    T sum(0);
    for (std::size_t i = 0; i < count; ++i) sum += x[i];
    return sum;
  });
  row<T>("math/sum/1024-one-by-one/compensated", one_by_one<T, math::Compensated>);
  row<T>("math/sum/1024-one-by-one/double_word", one_by_one<T, math::DoubleWord>);
  row<T>("math/sum/1024-one-by-one/exact", one_by_one<T, math::Exact>);
}

const bool registered = (rows<double>(), rows<float>(), true);

}  // namespace
