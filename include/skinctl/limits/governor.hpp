// SPDX-License-Identifier: BSD-3-Clause
// Keeps the limits that concern the whole robot: slows commands down between resolver and guard.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/limits/detail/drive.hpp"
#include "skinctl/limits/detail/limits_of_scene.hpp"
#include "skinctl/math/greatest_share.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A command that a governor passed or slowed; `altered` is true if it was slowed.
template <std::size_t N, Real T>
struct Governed {
  JointCommand<N, T> command;
  Status status;
  bool altered = false;
};
/// The stage between resolver and guard of a scene: its limits in the order of their precedence. It knows
/// what a limit is (`limits/limit.hpp`), and names none.
///
/// **Joints by position and velocity.** A command within the limits passes to the bit. Otherwise all joints
/// are slowed alike or turned aside as the limits say, a motion from the last command to that velocity is
/// computed within the limits of the joints, of jerk too where the scene has them, and the resolver learns
/// what was sent: its virtual robot goes on from there, so nothing is caught up later.
///
/// Where limits conflict, the joints' acceleration, position and velocity hold; then the later in the order
/// wins. Between a smooth motion and the smooth stop the largest share is taken that breaks no other limit;
/// where the stop does too, jerk gives way.
///
/// **Joints by torque.** The motion under external forces is unknown, so the speed is braked:
/// `braking_cycles` cycles and `braking_delays` delays ahead, after T, the torque leads to `u = dq + T M^-1
/// (tau - hold)`, of which the limits leave u'. `tau - M (u - u') / T` leads to u': drive that would make the
/// robot too fast, or press harder than a region allows, is removed, and a robot that is pushed too fast is
/// damped; what pushes it (the `resistance` of `MotionLimits`) counts as well, but not for a contact, whose
/// force it would hide. It sets in without a jump (u' = u leaves the torque to the bit), and never exceeds
/// the joints' torques.
///
/// @tparam Sets    `JointGroups` of the robot.
/// @tparam Limits  in the order of their precedence.
template <RobotModel M, Real T, class Sets, class... Limits>
class Governor : public detail::LimitsOfScene<M, T, Sets, Limits...> {
  using Base = detail::LimitsOfScene<M, T, Sets, Limits...>;

 public:
  using Base::count, Base::groups, Base::joints;
  using Base::has_driven, Base::has_motion, Base::smooth;
  using Input = typename Base::Input;
  using Memory = typename Base::Memory;
  using Command = JointCommand<joints, T>;
  using Output = Governed<joints, T>;
  using Base::Base;

