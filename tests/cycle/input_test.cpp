// Promise: the command never steps: acceleration, velocity and position limits hold
// Tried: any bits in any input field, skipped or late cycles; by velocity a robot that holds its last
// velocity through a pause longer than `longest_interval` leaves its limits, and needs a watchdog of its
// own; one that lags by 10, 20, 30 ms more than is declared keeps its position limits
// (`resolver/displaced_test.cpp`). Also: `limits/`, `guard/`, `resolver/`

#include "skinctl/cycle/input.hpp"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Any bit pattern, often a special one.
template <class T>
T any_number(oracle::Random& random) {
  using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  switch (random.index(8)) {
    case 0:
      return std::numeric_limits<T>::quiet_NaN();
    case 1:
      return std::numeric_limits<T>::infinity();
    case 2:
      return -std::numeric_limits<T>::max();
    case 3:
      return std::numeric_limits<T>::denorm_min();
    default:
      return std::bit_cast<T>(static_cast<Bits>(random.bits()));
  }
}

/// What stands in a field: something that may be there, any bits, or one of the numbers that break programs.
enum class Content : unsigned char { usual, bits, special };
void showValue(Content content, std::ostream& out) {
  out << (content == Content::usual ? "usual" : content == Content::bits ? "bits" : "special");
}
using Field = std::pair<Content, std::uint64_t>;
constexpr std::size_t samples_a_cycle = 3;
constexpr std::size_t fields_a_cycle = 14 + 1 + 10 * samples_a_cycle + 3 + 7;

/// The fields of one cycle in turn; each 0 and usual is a cycle in which nothing happens, so that cases
/// shrink to what matters.
class Tape {
 public:
  explicit Tape(const std::vector<Field>& fields) : fields_(fields) {}

  template <class T>
  T number(T usual) {
    using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    using Limits = std::numeric_limits<T>;
    const T special[] = {Limits::quiet_NaN(),
                         Limits::infinity(),
                         -Limits::infinity(),
                         Limits::max(),
                         -Limits::max(),
                         Limits::denorm_min(),
                         T(-0.0),
                         Limits::min()};
    const auto [content, bits] = next();
    return content == Content::usual  ? usual
           : content == Content::bits ? std::bit_cast<T>(static_cast<Bits>(bits))
                                      : special[bits % 8];
  }
  /// A reading of `[0, 1]`, times `size`.
  float reading(float size) {
    const float usual = size * static_cast<float>(fields_[at_].second % 1025) / 1024;
    return number(usual);
  }
  Nanoseconds time(Nanoseconds now, Nanoseconds back) {
    constexpr Nanoseconds special[] = {Nanoseconds::min(), Nanoseconds::max(), 0ns, -1ns};
    const auto [content, bits] = next();
    return content == Content::usual
               ? now - Nanoseconds(static_cast<std::int64_t>(bits % std::uint64_t(back.count() + 1)))
           : content == Content::bits ? Nanoseconds(static_cast<std::int64_t>(bits))
                                      : special[bits % 4];
  }
  /// Below `count`, or any.
  std::uint64_t index(std::uint64_t count) {
    const auto [content, bits] = next();
    return content == Content::usual ? bits % count : bits;
  }

 private:
  Field next() { return fields_[at_++]; }
  const std::vector<Field>& fields_;
  std::size_t at_ = 0;
};

/// How much a velocity may change from one command to the next, whose times tell what has passed: a cycle
/// brakes for a period where the clock says that nothing has, and for five at most.
template <class T>
T largest_change(const JointLimits<6, T>& limits, std::size_t i, const JointCommand<6, T>& before,
                 const JointCommand<6, T>& now) {
  const T dt = std::clamp(seconds<T>(now.time - before.time), T(0.008), T(0.04));
  return limits.acceleration()[i] * dt * T(1.0001) +
         8 * std::numeric_limits<T>::epsilon() * limits.velocity()[i];
}

/// Starts a scene at `state`, which its first cycle shows; before that no command is valid (see
/// `start_test`).
template <class Scene, class T>
JointCommand<6, T> begun(const Scene& scene, typename Scene::Memory& memory, State<6, T>& state,
                         Nanoseconds& now) {
  scene.start(memory, state);
  typename Scene::Input input;
  input.now = state.time = now += 8ms;
  input.measured = state;
  const auto out = scene.step(memory, input);
  state.q = out.command.position;
  state.dq = out.planned.velocity;
  return out.planned;
}

