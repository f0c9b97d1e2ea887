#include "skinctl/cycle/input.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <memory>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::test;

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

}  // namespace

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
    scene.start(*memory, state);
    last = memory->robot.command;
    Nanoseconds now = 0;
    for (int k = 1; k <= 100; ++k) {
      now += 8_ms;
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
      input.request = static_cast<Request>(random.index(30));
      input.has_goal = random.index(10) == 0;
      for (auto& x : input.goal.q_g) x = random.index(2) == 0 ? any_number<T>(random) : T(0.3);
      input.goal.duration = static_cast<Nanoseconds>(random.bits());
      const auto out = scene.step(*memory, input);
      bad += !out.command.valid;
      for (std::size_t i = 0; i < 6; ++i) {
        const T q = out.command.position[i], v = out.command.velocity[i];
        bad += !(q >= limits.lower()[i] && q <= limits.upper()[i]);
        bad += !(std::abs(v) <= limits.velocity()[i] * T(1.0001));
        // The longest interval that a cycle may integrate is ten periods.
        steps += !(std::abs(v - last.velocity[i]) <= limits.acceleration()[i] * T(0.0801));
      }
      last = out.command;
      state.q = out.command.position;
      state.dq = out.command.velocity;
    }
  }
  CHECK(bad == 0);
  CHECK(steps == 0);
  CHECK(guard.count() == 0);
}
