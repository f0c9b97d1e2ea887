// The part of Cycle that runs in every cycle.
#pragma once

#include "skinctl/cycle/cycle.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
template <class Watch, class Change>
SKINCTL_INLINE auto Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::run(
    Memory& m, const Input& input, Watch& watch, const Change& change) const noexcept -> Output {
  const RealTimeScope real_time;
  watch.begin();
  Status status;
  if (input.request == CycleRequest::stop) resolver_.stop(m.robot);
  if (input.request == CycleRequest::resume) {
    if (guard_.refuses_start(m.guard)) [[unlikely]] {
      start_anew(m, input);
    } else {
      resolver_.resume(m.robot);
      guard_.acknowledge(m.guard);
    }
  }
  if (input.goal) status |= change.receive(*this, m, [&] { return receive(m, input); });

  const Interval interval = resolver_.interval(m.robot, input.now);
  detail::Unwritten<Touch, max_substeps> touches;
  const std::size_t parts = interval.substeps == 0 ? 1 : interval.substeps;
  status |= interval.status;
  const auto measured = [&]() SKINCTL_INLINE_LAMBDA -> const State<joints, scalar>& {
    return detail::believed(input.measured, m.robot.measured(), guard_);
  };
  status |= detail::receive_touch(skin_, m.skin, input, measured, interval, parts, touches.data);
  const auto pressed = detail::pressed<watches_contacts>(skin_, m.skin, touches.data[parts - 1]);
  bool pause = false;
  if constexpr (detail::watches_skin<Overseer>) {
    status |= governor_.watch().look(m.governor.watch, detail::coverage_of(skin_, m.skin),
                                     seconds<scalar>(interval.to - interval.from));
    pause = pauses(m);
    if (pause) resolver_.stop(m.robot);
  }
  if constexpr (requires { law_.feel(m.law, skin_.contacts(m.skin), interval.to); })
    law_.feel(m.law, skin_.contacts(m.skin), interval.to);
  if constexpr (has_gripper) law_.grip(m.law, input.gripper, interval.to);
  if constexpr (has_surroundings)
    governor_.clearance().see(m.governor.around, input.around, measured().q, interval.to);
  watch.end(CycleStage::sense);

  change.carry(*this, m, input.measured, interval);
  [[maybe_unused]] bool hard = false;  // before the step and after it: the last one ends with hard braking
  if constexpr (detail::limits_jerk<Overseer>) hard = resolver_.stops_or_corrects(m.robot);
  const std::span<const Touch> felt(touches.data, parts);
  auto resolved = [&] {
    if constexpr (detail::watches_contacts<Resolver>) {
      return resolver_.step(m.robot, law_, m.law, input.measured, interval, felt, guard_, pressed);
    } else {
      return resolver_.step(m.robot, law_, m.law, input.measured, interval, felt, guard_);
    }
  }();
  [[maybe_unused]] const bool stops = resolver_.stops(m.robot);
  if constexpr (detail::watches_skin<Overseer>) {
    if (pause) {
      resolver_.go_on(m.robot);
      resolved.status = Status::from_bits(resolved.status.bits() & ~Status(Reason::stopping).bits());
    }
  }
  status |= resolved.status;
  if constexpr (detail::limits_jerk<Overseer>) hard = hard || resolver_.stops_or_corrects(m.robot);
  watch.end(CycleStage::resolve);

  Status found = input.observed;
  bool slowed = false;
  if constexpr (governed) {
    if (interval.substeps != 0) {
      if constexpr (Overseer::has_clearance && requires { resolver_.off(m.robot); })
        governor_.clearance().stand_off(m.governor.around, resolver_.off(m.robot));
      const auto given = govern(m, resolved, pressed, interval, hard, stops);
      status |= given.status;
      found |= given.status;
      slowed = given.altered;
      resolved.command.assign(given.command);
      if constexpr (requires { given.hold; }) resolved.fallback = given.hold;
    }
  }
  const auto guarded = guard_.step(m.guard, resolved.command, m.robot.measured(), input.now,
                                   resolved.fallback, found | status);
  status |= guarded.status | input.observed;
  if (guarded.altered || slowed) resolver_.sent(m.robot, guarded.command);
  if constexpr (governed) {
    if (guarded.altered && detail::commands_motion<Resolver>) governor_.sent(m.governor, guarded.command);
  }
  if (guard_.waits(m.guard)) resolver_.stop(m.robot);
  watch.end(CycleStage::guard);
  Output out(guarded.command, status, resolved.shares);
  if constexpr (has_gripper) out.gripper = L::gripper(m.law);
  return out;
}

