// One whole evaluation: skin to link wrenches, laws (spline joint + skin joint + gravity), one resolver
// sub-step, guard; beside the same work with KDL, and the hand-written floor of its dynamics.
#include <algorithm>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "bench/studies/floor/ur5_floor.hpp"
#include "bench/support/rows.hpp"
#include "bench/tactile/skin_floor.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/support/kdl_oracle.hpp"

using namespace skinctl;

namespace {

constexpr Nanoseconds period = 2ms;  // one sub-step

template <class T>
auto law() {
  JointControlSettings<6, T> s;
  s.lambda = T(25);
  s.K_c = T(5);
  s.tb = 4s;
  return SplineJoint<6, T>(s) + SkinJointControl{} + GravityControl{};
}
/// The same of a tool: Spline Operational + skin + gravity.
template <class T>
auto operational_law() {
  OperationalSettings<6, T> s;
  s.tracking.lambda = T(25);
  s.tracking.K_c = T(5);
  s.tracking.tb = 4s;
  const auto X_LT = Transform<Link<5>, Tool, T>::translation_xyz(T(0), T(0), T(0.15));
  return SplineOperational<6, 5, Tool, T>(OperationalSpace<6, 5, Tool, T>(X_LT, s), s) + SkinJointControl{} +
         GravityControl{};
}
template <class T>
auto resolver() {
  RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(15)), .period = period, .delay = 8ms};
  c.lag = 5ms;
  c.virtual_damping = T(6);
  return ResolverBy<Interface::position, ur5::Model, T>(ur5::Model{}, c);
}
template <std::size_t Cells, class T>
auto skin() {
  SkinSettings settings;
  settings.max_age = 10s;
  return ur5_skin<Cells, T>({}, settings);
}
/// As many samples a cycle as send-on-delta lets through: 13 % of 250 a second and cell.
constexpr std::size_t usual_samples(std::size_t cells) {
  return cells * 65 / 1000;
}
template <class T, class Scene>
void run(benchmark::State& state, const Scene& scene, std::size_t cells, std::size_t per_cycle) {
  auto memory = std::make_unique<typename Scene::Memory>();
  State<6, T> measured;
  measured.q = JointPosition<6, T>{T(0), T(-1.2), T(1.4), T(-1.8), T(-1.57), T(0.3)};
  bench::prepared([&] { scene.start(*memory, measured); });
  oracle::Random random(1);
  // All cells take their turn, in another order each time: none speaks twice in a cycle.
  std::vector<std::uint32_t> ids(cells);
  std::iota(ids.begin(), ids.end(), 1u);
  std::mt19937_64 order(1);
  std::vector<CellSample> samples(64 * per_cycle);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (n % cells == 0) std::shuffle(ids.begin(), ids.end(), order);
    samples[n].cell = ids[n % cells];
    samples[n].force = {static_cast<float>(random.uniform(0, 0.1)), 0, 0};
  }
  Nanoseconds now{};
  std::size_t k = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    now += period;
    const auto batch = std::span(samples).subspan(per_cycle * (k++ % 64), per_cycle);
    for (auto& s : batch) s.time = now;
    typename Scene::Input input;
    input.now = now;
    input.measured = {now, measured.q, measured.dq};
    input.samples = batch;
    const auto out = scene.step(*memory, input);
    measured.q = out.command.position;
    measured.dq = out.planned.velocity;
    benchmark::DoNotOptimize(measured);
  }
}

template <class T>
void skinctl_rows() {
  const std::string end = std::string("/skinctl/") + bench::scalar_name<T>;
  const auto with = [&]<std::size_t Cells>(std::integral_constant<std::size_t, Cells>) {
    for (const std::size_t samples : {usual_samples(Cells), std::size_t(0)})
      benchmark::RegisterBenchmark(
          ("cycle/evaluation/ur5-" + std::to_string(Cells) + (samples == 0 ? "-no-sample" : "") + end)
              .c_str(),
          [samples](benchmark::State& s) {
            run<T>(s, bench::prepared([] { return Cycle(resolver<T>(), skin<Cells, T>(), law<T>()); }), Cells,
                   samples);
          });
  };
  benchmark::RegisterBenchmark(("cycle/evaluation/ur5" + end).c_str(), [](benchmark::State& s) {
    run<T>(s, bench::prepared([] { return Cycle(resolver<T>(), law<T>()); }), 0, 0);
  });
  with(std::integral_constant<std::size_t, 260>{});
  with(std::integral_constant<std::size_t, 1260>{});
  benchmark::RegisterBenchmark(
      ("cycle/evaluation/ur5-1260-operational" + end).c_str(), [](benchmark::State& s) {
        run<T>(s, bench::prepared([] { return Cycle(resolver<T>(), skin<1260, T>(), operational_law<T>()); }),
               1260, usual_samples(1260));
      });
}

