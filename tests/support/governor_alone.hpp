// A governor of an arm without a scene.
#pragma once

#include "skinctl/limits/governor.hpp"
#include "skinctl/robot/joint_groups.hpp"

namespace skinctl::testing {

/// What limits see of a touch: contacts, and the strongest proximity readings in the order of the links.
template <class Touch, class Nearest>
struct TouchOf {
  const Touch& touch;
  const Nearest& near;
  [[nodiscard]] const Touch& pressed() const noexcept { return touch; }
  template <std::size_t>
  [[nodiscard]] auto max_proximity() const noexcept {
    return near[0];
  }
};

/// A governor of all joints with one interface, and its cycle in one call.
template <class Governor>
struct GovernorAlone : Governor {
  static constexpr std::size_t N = Governor::joints;
  using T = typename Governor::scalar;
  using Base = Governor;
  using typename Governor::Memory;
  explicit GovernorAlone(const Governor& governor) : Governor(governor) {}

  template <class Touch, class Nearest>
  auto step(Memory& m, const JointCommand<N, T>& last, const JointCommand<N, T>& wish,
            const State<N, T>& measured, const Touch& touch, const Nearest& nearest, T dt) const noexcept {
    return Governor::step(m, {.last = last, .measured = measured, .span = dt, .dt = dt}, wish, {},
                          TouchOf<Touch, Nearest>{touch, nearest});
  }
  template <class Touch, class Nearest>
  auto step_torque(Memory& m, const JointCommand<N, T>& last, const JointCommand<N, T>& wish,
                   const JointTorque<N, T>& hold, bool stale, T rate, const State<N, T>& measured,
                   const Touch& touch, const Nearest& nearest, T dt) const noexcept {
    return Governor::step(
        m, {.last = last, .measured = measured, .span = dt, .dt = dt, .torque_rate = rate, .stale = stale},
        wish, hold, TouchOf<Touch, Nearest>{touch, nearest});
  }
};
/// Of an arm of the model `M` by the interface `I`.
template <Interface I, class M, std::size_t N, class T, class... Limits>
auto governor_alone(const JointLimits<N, T>& limits, const Limits&... given) {
  using Sets = JointGroups<N, JointGroup<I, joints_between(0, N), T>>;
  return GovernorAlone(make_governor<Sets>(M{}, limits, given...));
}

}  // namespace skinctl::testing