template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
template <class Resolved, class Pressed>
SKINCTL_INLINE auto Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::govern(
    Memory& m, const Resolved& resolved, const Pressed& pressed, const Interval& interval,
    [[maybe_unused]] bool hard, [[maybe_unused]] bool stops) const noexcept {
  scalar dt = seconds<scalar>(interval.to - interval.from);
  if constexpr (detail::takes_positions<Resolver>) dt = resolver_.span(m.robot, dt);
  const auto nearest = detail::nearest<Overseer>(skin_, m.skin);
  if constexpr (!detail::has_one_interface<Resolver>) {
    std::array<scalar, Resolver::stiff_groups> spans;
    Resolver::each([&](auto k) { spans[k.value] = resolver_.template span<k.value>(m.robot, dt); });
    return governor_.step(m.governor, guard_.last(m.guard), resolved.command, resolved.fallback,
                          guard_.waits(m.guard) || pauses(m), resolved.status.has(Reason::state_stale),
                          scalar(guard_.settings().torque_rate), m.robot.measured(), pressed, nearest, spans,
                          dt, hard, stops);
  } else if constexpr (Resolver::interface == Interface::torque) {
    return governor_.step_torque(m.governor, m.guard.command, resolved.command, resolved.fallback,
                                 guard_.waits(m.guard) || pauses(m), resolved.status.has(Reason::state_stale),
                                 scalar(guard_.settings().torque_rate), m.robot.measured(), pressed, nearest,
                                 dt);
  } else {
    return governor_.step(m.governor, m.guard.command, resolved.command, m.robot.measured(), pressed, nearest,
                          dt, hard, stops);
  }
}

template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
SKINCTL_COLD Status Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::receive(
    Memory& m, const Input& input) const noexcept {
  if constexpr (std::is_same_v<Goal, NoGoal>) {
    return Reason::goal_refused;
  } else {
    const auto state = resolver_.state(m.robot);
    const Wrenches touch = skin_.wrenches(m.skin);
    const auto received =
        follow_or_receive(law_, m.law, resolver_.template known<L>(state, period(), touch), *input.goal);
    m.law = received.memory;
    return received.status;
  }
}

// A robot that was told to be elsewhere by a gap still is.
template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
SKINCTL_COLD void Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::start_anew(
    Memory& m, const Input& input) const noexcept {
  State<joints, scalar> measured = input.measured;
  if (measured.time > input.now) measured.time = input.now;
  if (!guard_.believes(measured)) return;
  if constexpr (detail::takes_positions<Resolver>)
    if (m.robot.group().gap_told) return start(m, measured, measured.q - m.robot.group().gap);
  start(m, measured);
}

// For `Configurations`.

template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
bool Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::may_change(const Memory& m,
                                                                          const Input& input) const noexcept {
  if (guard_.refuses_start(m.guard)) return false;
  if constexpr (requires { resolver_.asks_law(m.robot, input.measured, input.now, guard_); }) {
    auto robot = m.robot;
    if (input.request == CycleRequest::stop) resolver_.stop(robot);
    if (input.request == CycleRequest::resume) resolver_.resume(robot);
    if (pauses(m)) resolver_.stop(robot);
    return resolver_.asks_law(robot, input.measured, input.now, guard_);
  } else {
    return true;
  }
}

template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
SKINCTL_COLD void Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::restart(
    Memory& m) const noexcept {
  if constexpr (!std::is_same_v<Goal, NoGoal>)
    m.law =
        law_.start(resolver_.template known<L>(resolver_.state(m.robot), period(), skin_.wrenches(m.skin)));
}

template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
SKINCTL_COLD void Cycle<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>::carry_from(
    const Cycle& before, const typename L::Memory& law_before, Memory& m,
    const State<joints, scalar>& measured, const Interval& interval) const noexcept {
  using Asked = detail::Asked<Resolver, L, Wrenches>;
  const Wrenches touch_before = before.skin_.wrenches(m.skin), touch = skin_.wrenches(m.skin);
  if constexpr (requires { resolver_.changed(m.robot); }) resolver_.changed(m.robot);
  L::drop(m.law);
  L::carry(m.law, resolver_.lacking(m.robot, measured, interval, guard_,
                                    Asked{before.resolver_, before.law_, law_before, touch_before},
                                    Asked{resolver_, law_, m.law, touch}));
}

SKINCTL_END_NAMESPACE
