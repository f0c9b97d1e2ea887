// What sensors beside the skin cost a cycle: a wrist sensor, the motors' residual, velocities from positions.
#include "bench/support/rows.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/sensing/velocity_estimator.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

using namespace skinctl;

namespace {

const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

/// Four samples of a wrist sensor that carries 1 kg, over an interval in four parts.
void wrist(benchmark::State& state) {
  const auto sensor = wrist_sensor<5>(ur5::Model{}, {.mass = 1, .centre = {0, 0, 0.1}});
  auto memory = sensor.start(0ns);
  LinkWrenches<ur5::Model, link_bit<5>> means[4];
  WrenchSample samples[4];
  Nanoseconds now = 0ns;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    for (std::size_t k = 0; k < 4; ++k)
      samples[k] = {now + 2ms * (long(k) + 1), {5.0 + double(k), 1, 2}, {1, 0, 0.5}};
    const State<6> measured{now + 8ms, home, {}};
    benchmark::DoNotOptimize(sensor.receive(memory, {}, {samples}, measured, now, now + 8ms, 4, means));
    benchmark::DoNotOptimize(means);
    now += 8ms;
  }
}
/// A state and the motors' torque, over an interval in four parts.
void motors(benchmark::State& state) {
  const ur5::Model model;
  const MotorTouch touch(model, {.gates = same_gate(model, EventGate<>(1.5, 1, 1))});
  auto memory = touch.start(0ns);
  JointTouch<ur5::Model> means[4];
  MotorInput<6> input{gravity_torque(model, home)};
  State<6> measured{0ns, home, {}};
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    const Nanoseconds from = measured.time;
    measured.time += 8ms;
    measured.dq[1] = -measured.dq[1] + 0.1;
    benchmark::DoNotOptimize(touch.receive(memory, {}, input, measured, from, measured.time, 4, means));
    benchmark::DoNotOptimize(means);
  }
}
/// The velocity of the Allegro's 16 joints from their last five positions.
template <std::size_t Degree>
void velocity(benchmark::State& state) {
  const VelocityEstimator<16, 5, Degree> estimator;
  typename VelocityEstimator<16, 5, Degree>::Memory memory;
  JointPosition<16> q;
  Nanoseconds now = 0ns;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    now += 3ms;
    q[3] = q[3] > 1 ? 0 : q[3] + 1e-3;
    benchmark::DoNotOptimize(estimator.observe(memory, q, now));
    benchmark::DoNotOptimize(memory.state);
  }
}

}  // namespace

BENCHMARK(wrist)->Name("tactile/sensor/wrist/skinctl/double");
BENCHMARK(motors)->Name("tactile/sensor/motors/skinctl/double");
BENCHMARK(velocity<1>)->Name("sensing/velocity/line/skinctl/double");
BENCHMARK(velocity<2>)->Name("sensing/velocity/parabola/skinctl/double");
