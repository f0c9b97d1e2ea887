#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

namespace {

/// Largest distance [rad] of the command from a sine that is streamed into every cycle, after 3 s.
template <class L, class Wrap>
double lag_behind_a_sine(const L& law, Wrap&& wrap) {
  const Nanoseconds period = 2ms;
  const auto arm = by_position(
      ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = period, .virtual_damping = 0});
  const Cycle cycle(arm, law);
  using Scene = std::remove_const_t<decltype(cycle)>;
  const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
  State<6> state{0ns, home, {}};
  auto memory = cycle.start(state);
  double off = 0;
  for (int k = 1; k <= 3000; ++k) {
    const double t = 0.002 * k, w = 1.5;
    typename Scene::Input input;
    input.now = state.time = k * period;
    input.measured = state;
    JointReference<6> target{home, {}, {}};
    target.q_d[1] += 0.2 * (1 - std::cos(w * t));
    target.dq_d[1] = 0.2 * w * std::sin(w * t);
    target.ddq_d[1] = 0.2 * w * w * std::cos(w * t);
    input.goal = wrap(target);
    const auto out = cycle.step(memory, input);
    REQUIRE(out.command.valid);
    state.q = out.command.position;
    state.dq = out.planned.velocity;
    if (t > 3) off = std::max(off, std::abs(out.command.position[1] - target.q_d[1]));
  }
  return off;
}

}  // namespace

TEST_CASE(
    "cycle: a target that moves is followed, sample by sample, alone, in a sum and in one that blends") {
  const JointControl<6> follow({.dt = 2ms});
  const auto plain = [](const JointReference<6>& target) { return target; };
  CHECK(lag_behind_a_sine(follow, plain) < 2e-3);
  CHECK(lag_behind_a_sine(follow + GravityControl(), plain) < 2e-3);
  const auto sum = blended(follow + GravityControl());
  using Goal = decltype(sum)::Goal;
  CHECK(lag_behind_a_sine(sum, [](const JointReference<6>& target) { return Goal{.goal = target}; }) < 2e-3);
}
