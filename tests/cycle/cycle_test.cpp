// runs long: thousands of cycles
// Promise: the arm moves away from a contact, and returns when it ends
// Tried: every link with skin. Also: `tactile/`
//
// Promise: nothing is allocated, locked or thrown in the loop; no system call
// Tried: `Cycle::step` and everything below. Also: `malloc` interposed in every test and benchmark

#include "skinctl/cycle/cycle.hpp"

#include <doctest/doctest.h>

#include <complex>
#include <memory>
#include <vector>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

using Reaching = decltype(reaching_scene());
static_assert(std::is_trivially_copyable_v<Reaching::Memory>);
static_assert(Law<std::remove_cvref_t<decltype(std::declval<Reaching>().law())>, Reaching::Known>);

namespace {

/// Runs a scene against stiff joints; `touch(t)` is the reading of each force sensor of cell `id` at time t
/// [s].
template <class Scene, class Touch>
std::vector<JointPosition<6>> run(const Scene& scene, const SceneSettings& s, double duration,
                                  std::uint32_t id, Touch&& touch, bool let_skip = false) {
  auto memory = std::make_unique<typename Scene::Memory>();
  StiffJoints<> robot(home_position(), s.delay, s.lag);
  scene.start(*memory, robot.state());
  std::vector<JointPosition<6>> path;
  std::vector<CellSample> samples;
  Nanoseconds sampled{};
  int k = 0;
  for (Nanoseconds now = s.period; now <= nanoseconds(duration); now += s.period) {
    ++k;
    const State<6> measured = robot.run_to(now);
    if (let_skip && (k * 7919) % 10 == 0) continue;  // one cycle in ten is missing
    samples.clear();
    for (; sampled + 4ms <= now; sampled += 4ms) {
      const auto f = static_cast<float>(touch(seconds<double>(sampled + 4ms)));
      samples.push_back({.time = sampled + 4ms, .cell = id, .force = {f, f, f}});
    }
    typename Scene::Input input;
    input.now = now;
    input.measured = measured;
    input.samples = samples;
    const auto out = scene.step(*memory, input);
    REQUIRE(out.command.valid);
    robot.command(now, out.command.position);
    path.push_back(robot.state().q);
  }
  return path;
}

double half_sine(double t, double from, double length) {
  return t < from || t > from + length ? 0 : 0.3 * std::sin(3.141592653589793 * (t - from) / length);
}

}  // namespace

TEST_CASE("cycle: nobody touches it, nothing moves; it is a function of memory and input") {
  const auto scene = reaching_scene();
  State<6> state;
  state.q = home_position();
  auto memory = scene.start(state);
  for (int k = 1; k < 1000; ++k) {
    Reaching::Input input;
    input.now = k * 8ms;
    input.measured = state;
    input.measured.time = input.now;
    const auto [out, next] = scene(memory, input);
    auto in_place = memory;
    CHECK(scene.step(in_place, input).command.position == out.command.position);
    memory = next;
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out.command.position[i] - state.q[i]) < 1e-9);
  }
}

