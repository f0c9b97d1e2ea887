// SPDX-License-Identifier: BSD-3-Clause
// The states of a resolver between two cycles: start, stop, what was sent.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/resolver/detail/resolver_numbers.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The part of a `Resolver` that acts on its memory between cycles.
template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class PassivityParts,
          class Tool>
class ResolverState : public ResolverNumbers<M, T, Sets, Integrator, History, PassivityParts, Tool> {
  using Base = ResolverNumbers<M, T, Sets, Integrator, History, PassivityParts, Tool>;

 public:
  using Base::each;
  using Base::has_driven;
  using Base::has_tank;
  using Base::has_virtual;
  using Base::joints;
  using Base::one_group;
  using Driven = typename Base::Driven;
  using Stiff = typename Base::Stiff;
  using Memory = typename Base::Memory;
  template <std::size_t K>
  using Group = typename Base::template Group<K>;
  template <std::size_t K>
  using Part = typename Base::template Part<K>;

  /// The memory of a robot that starts at `measured`. Virtual joints take over at the positions of the real
  /// ones, and with their velocities where these are above `RobotConfiguration::resting_speed`; gravity of
  /// those by torque is compensated. The law's memory then starts at `state(memory)`. A state that is not
  /// finite gives a memory that has not been started.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<joints, T>& measured) const noexcept {
    Memory m;
    if (!is_plausible(measured) || !is_plausible(measured.time)) return m;
    m.started = true;
    each([&](auto k) {
      auto& group = m.template group<k.value>();
      group = std::get<k.value>(virtual_).start(part_of<Part<k.value>>(measured));
      m.started = m.started && group.started;
    });
    return m.started ? take_over(m, measured) : m;
  }
  /// The memory of a robot by position that was told to be at `told` and stands beside it (a servo that
  /// droops, encoders that are off): the first command is `told`, so that the robot does not step, and the
  /// gap is taken off the measurements. More than `largest_gap` of one joint: the memory has not been
  /// started.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<joints, T>& measured,
                                          const JointPosition<joints, T>& told) const noexcept
    requires one_group
  {
    Memory m;
    m.group() = std::get<0>(virtual_).start(measured, told);
    m.started = m.group().started;
    return m.started ? take_over(m, measured) : m;
  }

  /// The state that laws read: the virtual one of the stiff joints, the measured one of those by torque.
  [[nodiscard]] SKINCTL_INLINE State<joints, T> state(const Memory& m) const noexcept {
    if constexpr (one_group) {
      return {m.time, m.group().q.value, m.group().v};
    } else if constexpr (has_virtual) {
      return state(m, m.time, velocity(m));
    } else {
      return m.measured();
    }
  }

  /// The interval that a cycle at `now` has to integrate; empty if `now` is not later than the last cycle. By
  /// torque it is one sub-step: a torque is held, not integrated.
  [[nodiscard]] Interval interval(const Memory& m, Nanoseconds now) const noexcept {
    Interval out = interval_since(m.started, m.time, m.odd_time, now, this->longest_interval_);
    out.carried = out.clock_set ? 0ns : m.carried;
    if constexpr (has_virtual) {
      const std::int64_t steps = (out.to - out.from + this->substep_ - 1ns) / this->substep_;
      out.substeps = steps < std::int64_t(max_substeps) ? static_cast<unsigned>(steps) : max_substeps;
    } else {
      out.substeps = out.to > out.from ? 1 : 0;
    }
    return out;
  }

  /// Takes the state of the base from the input of the cycle at `now`, if the model's base moves.
  template <class Input>
  SKINCTL_INLINE Status see_base([[maybe_unused]] Memory& m, [[maybe_unused]] const Input& input,
                                 [[maybe_unused]] Nanoseconds now) const noexcept {
    if constexpr (base_moves<M>) {
      return detail::see_base(m.base, input.base, model_.base_settings(), now,
                              base_at_rest<T>(model_.at_rest()));
    } else {
      return {};
    }
  }
  /// The model as touch sees it: with the motion of its base, if that moves.
  [[nodiscard]] SKINCTL_INLINE decltype(auto) model_seen([[maybe_unused]] const Memory& m) const noexcept {
    if constexpr (base_moves<M>) {
      return ModelOnBase<M, T>{model_, m.base.now};
    } else {
      return (model_);
    }
  }
  /// The torque that the motion of the base adds for a robot at `now` [N m].
  [[nodiscard]] JointTorque<joints, T> torque_of_base(const Memory& m,
                                                      const State<joints, T>& now) const noexcept
    requires base_moves<M>
  {
    if (!m.base.seen) return {};
    return base_torque(model_.at_rest(), now.q, now.dq, m.base.now);
  }
  /// The torque that holds the joints by torque without a law, within their limits: gravity, and what brakes;
  /// zero for the others.
  [[nodiscard]] JointTorque<joints, T> held([[maybe_unused]] const Memory& m,
                                            const State<joints, T>& robot) const noexcept {
    JointTorque<joints, T> out;
    if constexpr (has_driven) {
      Torque weight = gravity_torque(model_, robot.q);
      if constexpr (base_moves<M>) weight += this->torque_of_base(m, robot);
      auto stopped = m.driven;
      Driven::put(Driven::of(weight) - this->resistance(robot, m.stop ? &stopped : nullptr).brakes, out);
    }
    return this->limits_.within(out, robot.dq);
  }

  /// Tells that the guard let `command` out instead of the last one: the virtual robot goes on from there.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<joints, T>& command) const noexcept {
    if (!m.started || !command.valid) return;
    if constexpr (one_group) {
      std::get<0>(virtual_).sent(m.group(), command);
    } else {
      each([&](auto k) {
        auto& group = m.template group<k.value>();
        const auto given = part_of<Part<k.value>>(command);
        if (!(given.position == group.command.position && given.velocity == group.command.velocity))
          std::get<k.value>(virtual_).sent(group, given);
      });
      if constexpr (has_driven) {
        m.driven.torque = Driven::of(command.torque);
        if constexpr (has_tank) passivity_.template get<EnergyTank<T>>().sent(m.driven.tank, m.driven.torque);
      }
      compose(m, command.torque);
    }
  }
  /// Tells that no command left: motion of the robot until one does is no deviation from its commands.
  static SKINCTL_COLD void not_sent(Memory& m) noexcept {
    each([&](auto k) { m.template group<k.value>().seen = false; });
  }
  /// The robot's deviation from its commands: the measured position less that which they should have brought,
  /// r + g [rad]; zero for the joints by torque.
  [[nodiscard]] static SKINCTL_INLINE JointPosition<joints, T> off(const Memory& m) noexcept {
    JointPosition<joints, T> out;
    each([&](auto k) {
      const auto& g = m.template group<k.value>();
      Part<k.value>::put(g.residual + g.gap, out);
    });
    return out;
  }
  /// The gap g that was taken off the measured positions [rad]; zero for the joints by torque.
  [[nodiscard]] static SKINCTL_INLINE JointPosition<joints, T> gap(const Memory& m) noexcept {
    JointPosition<joints, T> out;
    each([&](auto k) { Part<k.value>::put(m.template group<k.value>().gap, out); });
    return out;
  }
  /// Tells that another configuration has taken over: a torque that differs is no jump of its laws.
  void changed(Memory& m) const noexcept {
    m.own.known = false;
    if constexpr (has_driven) m.driven.own.known = false;
  }
  /// Begins a stop.
  void stop(Memory& m) const noexcept {
    m.stop = true;
    each([&](auto k) { m.template group<k.value>().stop = true; });
  }
  [[nodiscard]] static bool stops(const Memory& m) noexcept { return m.stop; }
  /// Ends a stop that was not the user's: displaced joints wait on.
  static void go_on(Memory& m) noexcept {
    m.stop = false;
    each([&](auto k) { m.template group<k.value>().stop = false; });
  }
  /// Ends a stop. A displaced robot goes on if its gap is `largest_gap` at most.
  void resume(Memory& m) const noexcept {
    m.stop = false;
    each([&](auto k) { std::get<k.value>(virtual_).resume(m.template group<k.value>()); });
  }

 protected:
  using Base::Base;
  using Base::model_;
  using Base::passivity_;
  using Base::virtual_;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Acceleration = typename Base::Acceleration;
  using Torque = typename Base::Torque;

  /// The velocities of the stiff joints; zero for the others.
  [[nodiscard]] SKINCTL_INLINE Velocity velocity(const Memory& m) const noexcept {
    Velocity v;
    each([&](auto k) { Part<k.value>::put(m.template group<k.value>().v, v); });
    return v;
  }
  [[nodiscard]] SKINCTL_INLINE Position position(const Memory& m) const noexcept {
    if constexpr (one_group) {
      return m.group().q.value;
    } else {
      Position q = m.measured().q;
      each([&](auto k) { Part<k.value>::put(m.template group<k.value>().q.value, q); });
      return q;
    }
  }
  [[nodiscard]] SKINCTL_INLINE Acceleration last(const Memory& m) const noexcept {
    Acceleration a;
    each([&](auto k) { Part<k.value>::put(m.template group<k.value>().last, a); });
    return a;
  }
  /// The state of the virtual joints, moving at `v`, and of the measured ones.
  [[nodiscard]] SKINCTL_INLINE State<joints, T> state(const Memory& m, Nanoseconds time,
                                                      const Velocity& v) const noexcept {
    if constexpr (Stiff::is_all) {
      return {time, position(m), v};
    } else {
      State<joints, T> s{time, position(m), m.measured().dq};
      Stiff::put(Stiff::of(v), s.dq);
      return s;
    }
  }
  /// Whether laws move the virtual joints: no group brakes.
  [[nodiscard]] static SKINCTL_INLINE bool following(const Memory& m) noexcept {
    bool all = true;
    each([&](auto k) { all = all && !m.template group<k.value>().brakes; });
    return all;
  }
  /// The joint torque of the contacts felt [N m], if there are joints that contacts deflect.
  template <class Touch>
  [[nodiscard]] SKINCTL_INLINE Torque pushed(const Memory& m, const Touch& touch) const noexcept {
    if constexpr (Base::gives_way) {
      return skin_torque(model_, JointAngles<M, T>(model_, m.measured().q), contact_part(touch));
    } else {
      return {};
    }
  }
  /// Puts what the motion of the last command takes, `M ddq + C dq` [N m], into `torque` of the joints that
  /// are sent it beside their positions. That command has passed the guard; joints by torque are taken to
  /// move steadily.
  SKINCTL_INLINE void feed_forward(const Memory& m, Torque& torque) const noexcept {
    if constexpr (!Base::feeds_forward) return;
    const auto& c = m.command();
    Torque takes =
        yr_theta<GravityTerm::left_out>(model_, c.position, c.velocity, c.velocity, c.acceleration);
    if constexpr (base_moves<M>) takes += this->torque_of_base(m, {c.time, c.position, c.velocity});
    if (!is_finite(takes)) return;
    each([&](auto k) {
      if constexpr (takes_torque(Group<k.value>::interface))
        Part<k.value>::put(Part<k.value>::of(takes), torque);
    });
  }
  /// Composes the command of all groups, with `torque` for the joints by torque.
  SKINCTL_INLINE void compose(Memory& m, const Torque& torque) const noexcept {
    if constexpr (!one_group) {
      auto& all = m.whole.command;
      all = {m.time, true, m.measured().q, m.measured().dq, {}, {}};
      each([&](auto k) { put_part<Part<k.value>>(m.template group<k.value>().command, all); });
      if constexpr (has_driven) Driven::put(Driven::of(torque), all.torque);
    }
  }

 private:
  /// Starts what a memory holds beside its virtual joints.
  [[nodiscard]] SKINCTL_COLD Memory take_over(Memory& m, const State<joints, T>& measured) const noexcept {
    m.time = measured.time;
    m.passivity = passivity_.template start<joints>();
    if constexpr (!one_group) {
      m.whole.measured = measured;
      const Torque torque = held(m, measured);
      if constexpr (has_driven) {
        m.driven.torque = Driven::of(torque);
        if constexpr (has_tank)
          m.driven.tank = passivity_.template get<EnergyTank<T>>().template hold<Driven::count>();
      }
      compose(m, torque);
    }
    return m;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
