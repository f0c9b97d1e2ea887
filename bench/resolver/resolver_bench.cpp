// One cycle of the resolver around a law that costs nothing: measurement, observer, sub-steps, limits,
// command. Beside it what the equations of one sub-step cost alone, by hand and with KDL: M, C dq, G and a
// solution.
#include <algorithm>
#include <random>

#include "bench/studies/floor/ur5_task_floor.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/resolver/resolver.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"

using namespace skinctl;

namespace {

template <class T>
struct Constant {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  JointTorque<6, T> push;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<6, T> torque(const Memory&, const K&) const noexcept {
    return push;
  }
  template <class K>
  Memory advance(const Memory&, const K&, T, Opposition) const noexcept {
    return {};
  }
};

template <class T>
RobotConfiguration<6, T> configuration(Interface interface, Nanoseconds period) {
  RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(40)), .period = period, .delay = 8ms};
  c.lag = 10ms;
  c.viscous_friction = {T(30), T(30), T(20), T(3), T(2), T(1)};
  if (interface != Interface::torque) c.virtual_damping = T(1);
  return c;
}

// The robot does what is declared; the push changes its sign every second. With `Touch` a link is touched,
// for what `passivity` watches.
template <Interface I, class T, class Integrator, class Touch = NoTouch, class PassivityParts = Passivity<>>
void cycles(benchmark::State& state, Nanoseconds period, T coulomb = T(0),
            const PassivityParts& passivity = PassivityParts()) {
  const auto resolver = bench::prepared([&] {
    auto c = configuration<T>(I, period);
    if (I != Interface::torque) c.coulomb_friction = JointTorque<6, T>::constant(coulomb);
    if constexpr (I == Interface::torque) {
      return ResolverBy<I, ur5::Model, T, Integrator>(ur5::Model{}, c);
    } else {
      return ResolverBy<I, ur5::Model, T, Integrator, 32, PassivityParts>(ur5::Model{}, c, passivity);
    }
  });
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> angle(-2, 2);
  State<6, T> measured;
  for (auto& q : measured.q) q = T(angle(rng));
  auto memory = bench::prepared([&] { return resolver.start(measured); });
  const auto gravity = gravity_torque(ur5::Model{}, measured.q);
  Constant<T> law{gravity};
  typename Constant<T>::Memory law_memory;
  Touch touches[max_substeps] = {};
  if constexpr (!std::is_same_v<Touch, NoTouch>)
    for (Touch& touch : touches) touch.template set<4>({{T(1), T(2), T(-8)}, {T(0.1), T(0.2), T(0)}});
  Nanoseconds now{};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    now += period;
    measured.time = now;
    if constexpr (I != Interface::torque) measured.q = memory.group().under_way.reached;
    for (std::size_t i = 0; i < 6; ++i)
      law.push[i] = gravity[i] + ((now / 1'000'000'000) % 2 == 0ns ? T(1) : T(-1));
    const auto out = resolver.step(memory, law, law_memory, measured, resolver.interval(memory, now),
                                   std::span<const Touch>(touches));
    benchmark::DoNotOptimize(out);
  }
}

template <class T, class... Parts>
void touched(benchmark::State& state, const Parts&... parts) {
  using Touch = LinkWrenches<ur5::Model, link_bit<2> | link_bit<4>, T>;
  cycles<Interface::position, T, CrankNicolson, Touch>(state, 2ms, T(0), Passivity<Parts...>(parts...));
}

// The virtual robot shaped at its tool.
template <class T, std::size_t Rows>
void shaped(benchmark::State& state) {
  using Shape = ToolShape<5, Rows, T>;
  typename Shape::Settings s;
  for (std::size_t i = 0; i < Rows; ++i) {
    s.mass[i][i] = i < 3 ? T(6) : T(0.3);
    s.damping[i][i] = i < 3 ? T(40) : T(2);
  }
  const auto resolver = bench::prepared([&] {
    return ResolverBy<Interface::position, ur5::Model, T, CrankNicolson, 32, Passivity<>, Shape>(
        ur5::Model{}, configuration<T>(Interface::position, 2ms), Passivity<>(), Shape(s));
  });
  State<6, T> measured;
  measured.q = {T(0.1), T(-1.2), T(1.4), T(-1.0), T(1.2), T(0.3)};
  auto memory = bench::prepared([&] { return resolver.start(measured); });
  Constant<T> law{};
  typename Constant<T>::Memory law_memory;
  NoTouch touches[max_substeps];
  Nanoseconds now{};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    measured.time = now += 2ms;
    measured.q = memory.group().under_way.reached;
    law.push = gravity_torque(ur5::Model{}, memory.group().q.value);
    law.push[0] += (now / 1'000'000'000) % 2 == 0ns ? T(1) : T(-1);
    const auto out = resolver.step(memory, law, law_memory, measured, resolver.interval(memory, now),
                                   std::span<const NoTouch>(touches));
    benchmark::DoNotOptimize(out);
  }
}

template <class T>
void skinctl_rows() {
  const std::string end = std::string("/skinctl/") + bench::scalar_name<T>;
  const auto add = [&](const char* scene, auto run) {
    benchmark::RegisterBenchmark((std::string("resolver/step/") + scene + end).c_str(), run);
  };
  constexpr auto position = Interface::position;
  add("ur5", [](auto& s) { cycles<position, T, CrankNicolson>(s, 2ms); });
  add("ur5-semi-implicit-euler", [](auto& s) { cycles<position, T, SemiImplicitEuler>(s, 2ms); });
  add("ur5-dry-friction", [](auto& s) { cycles<position, T, CrankNicolson>(s, 2ms, T(0.5)); });
  add("ur5-four-substeps", [](auto& s) { cycles<position, T, CrankNicolson>(s, 8ms); });
  add("ur5-velocity", [](auto& s) { cycles<Interface::velocity, T, CrankNicolson>(s, 2ms); });
  static const EnergyTank<T> tank({.start = T(1000), .max = T(1000)}), empty({.start = T(0), .max = T(0)});
  static const PassivityObserver<T> passivity_observer({.start = T(1000), .max = T(1000)});
  add("ur5-energy-tank", [](auto& s) { touched<T>(s, tank); });
  add("ur5-energy-tank-empty", [](auto& s) { touched<T>(s, empty); });
  add("ur5-port-passivity_observer", [](auto& s) { touched<T>(s, passivity_observer); });
  add("ur5-all-keepers", [](auto& s) { touched<T>(s, tank, passivity_observer); });
  add("ur5-tool-translation", [](auto& s) { shaped<T, 3>(s); });
  add("ur5-tool", [](auto& s) { shaped<T, 6>(s); });
  add("ur5-torque", [](auto& s) { cycles<Interface::torque, T, CrankNicolson>(s, 2ms); });
}

const bool registered = [] {
  skinctl_rows<double>();
  skinctl_rows<float>();
  bench::row<6>("resolver/step/ur5/floor/double", [](const auto& s) {
    bench::Numbers<6> ddq;
    bench_floor::ur5::floor_forward_dynamics(s.q.data, s.dq.data, s.tau.data, ddq.data);
    return ddq;
  });
  // Each state from the last one, as a robot has them; from the pool again every 64 steps.
  benchmark::RegisterBenchmark("resolver/step/ur5/floor_in_turn/double", [](benchmark::State& state) {
    bench::States<6> states;
    bench::Motion<6> s;
    double q[6], dq[6];
    std::size_t k = 0;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      if (k++ % 64 == 0) s = states.next(), std::copy_n(s.q.data, 6, q), std::copy_n(s.dq.data, 6, dq);
      double ddq[6];
      bench_floor::ur5::floor_forward_dynamics(q, dq, s.tau.data, ddq);
      for (std::size_t i = 0; i < 6; ++i) {
        q[i] += 0.002 * (dq[i] + 0.001 * ddq[i]);
        dq[i] += 0.002 * ddq[i];
      }
      benchmark::DoNotOptimize(ddq);
    }
  });
  bench::row<6>("resolver/step/ur5-tool/floor/double", [](const auto& s) {
    constexpr double mass[6] = {6, 6, 6, 0.3, 0.3, 0.3}, damping[6] = {40, 40, 40, 2, 2, 2};
    bench::Numbers<6> dv;
    bench_floor::ur5::floor_tool_shape(s.q.data, s.dq.data, s.tau.data, mass, damping, 0.024, 0.002, dv.data);
    return dv;
  });
#if SKINCTL_HAS_KDL
  const auto robot = std::make_shared<oracle::KdlOracle>(oracle::ur5());
  bench::row<6>("resolver/step/ur5/kdl/double", [robot](const auto& s) {
    bench::Numbers<6> ddq;
    robot->forward_dynamics(s.q.data, s.dq.data, s.tau.data, ddq.data);
    return ddq;
  });
#endif
  return true;
}();

}  // namespace