TEST_CASE("cycle: a touch moves the arm away from it, and after the release it returns to its goal") {
  const SceneSettings s;
  const auto scene = reaching_scene(s);
  // The middle of each link's patch.
  std::uint32_t first = 1;
  for (std::size_t link = 1; link < 4; ++link) {
    first += static_cast<std::uint32_t>(ur5::skin_cells<260>[link - 1]);
    const auto id = first + static_cast<std::uint32_t>(ur5::skin_cells<260>[link] / 2);
    const auto path = run(scene, s, 10, id, [](double t) { return half_sine(t, 0.5, 1); });
    const auto patches = ur5::skin_patches<260>();
    const auto displacement = [&](const auto& patch, auto I, const JointPosition<6>& q) {
      for (const auto& cell : patch.placed()) {
        if (cell.id != id) continue;
        const auto before = link_poses(ur5::Model{}, home_position()).template get<I.value>() * cell.X_LC;
        const auto after = link_poses(ur5::Model{}, q).template get<I.value>() * cell.X_LC;
        return dot(after.origin() - before.origin(), before.axis_z());
      }
      return 0.0;
    };
    const auto moved = [&](const JointPosition<6>& q) {
      if (link == 1) return displacement(std::get<1>(patches), std::integral_constant<std::size_t, 1>{}, q);
      if (link == 2) return displacement(std::get<2>(patches), std::integral_constant<std::size_t, 2>{}, q);
      return displacement(std::get<3>(patches), std::integral_constant<std::size_t, 3>{}, q);
    };
    double deepest = 0;
    for (const auto& q : path) deepest = std::min(deepest, moved(q));
    CAPTURE(link);
    CHECK(deepest < -0.001);  // against the outward normal
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(path.back()[i] - home[i]) < 2e-3);
  }
}

TEST_CASE("cycle: led by hand it yields with the configured admittance, behind delay and lag") {
  // At w << decay the arm is M ddq + B dq = tau: compare the motion of the real joints with that, at a
  // frequency of 0.05 / (2 pi T).
  for (const Nanoseconds period : {8ms, 2ms}) {
    SceneSettings s;
    s.period = period;
    s.delay = 8ms;
    s.lag = 10ms;
    s.force_gain = 20;
    const auto scene = kinesthetic_scene(s);
    const double T = seconds<double>(s.delay + s.period + s.lag);
    const double w = 0.05 / T, mean = 0.15, swing = 0.1;
    const double settle = 1, length = 3 * 2 * 3.141592653589793 / w;
    const std::uint32_t id = 60;
    const auto path = run(scene, s, settle + length, id, [&](double t) {
      return t < settle ? 0 : swing * std::sin(w * (t - settle)) + 0 * mean;
    });
    // Readings below zero are cut: the push is a train of half sines; integrate the same with M(q), B by fine
    // steps.
    const auto skin = ur5_skin<260>({.force = s.force_gain}, {.max_age = 10s});
    auto q = home_position();
    JointVelocity<6> dq;
    auto wrenches = skin.wrenches(skin.start(0ns));
    const auto patches = ur5::skin_patches<260>({.force = s.force_gain});
    const double h = 0.0005;
    std::vector<JointPosition<6>> expected;
    const ur5::Model model;
    double next = seconds<double>(s.period);
    for (double t = 0; expected.size() < path.size(); t += h) {
      const double f = 3 * std::max(0.0, t + h / 2 < settle ? 0 : swing * std::sin(w * (t + h / 2 - settle)));
      const double passed = f >= 0.08 ? f - 0.08 : 0;  // the dead band of the gate
      std::apply(
          [&](const auto&... patch) {
            const auto one = [&]<std::size_t I, std::size_t n>(const Patch<I, n>& p) {
              Wrench<Link<I>, Link<I>> sum;
              for (const auto& cell : p.placed())
                if (cell.id == id) sum = s.force_gain * passed * unit_wrench(cell.X_LC);
              wrenches.template set<I>(sum);
            };
            (one(patch), ...);
          },
          patches);
      const JointAngles<ur5::Model, double> angles(model, q);
      const auto tau = skin_torque(model, angles, wrenches) - coriolis_torque(model, angles, dq);
      auto ddq = MassFactors<ur5::Model>(mass_matrix(model, angles)).solve(tau);
      for (std::size_t i = 0; i < 6; ++i) ddq[i] = (ddq[i] - s.decay * dq[i]) / (1 + h * s.decay);
      dq = integrate(dq, ddq, h);
      q = integrate(q, dq, h);
      if (t + h >= next - 1e-9) {
        expected.push_back(q);
        next += seconds<double>(s.period);
      }
    }
    // Joint 1 bears most; both motions correlated with the push at w, over whole periods.
    const auto response = [&](const std::vector<JointPosition<6>>& p, std::size_t joint) {
      std::complex<double> sum = 0;
      for (std::size_t k = 1; k < p.size(); ++k) {
        const double t = seconds<double>(s.period) * static_cast<double>(k + 1);
        if (t < settle) continue;
        const double rate = (p[k][joint] - p[k - 1][joint]) / (seconds<double>(s.period));
        sum += rate * std::exp(std::complex<double>(0, -w * (t - settle)));
      }
      return sum;
    };
    for (std::size_t joint : {std::size_t(1), std::size_t(2)}) {
      const auto real = response(path, joint), wanted = response(expected, joint);
      CAPTURE(period);
      CAPTURE(joint);
      CAPTURE(std::abs(wanted));
      CHECK(std::abs(real / wanted - 1.0) <= 0.05 + w * T);  // the delay itself turns the phase by w T
      CHECK(std::abs(std::abs(real / wanted) - 1.0) <= 0.05);
    }
  }
}

