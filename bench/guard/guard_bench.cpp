// The last word of a cycle, the limiter that the virtual robot goes through in every sub-step, and the parts
// of a governor.
#include "bench/support/rows.hpp"
#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/governor.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

template <class T, Interface I>
void pass(benchmark::State& state) {
  const JointGuard<I, 6, T> guard({.limits = limits_of<ur5::Description, T>(), .period = 2ms});
  JointCommand<6, T> wish;
  wish.valid = true;
  State<6, T> measured;
  auto memory = guard.start(wish, measured);
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const Nanoseconds last = wish.time;
    wish.time = measured.time = last + 2ms;
    const Interval interval{.from = last, .to = wish.time, .substeps = 1, .seen = wish.time};
    const auto out = guard.step(memory, wish, measured, interval);
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
void move_smoothly(benchmark::State& state) {
  const JerkLimits<6, T> limits(limits_of<ur5::Description, T>(), JointJerk<6, T>::constant(T(800)));
  bench::States<6, T> states;
  JointVelocity<6, T> u;
  JointAcceleration<6, T> a;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const auto& s = states.next();
    const auto motion = limits.move(limits.joints().room(s.q), u, a, s.dq, T(0.002));
    u = motion.velocity;
    a = motion.acceleration;
    benchmark::DoNotOptimize(motion);
  }
}

template <class T>
void tool_speed(benchmark::State& state) {
  const auto joints = limits_of<ur5::Description, T>();
  const ToolSpeed<ur5::Model, 5, T> limit(ur5::Model{}, joints, {.speed = T(2), .reach = T(1.3)});
  bench::States<6, T> states;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const auto& s = states.next();
    benchmark::DoNotOptimize(limit.within(s.q, joints.room(s.q), T(0.1) * s.dq, T(0.1) * s.dq, T(0.002)));
  }
}

template <class T>
void contact(benchmark::State& state) {
  const LinkContact<2> touched{
      .region = {.force = 100, .blow = 200, .first = 500ms, .stiffness = 5e4, .mass = 4, .power = 80},
      .reach = 0.5,
      .reaction_time = 20ms};
  const auto limits = contact_limits<T>(ur5::Model{}, touched);
  bench::States<6, T> states;
  ContactMemory<1, T> memory;
  LinkWrenches<ur5::Model, link_bit<2>, T> touch;
  touch.template set<2>({{T(3), T(4), T(5)}, {T(0), T(1), T(0)}});
  State<6, T> measured;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const auto& s = states.next();
    measured.q = s.q;
    measured.dq = s.dq;
    benchmark::DoNotOptimize(limits.judge(memory, measured, s.dq, touch, {T(1)}, T(0.002)));
  }
}

template <class T>
void rows() {
  const std::string end = std::string("/skinctl/") + bench::scalar_name<T>;
  benchmark::RegisterBenchmark(("guard/guard/ur5-position" + end).c_str(), pass<T, Interface::position>);
  benchmark::RegisterBenchmark(("guard/guard/ur5-velocity" + end).c_str(), pass<T, Interface::velocity>);
  benchmark::RegisterBenchmark(("guard/guard/ur5-torque" + end).c_str(), pass<T, Interface::torque>);
  benchmark::RegisterBenchmark(("robot/joint_limits/ur5" + end).c_str(), move<T>);
  benchmark::RegisterBenchmark(("limits/jerk_limits/ur5" + end).c_str(), move_smoothly<T>);
  benchmark::RegisterBenchmark(("limits/tool_speed/ur5" + end).c_str(), tool_speed<T>);
  benchmark::RegisterBenchmark(("limits/contact_limits/ur5-one-link" + end).c_str(), contact<T>);
}
const bool registered = [] {
  rows<double>();
  rows<float>();
  return true;
}();

}  // namespace
