// SPDX-License-Identifier: BSD-3-Clause
// What runs in every cycle of a scene.
#pragma once

#include <concepts>
#include <limits>
#include <span>

#include "skinctl/core/real_time.hpp"
#include "skinctl/cycle/detail/cycle_parts.hpp"
#include "skinctl/cycle/stage.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class C, std::size_t Count>
class Configurations;
namespace detail {
template <class Scene, class LawMemory>
struct ChangeFrom;

/// The start and the step of a `Cycle`.
template <class Resolver, class GivenLaw, class GivenSkin, class GivenParts>
class CycleLoop : public CycleParts<Resolver, GivenLaw, GivenSkin, GivenParts> {
  using Parts = CycleParts<Resolver, GivenLaw, GivenSkin, GivenParts>;

 public:
  using Parts::governed;
  using Parts::joints;
  using Parts::watches_contacts;
  using scalar = typename Parts::scalar;
  using Goal = typename Parts::Goal;
  using Input = typename Parts::Input;
  using Output = typename Parts::Output;
  using Wrenches = typename Parts::Wrenches;
  using Touch = typename Parts::Touch;
  using Memory = typename Parts::Memory;

  /// Starts a memory in place: see `Cycle::start`.
  SKINCTL_COLD void start(Memory& m, const State<joints, scalar>& measured) const noexcept {
    m.robot = resolver_.start(measured);
    start_rest(m, measured);
  }
  SKINCTL_COLD void start(Memory& m, const State<joints, scalar>& measured,
                          const JointPosition<joints, scalar>& told) const noexcept
    requires takes_positions<Resolver>
  {
    m.robot = resolver_.start(measured, told);
    start_rest(m, m.robot.started ? m.robot.measured() : measured);
  }

 protected:
  using Parts::CycleParts;
  using Parts::governor_;
  using Parts::guard_;
  using Parts::law_;
  using Parts::mark_;
  using Parts::parts_;
  using Parts::pauses;
  using Parts::period;
  using Parts::resolver_;
  using Parts::skin_;
  using L = typename Parts::L;
  using Governor = typename Parts::Governor;
  static constexpr bool changes_touch = !std::is_empty_v<typename Parts::Change::Memory>;
  static constexpr bool takes_goals = LawTable<L>::takes_goals;
  /// Whether a law, a limit or the passivity observer takes the touch of the scene, or it has none.
  template <class Seen>
  static constexpr bool answers_touch = Needs(L::needs).touch || sees<L, Input, Seen> ||
                                        Parts::watches_contacts || !std::equality_comparable<Wrenches>;

