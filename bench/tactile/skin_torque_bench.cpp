// Readings of all cells to joint torques: wrench sums per link and one backward pass, beside KDL cell by cell
// and link by link, a hand-written floor, and the time that the bytes alone take.
#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/support/rows.hpp"
#include "bench/tactile/skin_floor.hpp"
#if SKINCTL_HAS_KDL
#include "bench/tactile/kdl_skin.hpp"
#endif
#include "skinctl/math/sincos.hpp"
#include "skinctl/tactile/dense_skin.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

using namespace skinctl;

namespace {

template <class Policy, class Tuple>
struct DenseOf;
template <class Policy, class... P>
struct DenseOf<Policy, std::tuple<P...>> {
  using type = DenseSkin<ur5::Model, Policy, P...>;
};
template <class Policy, std::size_t Cells>
using Dense = typename DenseOf<Policy, decltype(ur5::skin_patches<Cells>())>::type;

/// How hard cell `i` is pushed [N].
double newton_on(std::size_t i) {
  return 0.37 * double(i * 7919 % 101) / 100;
}
std::string scene_of(std::size_t cells) {
  return "tactile/torque/ur5-" + std::to_string(cells);
}
template <std::size_t Cells, class F>
void for_each_cell(F&& f) {
  std::apply(
      [&](const auto&... patch) {
        std::size_t n = 0;
        const auto one = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& p) {
          for (std::size_t i = 0; i < N; ++i)
            f(std::integral_constant<std::size_t, I>{}, i, n++, p.placed()[i]);
        };
        (one(patch), ...);
      },
      ur5::skin_patches<Cells>());
}

/// Largest error of a link's wrench, over the sum of the magnitudes that went into it.
template <std::size_t Cells, class W>
double error_of(const W& wrenches) {
  long double exact[6][6] = {}, size[6] = {};
  for_each_cell<Cells>([&](auto link, std::size_t, std::size_t n, const auto& cell) {
    const auto u = unit_wrench(cell.X_LC);
    const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
    for (std::size_t r = 0; r < 6; ++r)
      exact[link.value][r] += static_cast<long double>(row[r]) * newton_on(n);
    size[link.value] += newton_on(n);
  });
  long double worst = 0;
  for (std::size_t l = 0; l < 6; ++l)
    for (std::size_t r = 0; r < 6; ++r)
      worst =
          std::max(worst, std::abs(static_cast<long double>(wrenches.data[l][r]) - exact[l][r]) / size[l]);
  return static_cast<double>(worst);
}

template <std::size_t Cells, class Policy>
void skinctl_row(const std::string& implementation) {
  using D = Dense<Policy, Cells>;
  using T = typename D::scalar;
  const auto skin =
      std::make_shared<D>(std::apply([](const auto&... p) { return D(p...); }, ur5::skin_patches<Cells>()));
  const auto frame = std::make_shared<typename D::Frame>();
  for_each_cell<Cells>([&](auto link, std::size_t i, std::size_t n, const auto&) {
    frame->template at<link.value>(i) = static_cast<typename D::Stored>(newton_on(n));
  });
  const double error = error_of<Cells>(skin->wrenches(*frame));
  benchmark::RegisterBenchmark((scene_of(Cells) + implementation).c_str(), [=](benchmark::State& state) {
    bench::States<6, T> states;
    const ur5::Model model;
    state.counters["error"] = error;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      benchmark::DoNotOptimize(frame.get());
      benchmark::ClobberMemory();
      auto tau = skin_torque(model, states.next().q, skin->wrenches(*frame));
      benchmark::DoNotOptimize(tau);
    }
  });
}

