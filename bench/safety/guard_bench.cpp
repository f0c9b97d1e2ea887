// The last word of a cycle, and the limiter that the virtual robot goes through in every sub-step.
#include "bench/support/rows.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/safety/guard.hpp"

using namespace skinctl;

namespace {

template <class T, Interface I>
void pass(benchmark::State& state) {
  const Guard<I, 6, T> guard({.limits = limits_of<ur5::Description, T>(), .period = 2_ms});
  JointCommand<6, T> wish;
  wish.valid = true;
  State<6, T> measured;
  auto memory = guard.start(wish, measured);
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    wish.time = measured.time = wish.time + 2_ms;
    const auto out = guard.pass(memory, wish, measured, wish.time);
    benchmark::DoNotOptimize(out);
  }
}

template <class T>
void move(benchmark::State& state) {
  const auto limits = limits_of<ur5::Description, T>();
  bench::States<6, T> states;
  JointVelocity<6, T> u;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const auto& s = states.next();
    const auto motion = limits.move(limits.room(s.q), u, s.dq, T(0.002));
    u = motion.velocity;
    benchmark::DoNotOptimize(motion);
  }
}

template <class T>
void rows() {
  const std::string end = std::string("/skinctl/") + bench::scalar_name<T>;
  benchmark::RegisterBenchmark(("safety/guard/ur5-position" + end).c_str(), pass<T, Interface::position>);
  benchmark::RegisterBenchmark(("safety/guard/ur5-velocity" + end).c_str(), pass<T, Interface::velocity>);
  benchmark::RegisterBenchmark(("safety/guard/ur5-torque" + end).c_str(), pass<T, Interface::torque>);
  benchmark::RegisterBenchmark(("safety/limits/ur5" + end).c_str(), move<T>);
}
const bool registered = [] {
  rows<double>();
  rows<float>();
  return true;
}();

}  // namespace