TEST_CASE(
    "cycle: the same contact ends at the same place at 125 and 500 Hz; what cycles left out miss is lost") {
  const auto touch = [](double t) { return half_sine(t, 0.3, 0.8); };
  SceneSettings fast, slow;
  fast.force_gain = slow.force_gain = 15;  // no limit acts: those depend on T, and T on the period
  fast.lag = slow.lag = 4ms;
  fast.decay = slow.decay = 10;
  fast.period = 2ms;
  const auto at_500 = run(kinesthetic_scene(fast), fast, 3, 60, touch).back();
  const auto at_125 = run(kinesthetic_scene(slow), slow, 3, 60, touch).back();
  const auto skipped = run(kinesthetic_scene(slow), slow, 3, 60, touch, true).back();
  double deflection = 0, rate = 0, skips = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    deflection = std::max(deflection, std::abs(at_500[i] - home[i]));
    rate = std::max(rate, std::abs(at_500[i] - at_125[i]));
    skips = std::max(skips, std::abs(at_500[i] - skipped[i]));
  }
  CHECK(deflection > 0.02);
  CHECK(rate <= 0.005 * deflection);
  CHECK(skips <= 0.15 * deflection);  // what late cycles miss is not caught up
}

TEST_CASE("cycle: a blocked arm does not run away, and comes back smoothly") {
  SceneSettings s;
  const auto scene = kinesthetic_scene(s);
  auto memory = scene.start([] {
    State<6> at;
    at.q = home_position();
    return at;
  }());
  StiffJoints<> robot(home_position(), s.delay, s.lag);
  const double T = seconds<double>(s.delay + s.period);
  bool blocked = false;
  JointPosition<6> last = home_position();
  double lead = 0, step = 0;
  for (int k = 1; k <= 1500; ++k) {
    const Nanoseconds now = k * s.period;
    robot.block(k < 700);
    typename decltype(scene)::Input input;
    input.measured = robot.run_to(now);
    input.now = now;
    const CellSample push{.time = now - 1ms, .cell = 60, .force = {1, 1, 1}};
    const CellSample release{.time = now - 1ms, .cell = 60};
    input.samples = std::span(k < 400 ? &push : &release, 1);
    const auto out = scene.step(memory, input);
    robot.command(now, out.command.position);
    blocked = blocked || out.status.has(Reason::blocked);
    for (std::size_t i = 0; i < 6; ++i) {
      lead = std::max(lead, std::abs(out.command.position[i] - robot.state().q[i]));
      step = std::max(step, std::abs(out.command.position[i] - last[i]));
    }
    last = out.command.position;
  }
  CHECK(blocked);
  CHECK(lead <= 2 * ur5::Description::max_velocity * T + 1e-9);
  CHECK(step <= ur5::Description::max_velocity * 0.008 + 1e-9);
}