template <std::size_t Cells, class T>
void floor_rows() {
  constexpr std::size_t W = native_lanes<T>;
  struct Arrays {
    bench_floor::Line<T> units, newton;
    std::size_t pairs[6];
  };
  std::size_t total = 0;
  Arrays sizes{bench_floor::Line<T>(0), bench_floor::Line<T>(0), {}};
  for (std::size_t l = 0; l < 6; ++l)
    total += sizes.pairs[l] = (ur5::skin_cells<Cells>[l] + 2 * W - 1) / (2 * W);
  const auto arrays = std::make_shared<Arrays>(
      Arrays{bench_floor::Line<T>(12 * W * total), bench_floor::Line<T>(2 * W * total), {}});
  std::copy_n(sizes.pairs, 6, arrays->pairs);
  for_each_cell<Cells>([&](auto link, std::size_t i, std::size_t n, const auto& cell) {
    std::size_t first = 0;
    for (std::size_t l = 0; l < link.value; ++l) first += 2 * arrays->pairs[l];
    const auto u = unit_wrench(cell.X_LC);
    const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
    for (std::size_t r = 0; r < 6; ++r)
      arrays->units.data()[((first + i / W) * 6 + r) * W + i % W] = static_cast<T>(row[r]);
    arrays->newton.data()[first * W + i] = static_cast<T>(newton_on(n));
  });
  const std::string end = std::string("/") + bench::scalar_name<T>;
  benchmark::RegisterBenchmark((scene_of(Cells) + "/floor" + end).c_str(), [=](benchmark::State& state) {
    bench::States<6, T> states;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      benchmark::DoNotOptimize(arrays.get());
      benchmark::ClobberMemory();
      T sin[6], cos[6], w[6][6], tau[6];
      math::sincos<6>(states.next().q.data, sin, cos);
      const T *u = arrays->units.data(), *s = arrays->newton.data();
      for (std::size_t l = 0; l < 6; ++l) {
        bench_floor::weigh(u, s, arrays->pairs[l], w[l]);
        u += 12 * W * arrays->pairs[l], s += 2 * W * arrays->pairs[l];
      }
      bench_floor::ur5_backward(sin, cos, w, tau);
      benchmark::DoNotOptimize(tau);
    }
  });
  const std::size_t bytes = 7 * Cells * sizeof(T);
  const auto numbers = std::make_shared<bench_floor::Line<T>>(7 * Cells);
  benchmark::RegisterBenchmark((scene_of(Cells) + "/memory" + end).c_str(), [=](benchmark::State& state) {
    state.counters["bytes"] = double(bytes);
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      benchmark::DoNotOptimize(numbers->data());
      benchmark::ClobberMemory();
      T sum = bench_floor::stream(numbers->data(), numbers->size());
      benchmark::DoNotOptimize(sum);
    }
  });
}

#if SKINCTL_HAS_KDL
template <std::size_t Cells>
void kdl_rows() {
  std::vector<bench::KdlCell> cells;
  const auto newton = std::make_shared<std::vector<double>>();
  for_each_cell<Cells>([&](auto link, std::size_t, std::size_t n, const auto& cell) {
    const auto u = unit_wrench(cell.X_LC);
    const auto p = cell.X_LC.origin();
    cells.push_back({int(link.value),
                     {p.x, p.y, p.z},
                     {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z}});
    newton->push_back(newton_on(n));
  });
  const auto kdl = std::make_shared<bench::KdlSkin>(oracle::ur5(), cells);
  bench::row<6>(scene_of(Cells) + "/kdl_per_cell/double", [=](const auto& s) {
    bench::Numbers<6> tau;
    kdl->per_cell(s.q.data, newton->data(), tau.data);
    return tau;
  });
  bench::row<6>(scene_of(Cells) + "/kdl_per_link/double", [=](const auto& s) {
    bench::Numbers<6> tau;
    kdl->per_link(s.q.data, newton->data(), tau.data);
    return tau;
  });
}
#endif

template <std::size_t Cells>
void rows() {
  skinctl_row<Cells, DoubleSum>("/skinctl/double");
  skinctl_row<Cells, FloatStoredSum>("/skinctl_float_stored/double");
  skinctl_row<Cells, FloatSum>("/skinctl/float");
  floor_rows<Cells, double>();
  floor_rows<Cells, float>();
#if SKINCTL_HAS_KDL
  kdl_rows<Cells>();
#endif
}

const bool registered = (rows<260>(), rows<600>(), rows<1260>(), rows<10000>(), true);

}  // namespace