  /// One cycle in place: see `Cycle::step`.
  /// @param change  the change from the configuration of the last cycle, or `NoChange`.
  template <class Watch, class Change>
  SKINCTL_INLINE Output run(Memory& m, const Input& input, Watch& watch,
                            const Change& change) const noexcept {
    const RealTimeScope real_time;
    watch.begin();
    Status status;
    if (m.mark != mark_) [[unlikely]]
      status |= refuse_memory(m);
    if (input.request == CycleRequest::stop) resolver_.stop(m.robot);
    if (input.request == CycleRequest::resume) {
      if (guard_.refuses_start(m.guard)) [[unlikely]] {
        start_anew(m, input);
      } else {
        resolver_.resume(m.robot);
        guard_.acknowledge(m.guard);
      }
    }
    if constexpr (takes_goals)
      if (input.goal) status |= change.receive(*this, m, [&] { return receive(m, input); });

    const Interval interval = resolver_.interval(m.robot, input.now);
    Unwritten<Touch, max_substeps> touches;
    const std::size_t parts = interval.substeps == 0 ? 1 : interval.substeps;
    status |= interval.status | resolver_.see_base(m.robot, input, interval.to);
    const auto measured = [&]() SKINCTL_INLINE_LAMBDA -> const State<joints, scalar>& {
      return believed(input.measured, m.robot.measured(), guard_);
    };
    TouchTable<std::remove_cvref_t<decltype(skin_)>>::follow_robot(
        skin_, m.skin, resolver_.model_seen(m.robot), resolver_.state(m.robot));
    status |= receive_touch(skin_, m.skin, input, measured, interval, parts, touches.data);
    const auto pressed = detail::pressed<watches_contacts>(skin_, m.skin, touches.data[parts - 1]);
    const Seen<typename Parts::Skin, std::remove_cvref_t<decltype(pressed)>> seen{skin_, m.skin, pressed,
                                                                                  interval.to};
    status |= governor_.look(m.governor, seen, seconds<scalar>(interval.to - interval.from));
    const bool pause = pauses(m);
    if (pause) resolver_.stop(m.robot);
    status |= LawTable<L>::see(law_, m.law, input, seen);
    if constexpr (!answers_touch<std::remove_const_t<decltype(seen)>>)
      if (seen.touched()) status |= Reason::touch_unanswered;
    governor_.see(m.governor, input, measured().q, interval.to);
    watch.end(CycleStage::sense);

    change.carry(*this, m, input.measured, interval);
    const std::span<const Touch> felt(touches.data, parts);
    Unwritten<Wrenches, max_substeps> changes;
    if constexpr (changes_touch)
      for (unsigned j = 0; j < interval.substeps; ++j)
        changes.data[j] = Parts::Change::next(m.touch, total_of(felt[j]));
    auto resolved = resolve(m, input.measured, interval, felt, pressed,
                            std::span<const Wrenches>(changes.data, changes_touch ? interval.substeps : 0));
    [[maybe_unused]] const bool stops = resolver_.stops(m.robot);
    if (pause) {
      resolver_.go_on(m.robot);
      resolved.status = resolved.status.without(Reason::stopping);
    }
    status |= resolved.status;
    watch.end(CycleStage::resolve);

    Status found = input.observed;
    bool slowed = false;
    if constexpr (governed) {
      if (interval.substeps != 0) {
        if constexpr (Governor::stands_off) governor_.stand_off(m.governor, resolver_.off(m.robot));
        const auto given = govern(m, resolved, seen, interval, stops);
        status |= given.status;
        found |= given.status;
        slowed = given.altered;
        resolved.command = given.command;
      }
    }
    const auto guarded = guard_.step(m.guard, resolved.command, m.robot.measured(), interval,
                                     resolved.fallback, found | status);
    status |= guarded.status | input.observed;
    if (guarded.altered || slowed) resolver_.sent(m.robot, guarded.command);
    m.robot.left = m.robot.left || guarded.brakes;
    if (!guarded.command.valid) [[unlikely]]
      resolver_.not_sent(m.robot);
    if (guard_.waits(m.guard)) resolver_.stop(m.robot);
    watch.end(CycleStage::guard);
    Output out(guarded.command, status, resolved.shares);
    if (!out.command.valid) [[unlikely]]
      keep_still(out.command, input.measured);
    using LawOutput = typename LawTable<L>::Output;
    if constexpr (!std::is_empty_v<LawOutput>)
      static_cast<LawOutput&>(out) = LawTable<L>::output(law_, m.law);
    return out;
  }

 private:
  template <class, std::size_t>
  friend class skinctl::Configurations;
  template <class, class>
  friend struct ChangeFrom;

  /// Steps the resolver. One function for all stopwatches and for changes of the configuration: it is most of
  /// a cycle's code.
  template <class Pressed>
  SKINCTL_NOINLINE auto resolve(Memory& m, const State<joints, scalar>& measured, const Interval& interval,
                                std::span<const Touch> felt, [[maybe_unused]] const Pressed& pressed,
                                std::span<const Wrenches> changes) const noexcept {
    if constexpr (Resolver::watches_contacts) {
      return resolver_.step(m.robot, law_, m.law, measured, interval, felt, guard_, pressed, changes,
                            governor_);
    } else {
      return resolver_.step(m.robot, law_, m.law, measured, interval, felt, guard_, PressedUnknown{}, changes,
                            governor_);
    }
  }