/// Runs a scene over the cycles and asserts what no input may change.
template <class T>
void survives(const std::vector<std::vector<Field>>& cycles) {
  static const auto scene = reaching_scene<Interface::position, 260, T>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  static const auto memory = std::make_unique<typename Scene::Memory>();
  const auto limits = ur5_test_limits<T>();
  const T period = T(0.008);  // a command is carried out in one, whatever time has passed
  State<6, T> state;
  state.q = home_position<T>();
  Nanoseconds now{};
  JointCommand<6, T> last = begun(scene, *memory, state, now);
  std::uint64_t allocated = 0;
  for (const auto& fields : cycles) {
    Tape tape(fields);
    now += 8ms;
    typename Scene::Input input;
    input.now = tape.time(now, 0ns);
    input.measured.time = tape.time(now, 0ns);
    for (std::size_t i = 0; i < 6; ++i) input.measured.q[i] = tape.number(state.q[i]);
    for (std::size_t i = 0; i < 6; ++i) input.measured.dq[i] = tape.number(state.dq[i]);
    const auto count = static_cast<std::size_t>(tape.index(samples_a_cycle + 1) % (samples_a_cycle + 1));
    std::array<CellSample, samples_a_cycle> samples;
    for (auto& s : samples) {
      s.time = tape.time(now, 8ms);
      s.cell = static_cast<std::uint32_t>(tape.index(262));
      for (float& f : s.force) f = tape.reading(1);
      s.proximity = tape.reading(1);
      for (float& a : s.acceleration) a = tape.reading(20);
      s.temperature = tape.reading(40);
    }
    input.samples = std::span(samples).first(count);
    input.request = static_cast<CycleRequest>(tape.index(1));
    input.observed = Status::from_bits(tape.index(1));  // a stop waits for the request `resume`
    if (tape.index(16) == 15) {
      auto& goal = input.goal.emplace();
      for (std::size_t i = 0; i < 6; ++i) goal.q_g[i] = tape.number(T(state.q[i] + T(0.3)));
      goal.duration = tape.time(4s, 4s);
    }

    const AllocationGuard guard;
    const auto out = scene.step(*memory, input);
    allocated += guard.count();
    RC_ASSERT(out.command.valid);
    for (std::size_t i = 0; i < 6; ++i) {
      const T q = out.planned.position[i], v = out.planned.velocity[i];
      RC_ASSERT(q >= limits.lower()[i] && q <= limits.upper()[i]);
      RC_ASSERT(std::abs(v) <= limits.velocity()[i] * T(1.0001));
      RC_ASSERT(std::abs(v - last.velocity[i]) <= largest_change(limits, i, last, out.planned));
      RC_ASSERT(std::abs(q - last.position[i]) <= limits.velocity()[i] * period * T(1.0001));
    }
    last = out.planned;
    state.q = out.command.position;
    state.dq = out.planned.velocity;
  }
  RC_ASSERT(allocated == 0u);
}

/// Runs of up to a hundred cycles; one field in sixteen is not as usual.
template <class T>
void check_runs() {
  const auto field = rc::gen::pair(
      rc::gen::weightedElement<Content>({{30, Content::usual}, {1, Content::bits}, {1, Content::special}}),
      rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>()));
  survives<T>(*rc::gen::container<std::vector<std::vector<Field>>>(
      rc::gen::container<std::vector<Field>>(fields_a_cycle, field)));
}

}  // namespace

TEST_CASE("input: arbitrary bits in any field of it, as cases that shrink") {
  CHECK(rc::check("double", check_runs<double>));
  CHECK(rc::check("float", check_runs<float>));
}

TEST_CASE_TEMPLATE(
    "input: whatever bits are in any field, commands stay finite, within limits and free of steps", T, float,
    double) {
  const auto scene = reaching_scene<Interface::position, 260, T>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto limits = ur5_test_limits<T>();
  auto memory = std::make_unique<typename Scene::Memory>();
  oracle::Random random(sizeof(T));
  State<6, T> state;
  const AllocationGuard guard;
  int bad = 0, steps = 0;
  JointCommand<6, T> last;
  const int runs = sanitized ? 60 : 1000;
  for (int run = 0; run < runs; ++run) {
    state = {};
    state.q = home_position<T>();
    Nanoseconds now{};
    last = begun(scene, *memory, state, now);
    for (int k = 1; k <= 100; ++k) {
      now += 8ms;
      typename Scene::Input input;
      input.now = random.index(20) == 0 ? static_cast<Nanoseconds>(random.bits()) : now;
      input.measured = state;
      input.measured.time = random.index(20) == 0 ? static_cast<Nanoseconds>(random.bits()) : now;
      if (random.index(4) == 0)
        input.measured.q[static_cast<std::size_t>(random.index(6))] = any_number<T>(random);
      if (random.index(4) == 0)
        input.measured.dq[static_cast<std::size_t>(random.index(6))] = any_number<T>(random);
      std::array<CellSample, 5> samples;
      for (auto& s : samples) {
        s = {.time = random.index(3) == 0 ? static_cast<Nanoseconds>(random.bits()) : now,
             .cell = static_cast<std::uint32_t>(random.index(3) == 0 ? random.bits() : 60),
             .force = {any_number<float>(random), any_number<float>(random), 0.3f},
             .proximity = any_number<float>(random)};
        if (random.index(2) == 0) s.force = {0.5f, 0.5f, 0.5f}, s.proximity = 0;
      }
      input.samples = samples;
      input.request = static_cast<CycleRequest>(random.index(30));
      if (random.index(50) == 0) input.observed = Status::from_bits(random.bits());
      if (random.index(10) == 0) {
        auto& goal = input.goal.emplace();
        for (auto& x : goal.q_g) x = random.index(2) == 0 ? any_number<T>(random) : T(0.3);
        goal.duration = static_cast<Nanoseconds>(random.bits());
      }
      const auto out = scene.step(*memory, input);
      bad += !out.command.valid;
      for (std::size_t i = 0; i < 6; ++i) {
        const T q = out.planned.position[i], v = out.planned.velocity[i];
        bad += !(q >= limits.lower()[i] && q <= limits.upper()[i]);
        bad += !(std::abs(v) <= limits.velocity()[i] * T(1.0001));
        steps += !(std::abs(v - last.velocity[i]) <= largest_change(limits, i, last, out.planned));
        // A command is carried out in a period, whatever time has passed.
        steps += !(std::abs(q - last.position[i]) <= limits.velocity()[i] * T(0.008 * 1.0001));
      }
      last = out.planned;
      state.q = out.command.position;
      state.dq = out.planned.velocity;
    }
  }
  CHECK(bad == 0);
  CHECK(steps == 0);
  CHECK(guard.count() == 0);
}