/// The same quantities with KDL: cell by cell or link by link, inverse dynamics, mass matrix.
template <std::size_t Cells>
void kdl_row(const char* scene, bool per_cell) {
  const auto robot = std::make_shared<oracle::KdlOracle>(oracle::ur5());
  const std::string name =
      std::string("cycle/evaluation/") + scene + (per_cell ? "/kdl_per_cell/double" : "/kdl_per_link/double");
  struct Place {
    int link;
    double p[3], u[6];
  };
  std::vector<Place> places;
  if constexpr (Cells > 0) {
    std::apply(
        [&](const auto&... patch) {
          const auto one = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& p) {
            for (const auto& c : p.placed()) {
              const auto u = unit_wrench(c.X_LC);
              const auto o = c.X_LC.origin();
              places.push_back({int(I),
                                {o.x, o.y, o.z},
                                {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z}});
            }
          };
          (one(patch), ...);
        },
        ur5::skin_patches<Cells>());
  }
  bench::row<6>(name, [robot, places, per_cell](const auto& s) {
    bench::Numbers<6> tau;
    bench::Numbers<36> M, J;
    robot->inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau.data);
    robot->mass_matrix(s.q.data, M.data);
    const auto add = [&](const double* w) {
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t j = 0; j < 6; ++j) tau.data[j] += J.data[6 * r + j] * w[r];
    };
    if (per_cell) {
      for (const Place& c : places) {
        robot->jacobian(c.link, c.p, s.q.data, J.data);
        add(c.u);
      }
    } else {
      double w[6][6] = {};
      for (const Place& c : places)
        for (std::size_t r = 0; r < 6; ++r) w[c.link][r] += 0.1 * c.u[r];
      const double origin[3] = {0, 0, 0};
      for (int link = 0; link < 6 && !places.empty(); ++link) {
        robot->jacobian(link, origin, s.q.data, J.data);
        add(w[link]);
      }
    }
    benchmark::DoNotOptimize(M);
    return tau;
  });
}

/// All cells weighed, their wrenches taken to the joints, and the two recursions of law and virtual robot: by
/// hand.
template <std::size_t Cells>
void floor_row() {
  constexpr std::size_t W = native_lanes<double>;
  struct Arrays {
    bench_floor::Line<double> units, newton;
    std::size_t pairs[6];
  };
  Arrays empty{bench_floor::Line<double>(0), bench_floor::Line<double>(0), {}};
  std::size_t total = 0;
  for (std::size_t l = 0; l < 6; ++l)
    total += empty.pairs[l] = Cells == 0 ? 0 : (ur5::skin_cells<Cells>[l] + 2 * W - 1) / (2 * W);
  const auto arrays = std::make_shared<Arrays>(
      Arrays{bench_floor::Line<double>(12 * W * total), bench_floor::Line<double>(2 * W * total), {}});
  std::copy_n(empty.pairs, 6, arrays->pairs);
  for (std::size_t i = 0; i < 12 * W * total; ++i) arrays->units.data()[i] = 0.01 * double(i % 89);
  for (std::size_t i = 0; i < 2 * W * total; ++i) arrays->newton.data()[i] = 0.001 * double(i % 7);
  const std::string scene = Cells == 0 ? "ur5" : "ur5-" + std::to_string(Cells);
  bench::row<6>("cycle/evaluation/" + scene + "/floor/double", [arrays](const auto& s) {
    bench::Numbers<Cells == 0 ? 12 : 18> out;
    bench_floor::ur5::floor_yr_theta(s.q.data, s.dq.data, s.dq_r.data, s.ddq.data, out.data);
    bench_floor::ur5::floor_forward_dynamics(s.q.data, s.dq.data, s.tau.data, out.data + 6);
    if constexpr (Cells > 0) {
      double sin[6], cos[6], w[6][6];
      math::sincos<6>(s.q.data, sin, cos);
      benchmark::DoNotOptimize(arrays.get());
      benchmark::ClobberMemory();
      const double *u = arrays->units.data(), *newton = arrays->newton.data();
      for (std::size_t l = 0; l < 6; ++l) {
        bench_floor::weigh(u, newton, arrays->pairs[l], w[l]);
        u += 12 * W * arrays->pairs[l], newton += 2 * W * arrays->pairs[l];
      }
      bench_floor::ur5_backward(sin, cos, w, out.data + 12);
    }
    return out;
  });
}

const bool registered = [] {
  skinctl_rows<double>();
  skinctl_rows<float>();
#if SKINCTL_HAS_KDL
  kdl_row<0>("ur5", false);
  kdl_row<260>("ur5-260", false);
  kdl_row<1260>("ur5-1260", false);
  kdl_row<260>("ur5-260", true);
  kdl_row<1260>("ur5-1260", true);
#endif
  floor_row<0>();
  floor_row<260>();
  floor_row<1260>();
  return true;
}();

}  // namespace