  /// Starts all parts of a memory but the robot's.
  SKINCTL_COLD void start_rest(Memory& m, const State<joints, scalar>& measured) const noexcept {
    m.mark = mark_;
    m.skin = skin_.start(measured.time);
    m.guard = guard_.start(m.robot.command(), measured);
    m.governor = {};
    m.touch = {};
    if constexpr (LawTable<L>::starts_blank) {
      m.law = {};
    } else {
      const auto state = resolver_.state(m.robot);
      const Wrenches touch = skin_.wrenches(m.skin);
      m.law = law_.start(resolver_.template known<L>(state, period(), touch));
    }
  }
  /// Changes a command that must not be sent into one that moves nothing if it is sent all the same.
  SKINCTL_COLD void keep_still(typename Resolver::Sent& command,
                               const State<joints, scalar>& measured) const noexcept {
    using Position = JointPosition<joints, scalar>;
    using Torque = JointTorque<joints, scalar>;
    const bool known = guard_.believes(measured);
    command.each(
        [&]<class Numbers>(Numbers& numbers) {
          if constexpr (std::is_same_v<Numbers, Position>) {
            numbers = known ? measured.q : Position::constant(std::numeric_limits<scalar>::quiet_NaN());
          } else if constexpr (!std::is_same_v<Numbers, Torque>) {
            numbers = {};
          }
        },
        command);
  }
  /// Turns a memory of another scene, which holds commands of another robot, into one whose start was
  /// refused.
  SKINCTL_COLD Status refuse_memory(Memory& m) const noexcept {
    State<joints, scalar> nowhere;
    for (scalar& q : nowhere.q) q = std::numeric_limits<scalar>::quiet_NaN();
    start(m, nowhere);
    return Reason::memory_refused;
  }
  /// Starts at the measured state of this cycle; a gap to the position that the robot was told last stays.
  SKINCTL_COLD void start_anew(Memory& m, const Input& input) const noexcept {
    State<joints, scalar> measured = input.measured;
    if (measured.time > input.now) measured.time = input.now;
    if (!guard_.believes(measured)) return;
    if constexpr (takes_positions<Resolver>)
      if (m.robot.group().gap_told) return start(m, measured, measured.q - m.robot.group().gap);
    start(m, measured);
  }
  SKINCTL_COLD Status receive(Memory& m, const Input& input) const noexcept {
    const auto state = resolver_.state(m.robot);
    const Wrenches touch = skin_.wrenches(m.skin);
    const auto received =
        follow_or_receive(law_, m.law, resolver_.template known<L>(state, period(), touch), *input.goal);
    m.law = received.memory;
    return received.status;
  }
  template <class Resolved, class Seen>
  SKINCTL_INLINE auto govern(Memory& m, const Resolved& resolved, const Seen& seen, const Interval& interval,
                             bool stops) const noexcept {
    const scalar dt = seconds<scalar>(interval.to - interval.from);
    const auto& last = guard_.last(m.guard);
    const typename Governor::Input in{
        .last = last,
        .measured = m.robot.measured(),
        .span = seconds<scalar>(interval.command_duration(resolver_.period())),
        .dt = dt,
        .torque_rate = scalar(guard_.settings().torque_rate),
        .delay = seconds<scalar>(resolver_.driven_delay() + resolver_.driven_lag()),
        .motors = resolver_.shape().inertia,
        .stale = resolved.status.has(Reason::state_stale),
        .stops = stops};
    return governor_.step(m.governor, in, resolved.command, resolved.hold, seen);
  }

  // For `Configurations`: whether another one may take over now; the law's start at the robot's state; the
  // difference of torque between the old configuration and this one.
  [[nodiscard]] bool may_change(const Memory& m, const Input& input) const noexcept {
    if (m.mark != mark_ || guard_.refuses_start(m.guard)) return false;
    auto robot = m.robot;
    if (input.request == CycleRequest::stop) resolver_.stop(robot);
    if (input.request == CycleRequest::resume) resolver_.resume(robot);
    if (pauses(m)) resolver_.stop(robot);
    return resolver_.asks_law(robot, input.measured, input.now, guard_);
  }
  SKINCTL_COLD void restart(Memory& m) const noexcept {
    if constexpr (takes_goals)
      m.law =
          law_.start(resolver_.template known<L>(resolver_.state(m.robot), period(), skin_.wrenches(m.skin)));
  }
  SKINCTL_COLD void carry_from(const CycleLoop& before, const typename L::Memory& law_before, Memory& m,
                               const State<joints, scalar>& measured,
                               const Interval& interval) const noexcept {
    using Asked = detail::Asked<Resolver, L, Wrenches>;
    const Wrenches touch_before = before.skin_.wrenches(m.skin), touch = skin_.wrenches(m.skin);
    resolver_.changed(m.robot);
    m.touch = {};  // another skin's newtons are no change of the touch
    L::drop(m.law);
    L::carry(m.law, resolver_.lacking(m.robot, measured, interval, guard_,
                                      Asked{before.resolver_, before.law_, law_before, touch_before},
                                      Asked{resolver_, law_, m.law, touch}));
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