TEST_CASE_TEMPLATE(
    "cycle: 200 000 cycles with random touches and goals: no allocation, finite, within limits", T,
    SKINCTL_SCALARS) {
  constexpr int cycles = sanitized ? 25'000 : 100'000;  // of each type
  const SceneSettings s;
  const auto scene = reaching_scene<Interface::position, 260, T>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  auto memory = std::make_unique<typename Scene::Memory>();
  oracle::Random random(9);
  State<6, T> state;
  state.q = home_position<T>();
  scene.start(*memory, state);
  const auto limits = ur5_test_limits<T>();
  const AllocationGuard guard;
  JointVelocity<6, T> last_velocity{};
  int bad = 0, outside = 0, steps = 0;
  std::array<CellSample, 4> samples;
  for (int k = 1; k <= cycles; ++k) {
    typename Scene::Input input;
    input.now = k * s.period;
    input.measured = state;
    input.measured.time = input.now;
    for (auto& x : samples)
      x = {.time = input.now - 1us * random.index(8000),
           .cell = static_cast<std::uint32_t>(random.index(262)),
           .force = {static_cast<float>(random.uniform(0, random.index(3) == 0 ? 1 : 0.02)), 0, 0}};
    input.samples = std::span(samples).first(static_cast<std::size_t>(random.index(5)));
    if (random.index(2000) == 0) {
      auto& goal = input.goal.emplace();
      for (auto& x : goal.q_g) x = static_cast<T>(random.uniform(-2, 2));
      goal.duration = nanoseconds(random.uniform(0, 8));
    }
    const auto out = scene.step(*memory, input);
    bad += !out.command.valid;
    for (std::size_t i = 0; i < 6; ++i) {
      const T q = out.planned.position[i], v = out.planned.velocity[i];
      bad += !(q - q == 0) || !(v - v == 0);
      outside += q < limits.lower()[i] || q > limits.upper()[i];
      outside += std::abs(v) > limits.velocity()[i] * T(1.0001);
      steps += std::abs(v - last_velocity[i]) > limits.acceleration()[i] * T(0.008) * T(1.001);
      last_velocity[i] = v;
    }
    state.q = out.command.position;
    state.dq = out.planned.velocity;
  }
  const auto allocations = guard.count();
  MESSAGE(cycles << " cycles: " << allocations << " allocations, " << bad << " not finite, " << outside
                 << " outside the limits, " << steps << " steps");
  CHECK(allocations == 0);
  CHECK(bad == 0);
  CHECK(outside == 0);
  CHECK(steps == 0);
}

TEST_CASE("cycle: a start from a state that is not finite commands nothing") {
  const auto scene = reaching_scene();
  State<6> state;
  state.q = home_position();
  state.q[3] = std::numeric_limits<double>::quiet_NaN();
  auto memory = scene.start(state);
  Reaching::Input input;
  input.now = 8ms;
  input.measured.q = home_position();
  input.measured.time = 8ms;
  CHECK_FALSE(scene.step(memory, input).command.valid);
}

TEST_CASE("cycle: taken over where it was told to be, a robot that stands beside that does not step") {
  const auto scene = reaching_scene();
  State<6> state;
  state.q = home_position();
  for (double& q : state.q) q += 0.08;
  auto memory = scene.start(state, home_position());
  for (int k = 1; k < 200; ++k) {
    Reaching::Input input;
    input.now = k * 8ms;
    input.measured = state;
    input.measured.time = input.now;
    const auto out = scene.step(memory, input);
    REQUIRE(out.command.valid);
    CHECK_FALSE(out.status.has(Reason::displaced));
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out.command.position[i] - home[i]) < 1e-9);
  }
  state.q[2] = home[2] + 0.2;
  auto too_far = scene.start(state, home_position());
  Reaching::Input input;
  input.now = 8ms;
  input.measured = state;
  input.measured.time = 8ms;
  CHECK_FALSE(scene.step(too_far, input).command.valid);
}