  /// The command that the limits leave of `wish`.
  ///
  /// @param hold  the torque that holds the joints by torque: gravity compensation, with friction if it has
  ///               some; without what brakes them.
  /// @param seen  the touch of this cycle: `pressed()` (`PressedAreas`, or wrenches on the links),
  ///              `max_proximity<Ix>()` (the strongest proximity reading of a link) and `coverage()`, as far
  ///              as limits ask.
  ///
  /// A `wish` that is not valid, not finite, or far from any robot passes: the guard refuses it.
  template <class Seen>
  SKINCTL_INLINE Output step(Memory& m, const Input& in, const Command& wish,
                             const JointTorque<joints, T>& hold, const Seen& seen) const noexcept {
    Output out{wish, {}, false};
    if (!usable(in, wish, hold)) {
      this->forget_torque(m);
      return out;
    }
    if constexpr (has_driven) {
      with_driven(m, in, hold, seen, out);
    } else {
      const Going going = this->going_of(in);
      Slowed left{wish.velocity, {}};
      each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA { this->template act<K>(m, going, seen, left); });
      out.status |= left.status;
      move(m, in, going, left, out);
    }
    return out;
  }

 private:
  /// Steps of a bisection between a wish and the quickest stop: a share to 4e-3.
  static constexpr int sharing_steps = 8;
  using Base::each_group;
  using Base::each_limit;
  using Base::judges_velocity;
  using Base::limits_;
  using Base::model_;
  using Base::motions_;
  using Base::of_torque;
  using Driven = typename Base::Driven;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Going = typename Base::Going;
  using Slowed = detail::Slowed<joints, T>;
  using Drive = detail::Drive<Driven, M, T>;
  template <std::size_t K>
  using Limit = typename Base::template Limit<K>;
  template <std::size_t K>
  using Set = typename Base::template Set<K>;

  [[nodiscard]] static SKINCTL_INLINE bool usable(const Input& in, const Command& wish,
                                                  const JointTorque<joints, T>& hold) noexcept {
    return wish.valid && detail::is_plausible(wish) && in.dt > T(0) && (!has_motion || in.span > T(0)) &&
           (!has_motion || in.last.valid) && (!has_driven || detail::is_finite(hold));
  }
  /// The velocity of a command that limits judge: of joints with a limit of jerk the one that their
  /// acceleration still leads to.
  [[nodiscard]] SKINCTL_INLINE Velocity leads_to(const Command& wish) const noexcept {
    Velocity u = wish.velocity;
    if constexpr (smooth)
      each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
        Set<K>::put(
            std::get<K>(motions_).mover().leads_to(Set<K>::of(wish.velocity), Set<K>::of(wish.acceleration)),
            u);
      });
    return u;
  }
  /// Slows the command of the joints by position and velocity as far as the limits need it.
  SKINCTL_INLINE void move(Memory& m, const Input& in, const Going& going, const Slowed& left,
                           Output& out) const noexcept {
    const Position moved = out.command.position - in.last.position;
    Status broken = this->broken_between(m, going, out.command.velocity, moved);
    if constexpr (smooth) broken |= this->broken(m, going, leads_to(out.command), moved);
    out.status |= broken;
    if (left.slowed || broken.any()) {
      if constexpr (smooth) {
        move_smoothly(m, in, going, left.velocity, out);
      } else {
        move_hard(m, in, left.velocity, out);
      }
    }
    if constexpr (smooth)
      each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
        out.status |=
            std::get<K>(motions_).exceeded(part_of<Set<K>>(in.last), part_of<Set<K>>(out.command), in.span);
      });
  }
  SKINCTL_INLINE void move_hard(Memory& m, const Input& in, const Velocity& u, Output& out) const noexcept {
    each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      auto command = part_of<Set<K>>(out.command);
      out.status |= std::get<K>(motions_).move(detail::element<K>(m.groups), part_of<Set<K>>(in.last),
                                               Set<K>::of(u), in.span, command);
      put_part<Set<K>>(command, out.command);
    });
    out.altered = true;
  }
  /// Towards `u` within limits of jerk, with as much of the quickest stop as the other limits need: a smooth
  /// stop that breaks one gives way.
  SKINCTL_COLD void move_smoothly(Memory& m, const Input& in, const Going& going, const Velocity& u,
                                  Output& out) const noexcept {
    [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      const std::tuple wish(std::get<K>(motions_).smoothed(
          part_of<Set<K>>(in.last), part_of<Set<K>>(out.command), Set<K>::of(u), in.span)...);
      const std::tuple stop(std::get<K>(motions_).stopped(part_of<Set<K>>(in.last), in.span)...);
      const auto breaks = [&](const T& share) {
        Position moved = going.half_way(u);
        Velocity v = u, ahead = u;
        const auto mix = [&]<std::size_t G>() {
          const auto motion = mixed(std::get<G>(stop), std::get<G>(wish), share);
          Set<G>::put(motion.displacement, moved);
          Set<G>::put(motion.velocity, v);
          Set<G>::put(std::get<G>(motions_).mover().leads_to(motion.velocity, motion.acceleration), ahead);
        };
        (mix.template operator()<K>(), ...);
        return this->broken(m, going, v, moved) | this->broken(m, going, ahead, moved) |
               this->broken_between(m, going, v, moved);
      };
      T share(1);
      if (const Status broken = breaks(share); broken.any()) {
        out.status |= broken;
        if (breaks(T(0)).any()) return move_hard(m, in, u, out);
        share = math::greatest_share<sharing_steps, T>([&](const T& s) { return !breaks(s).any(); });
      }
      const auto follow = [&]<std::size_t G>() SKINCTL_INLINE_LAMBDA {
        auto command = part_of<Set<G>>(out.command);
        std::get<G>(motions_).follow(detail::element<G>(m.groups), part_of<Set<G>>(in.last),
                                     mixed(std::get<G>(stop), std::get<G>(wish), share), command);
        put_part<Set<G>>(command, out.command);
        out.status |= std::get<G>(wish).status;
      };
      (follow.template operator()<K>(), ...);
      out.altered = true;
    }(std::make_index_sequence<groups>{});
  }

  /// `step` of a robot with joints by torque.
  template <class Seen>
  SKINCTL_NOINLINE void with_driven(Memory& m, const Input& in, const JointTorque<joints, T>& hold,
                                    const Seen& seen, Output& out) const noexcept {
    const Going going = this->going_of(in);
    Slowed left{out.command.velocity, {}};
    if (in.stale) {
      this->forget_torque(m);
      if constexpr (has_motion) {
        Driven::put(Driven::of(going.from), left.velocity);
        each_limit([&]<std::size_t K>()
                       SKINCTL_INLINE_LAMBDA { this->template act<K>(m, going, seen, left); });
        out.status |= left.status;
        move(m, in, going, left, out);
      }
      return;
    }
    const Drive drive(model_, in.motors, limits_, in.measured, out.command.torque, going.ahead);
    const auto acted = Driven::of(in.last.torque);
    auto braked = drive.asked;
    if constexpr (of_torque < count)
      this->template part<of_torque>().observe(this->template own<of_torque>(m), limits_, drive.mass,
                                               drive.bias, in.measured, acted, in.delay, going.ahead, in.dt);
    bool predicted = true;
    if constexpr (judges_velocity) predicted = slow(m, in, going, drive, hold, seen, braked, left, out);
    if constexpr (has_motion) move(m, in, going, left, out);
    if (!predicted) return;
    if constexpr (of_torque < count) {
      const auto kept = this->template part<of_torque>().within(this->template own<of_torque>(m), limits_,
                                                                drive.mass, drive.bias, in.measured, acted,
                                                                braked, going.ahead, in.dt, in.torque_rate);
      out.status |= kept.status;
      if (kept.altered) braked = kept.torque, out.altered = true;
    }
    if (out.altered) out.command.torque = drive.with(out.command.torque, braked);
  }
  /// Finds what the limits leave of the velocity to which the torques lead, and the torque that leads there.
  /// Returns false if that velocity cannot be predicted.
  template <class Seen>
  SKINCTL_INLINE bool slow(Memory& m, const Input& in, const Going& going, const Drive& drive,
                           const JointTorque<joints, T>& hold, const Seen& seen,
                           typename Drive::Torque& braked, Slowed& left, Output& out) const noexcept {
    typename Drive::Velocity led, world;
    typename Drive::Torque resistance;
    if constexpr (of_torque < count)
      resistance = this->template part<of_torque>().resistance(this->template own<of_torque>(m));
    const bool predicted = drive.leads(hold, resistance, led, world);
    if (!predicted) {
      if constexpr (!has_motion) return false;
      led = Driven::of(in.measured.dq), world = {};
    }
    Velocity u = left.velocity;
    Driven::put(led, u);
    Driven::put(counted(m, in, going, led), left.velocity);
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (detail::OfTheDrive<Limit<K>>) this->template act<K>(m, going, seen, left);
    });
    Driven::put(Driven::of(u) + world, u);
    Driven::put(counted(m, in, going, Driven::of(left.velocity) + world), left.velocity);
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (!detail::OfTheDrive<Limit<K>>) this->template act<K>(m, going, seen, left);
    });
    out.status |= left.status;
    if (predicted && left.slowed) {
      braked = drive.asked - drive.that_takes(u - left.velocity);
      out.altered = true;
    }
    return predicted;
  }
  /// The velocity `u` with which joints by torque count. Beside joints that are commanded to move, and that
  /// all slow alike, it is what the joints' own limits will leave of it: a finger that is pressed against its
  /// end slows no arm.
  [[nodiscard]] SKINCTL_INLINE JointVelocity<Driven::count, T> counted(
      const Memory& m, const Input& in, const Going& going,
      JointVelocity<Driven::count, T> u) const noexcept {
    if constexpr (has_motion && of_torque < count) {
      const auto box = this->template part<of_torque>().box(this->template own<of_torque>(m), limits_,
                                                            in.measured, going.ahead);
      for (std::size_t i = 0; i < Driven::count; ++i) u[i] = detail::clamp(u[i], box.lower[i], box.upper[i]);
    }
    return u;
  }
};

/// The governor of a robot from its limits, in any order.
template <class Sets, RobotModel M, std::size_t N, Real T, class... Limits>
[[nodiscard]] auto make_governor(const M& model, const JointLimits<N, T>& limits, const Limits&... given) {
  const std::tuple<const Limits&...> all(given...);
  constexpr auto order = detail::order_of(std::array<Precedence, sizeof...(Limits)>{Limits::precedence...});
  return [&]<std::size_t... K>(std::index_sequence<K...>) {
    return Governor<M, T, Sets, std::remove_cvref_t<decltype(std::get<order[K]>(all))>...>(
        model, limits, std::get<order[K]>(all)...);
  }(std::index_sequence_for<Limits...>{});
}

SKINCTL_END_NAMESPACE
